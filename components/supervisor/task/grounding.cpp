// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/grounding.hpp"

#include <algorithm>

namespace handsel::supervisor {

Symbol Ground::symbol(const Term& term, const Frame& frame) const {
  if (term.variable >= 0) return frame[static_cast<std::size_t>(term.variable)];
  if (term.text == "*") return kAny;
  return term.text == "-" ? kNothing : world.symbol(term.text);
}

Atom Ground::atom(const Literal& literal, const Frame& frame) const {
  Atom out{literal.predicate, {kNothing, kNothing}};
  for (std::size_t i = 0; i < literal.args.size(); ++i)
    out.args[i] = symbol(literal.args[i], frame);
  return out;
}

bool Ground::holds(const Literal& literal, const Frame& frame, const State& state) const {
  const Atom a = atom(literal, frame);
  bool is = false;
  if (a.predicate == predicate_of(Derived::given))
    is = a.args[0] != kNothing;
  else if (a.predicate == predicate_of(Derived::same))
    is = a.args[0] == a.args[1];
  else
    is = state.holds(a);
  return is != literal.negated;
}

double Ground::extra(const std::vector<Extra>& extras, const Frame& frame,
                     const State& state) const {
  double sum = 0;
  for (const Extra& e : extras) {
    if (!holds(e.when, frame, state)) continue;
    const double* value = e.when.negated ? nullptr : state.find(atom(e.when, frame));
    sum += e.cost + (value != nullptr ? std::max(0.0, e.per_value * *value) : 0.0);
  }
  return sum;
}

std::string Ground::fill(const std::string& text, const std::vector<std::string>& names,
                         const std::vector<Type>& types, const Frame& frame) const {
  std::string out = text;
  std::vector<std::size_t> order(names.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return names[a].size() > names[b].size(); });
  for (const std::size_t i : order) {
    const Symbol s = i < frame.size() ? frame[i] : kUnbound;
    const bool left_out = s == kNothing || s == kUnbound;
    const std::string by = !left_out                   ? world.text(s)
                           : types[i] == Type::human   ? "somebody"
                           : types[i] == Type::surface ? "where there is room"
                                                       : "something";
    for (std::size_t at = out.find(names[i]); at != std::string::npos;
         at = out.find(names[i], at + by.size()))
      out.replace(at, names[i].size(), by);
  }
  return out;
}

Frame frame_of(World& world, const std::vector<std::string>& args) {
  Frame frame;
  for (const auto& arg : args)
    frame.push_back(arg.empty() || arg == "-" ? kNothing : world.symbol(arg));
  return frame;
}

const Test* failing(const Ground& ground, const std::vector<Test>& tests, const Frame& frame,
                    const State& state) {
  for (const Test& test : tests)
    if (test.enumerate < 0 && !ground.holds(test.literal, frame, state)) return &test;
  return nullptr;
}

void change(const Ground& ground, const CompiledAction& action, const Frame& frame, State& state) {
  for (const Literal& l : action.removes) state.remove(ground.atom(l, frame));
  for (const Literal& l : action.adds) state.set(ground.atom(l, frame));
  for (const auto& c : action.changes) {
    const Atom atom = ground.atom(c.of, frame);
    if (atom.args[0] == kNothing) continue;
    const double* now = state.find(atom);
    const double value = (now != nullptr ? *now : 0.0) + c.by;
    if (value > 0)
      state.set(atom, value);
    else
      state.remove(atom);
  }
}

PlannedAction planned(const Domain& domain, const Ground& ground, int index, const Frame& frame) {
  const CompiledAction& action = domain.actions[static_cast<std::size_t>(index)];
  const auto text = [&](const Term& term) {
    const Symbol s = ground.symbol(term, frame);
    return s == kNothing ? std::string() : ground.world.text(s);
  };
  PlannedAction out{
      action.kind, text(action.object), text(action.human), text(action.surface), index, {}, 0};
  out.both_hands = action.both_hands;
  for (std::size_t i = 0; i < action.types.size(); ++i)
    out.args.push_back(ground.world.text(frame[i]));
  return out;
}

}  // namespace handsel::supervisor
