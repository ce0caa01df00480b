#include "components/supervisor/task/htn.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <unordered_map>

namespace handsel::supervisor {
namespace {

using Frame = std::vector<Symbol>;  // by variable; kUnbound where nothing is bound yet
constexpr Symbol kUnbound = -2;
constexpr double kAsMuch = 1e-9;

struct Ground {
  World& world;

  Symbol symbol(const Term& term, const Frame& frame) const {
    if (term.variable >= 0) return frame[static_cast<std::size_t>(term.variable)];
    if (term.text == "*") return kAny;
    return term.text == "-" ? kNothing : world.symbol(term.text);
  }
  Atom atom(const Literal& literal, const Frame& frame) const {
    Atom out{literal.predicate, {kNothing, kNothing}};
    for (std::size_t i = 0; i < literal.args.size(); ++i) out.args[i] = symbol(literal.args[i], frame);
    return out;
  }
  /// All variables bound.
  bool holds(const Literal& literal, const Frame& frame, const State& state) const {
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
  double extra(const std::vector<Extra>& extras, const Frame& frame, const State& state) const {
    double sum = 0;
    for (const Extra& e : extras) {
      if (!holds(e.when, frame, state)) continue;
      const double* value = e.when.negated ? nullptr : state.find(atom(e.when, frame));
      sum += e.cost + (value != nullptr ? std::max(0.0, e.per_value * *value) : 0.0);
    }
    return sum;
  }
  /// What people read: "?x" by what x is.
  std::string fill(const std::string& text, const std::vector<std::string>& names, const std::vector<Type>& types,
                   const Frame& frame) const {
    std::string out = text;
    std::vector<std::size_t> order(names.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return names[a].size() > names[b].size(); });
    for (const std::size_t i : order) {
      const Symbol s = i < frame.size() ? frame[i] : kUnbound;
      const bool left_out = s == kNothing || s == kUnbound;
      const std::string by = !left_out                   ? world.text(s)
                             : types[i] == Type::human   ? "somebody"
                             : types[i] == Type::surface ? "where there is room"
                                                         : "something";
      for (std::size_t at = out.find(names[i]); at != std::string::npos; at = out.find(names[i], at + by.size()))
        out.replace(at, names[i].size(), by);
    }
    return out;
  }
};

Frame frame_of(World& world, const std::vector<std::string>& args) {
  Frame frame;
  for (const auto& arg : args) frame.push_back(arg.empty() || arg == "-" ? kNothing : world.symbol(arg));
  return frame;
}

/// The first condition that does not hold; nullptr: all do.
const Test* failing(const Ground& ground, const std::vector<Test>& tests, const Frame& frame, const State& state) {
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

/// Without tasks that need no action.
std::vector<PlanLine> with_something_to_do(const std::vector<PlanLine>& tree) {
  std::vector<PlanLine> out;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    bool any = i == 0 || tree[i].action >= 0 || tree[i].skipped;
    for (std::size_t k = i + 1; k < tree.size() && tree[k].depth > tree[i].depth && !any; ++k) any = tree[k].action >= 0 || tree[k].skipped;
    if (any) out.push_back(tree[i]);
  }
  return out;
}

PlannedAction planned(const Domain& domain, const Ground& ground, int index, const Frame& frame) {
  const CompiledAction& action = domain.actions[static_cast<std::size_t>(index)];
  const auto text = [&](const Term& term) {
    const Symbol s = ground.symbol(term, frame);
    return s == kNothing ? std::string() : ground.world.text(s);
  };
  PlannedAction out{action.kind, text(action.object), text(action.human), text(action.surface), index, {}, 0};
  for (std::size_t i = 0; i < action.types.size(); ++i) out.args.push_back(ground.world.text(frame[i]));
  return out;
}

class Search {
 public:
  Search(const Domain& domain, const World& world, const Forbidden& forbidden, const PlanLimits& limits)
      : domain_(domain), world_(world), ground_{world_}, forbidden_(forbidden), limits_(limits) {}

  Plan run(int task, const std::vector<std::string>& args) {
    Item root;
    root.call.index = task;
    root.frame = std::make_shared<const Frame>(frame_of(world_, args));
    root.min_cost = domain_.tasks[static_cast<std::size_t>(task)].min_cost;
    State start = world_.state;
    step(start, push(root, nullptr), 0);
    best_.nodes = nodes_;
    best_.proven = nodes_ < limits_.nodes && !too_deep_;
    if (!best_.found) {
      best_.reason = !blame_.empty()           ? blame_
                     : too_deep_               ? "the tasks of the domain lead ever deeper without an end"
                     : nodes_ >= limits_.nodes ? "no plan was found in " + std::to_string(limits_.nodes) + " states"
                                               : "there is no way to " + task_text(task, frame_of(world_, args));
    }
    return std::move(best_);
  }

 private:
  /// What is to be done: a call with its arguments bound, an `all`, or one of its instances.
  struct Item {
    enum class Kind { call, all, one } kind{Kind::call};
    Call call;                   // index and whether it is an action; its arguments are `frame`
    const CompiledStep* step{};  // of all and one
    std::shared_ptr<const Frame> frame;
    std::uint32_t depth{};
    double min_cost{};
  };
  struct Link;
  using Agenda = std::shared_ptr<const Link>;
  struct Link {
    Item item;
    Agenda rest;
    double min_cost;     // of all of it
    std::uint64_t hash;  // of all of it
  };

  Agenda push(Item item, const Agenda& rest) const {
    std::uint64_t h = rest ? rest->hash : 7;
    const auto mix = [&h](std::uint64_t v) { h = (h ^ v) * 1099511628211ULL, h ^= h >> 31; };
    mix(static_cast<std::uint64_t>(item.kind) * 2 + (item.call.action ? 1 : 0));
    mix(item.kind == Item::Kind::call ? static_cast<std::uint64_t>(item.call.index) : reinterpret_cast<std::uintptr_t>(item.step));
    for (const Symbol s : *item.frame) mix(static_cast<std::uint64_t>(s) + 1000003);
    const double min_cost = item.min_cost + (rest ? rest->min_cost : 0);
    return std::make_shared<const Link>(Link{std::move(item), rest, min_cost, h});
  }

  Item call_item(const Call& call, const Frame& frame, std::uint32_t depth) const {
    Item item;
    item.call = {call.action, call.index, {}};
    Frame args;
    for (const Term& t : call.args) args.push_back(ground_.symbol(t, frame));
    item.frame = std::make_shared<const Frame>(std::move(args));
    item.depth = depth;
    item.min_cost = call.action ? domain_.actions[static_cast<std::size_t>(call.index)].cost
                                : domain_.tasks[static_cast<std::size_t>(call.index)].min_cost;
    return item;
  }

  std::string task_text(int index, const Frame& args) const {
    const CompiledTask& task = domain_.tasks[static_cast<std::size_t>(index)];
    return ground_.fill(task.text, task.parameters, task.types, args);
  }

  /// Of the ways that lead farthest the first reason counts.
  void blame(const std::string& reason) {
    if (reason.empty()) return;
    if (here_ != nullptr && here_->empty()) *here_ = reason;
    if (!blame_.empty() && actions_.size() <= blame_at_) return;
    blame_ = reason;
    blame_at_ = actions_.size();
  }

  void step(State& state, const Agenda& agenda, double cost) {
    if (nodes_ >= limits_.nodes) return;
    ++nodes_;
    const double min_cost = cost + (agenda ? agenda->min_cost : 0);
    if (best_.found && min_cost >= best_.cost - kAsMuch) return;
    if (!agenda) {
      best_.found = true;
      best_.cost = cost;
      best_.actions = actions_;
      best_.tree = with_something_to_do(tree_);
      return;
    }
    std::uint64_t key = state.hash() * 31 + agenda->hash;
    const auto [seen, fresh] = seen_.try_emplace(key, cost);
    if (!fresh && seen->second <= cost + kAsMuch) return;
    seen->second = cost;
    const std::size_t lines = tree_.size();
    switch (agenda->item.kind) {
      case Item::Kind::call:
        agenda->item.call.action ? act(state, agenda, cost) : decompose(state, agenda, cost);
        break;
      case Item::Kind::all:
        each(state, agenda, cost);
        break;
      case Item::Kind::one:
        one(state, agenda, cost);
        break;
    }
    tree_.resize(lines);
  }

  void act(const State& state, const Agenda& agenda, double cost) {
    const Item& item = agenda->item;
    const CompiledAction& action = domain_.actions[static_cast<std::size_t>(item.call.index)];
    if (const Test* test = failing(ground_, action.when, *item.frame, state)) {
      blame(ground_.fill(test->otherwise, action.parameters, action.types, *item.frame));
      return;
    }
    PlannedAction out = planned(domain_, ground_, item.call.index, *item.frame);
    if (const auto no = forbidden_.find(out.text()); no != forbidden_.end()) {
      blame(no->second);
      return;
    }
    out.cost = action.cost + ground_.extra(action.extra, *item.frame, state);
    State next = state;
    change(ground_, action, *item.frame, next);
    tree_.push_back({out.text(), item.depth, static_cast<int>(actions_.size()), false, ""});
    const double sum = cost + out.cost;
    actions_.push_back(std::move(out));
    step(next, agenda->rest, sum);
    actions_.pop_back();
  }

  struct Choice {
    const CompiledMethod* method;
    Frame frame;
    double cost, estimate;
  };

  void decompose(State& state, const Agenda& agenda, double cost) {
    const Item& item = agenda->item;
    const CompiledTask& task = domain_.tasks[static_cast<std::size_t>(item.call.index)];
    if (item.depth >= limits_.depth) {
      too_deep_ = true;
      return;
    }
    tree_.push_back({task_text(item.call.index, *item.frame), item.depth, -1, false, ""});
    std::vector<Choice> choices;
    for (const CompiledMethod& method : task.methods) {
      Frame frame = *item.frame;
      frame.resize(method.names.size(), kUnbound);
      const std::size_t before = choices.size();
      lacking_.clear();
      bind(method.tests, 0, frame, method.types, state, method.names, [&] {
        const double own = method.cost + ground_.extra(method.extra, frame, state);
        choices.push_back({&method, frame, own, own + method.min_cost - method.cost});
      });
      if (choices.size() == before) blame(lacking_);
    }
    std::stable_sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) { return a.estimate < b.estimate; });
    for (const Choice& choice : choices) {
      Agenda next = agenda->rest;
      for (auto s = choice.method->steps.rbegin(); s != choice.method->steps.rend(); ++s) {
        if (!s->all) {
          next = push(call_item(s->call, choice.frame, item.depth + 1), next);
          continue;
        }
        Item all;
        all.kind = Item::Kind::all;
        all.step = &*s;
        all.frame = std::make_shared<const Frame>(choice.frame);
        all.depth = item.depth + 1;
        method_of_[&*s] = choice.method;
        next = push(all, next);
      }
      const std::size_t lines = tree_.size();
      step(state, next, cost + choice.cost);
      tree_.resize(lines);
    }
  }

  void lack(const Test& test, const std::vector<std::string>& names, const std::vector<Type>& types, const Frame& frame) {
    if (lacking_.empty() && !test.otherwise.empty()) lacking_ = ground_.fill(test.otherwise, names, types, frame);
  }

  void bind(const std::vector<Test>& tests, std::size_t at, Frame& frame, const std::vector<Type>& types, const State& state,
            const std::vector<std::string>& names, const std::function<void()>& found) {
    if (at == tests.size()) return found();
    const Test& test = tests[at];
    if (test.enumerate >= 0) {
      Symbol& slot = frame[static_cast<std::size_t>(test.enumerate)];
      for (const Symbol s : world_.all(types[static_cast<std::size_t>(test.enumerate)])) {
        slot = s;
        bind(tests, at + 1, frame, types, state, names, found);
      }
      slot = kUnbound;
      return;
    }
    std::vector<int> open;
    for (const Term& t : test.literal.args)
      if (t.variable >= 0 && frame[static_cast<std::size_t>(t.variable)] == kUnbound) open.push_back(t.variable);
    if (open.empty()) {
      if (ground_.holds(test.literal, frame, state))
        bind(tests, at + 1, frame, types, state, names, found);
      else
        lack(test, names, types, frame);
      return;
    }
    bool any = false;
    const auto [first, last] = state.range(test.literal.predicate);
    for (std::size_t i = first; i < last; ++i) {
      const Atom atom = state.entries()[i].atom;
      bool fits = true;
      for (std::size_t k = 0; k < test.literal.args.size() && fits; ++k) {
        const Term& t = test.literal.args[k];
        const Symbol has = ground_.symbol(t, frame);
        if (has == kUnbound)
          frame[static_cast<std::size_t>(t.variable)] = atom.args[k];
        else
          fits = has == kAny || has == atom.args[k];
      }
      if (fits) {
        any = true;
        bind(tests, at + 1, frame, types, state, names, found);
      }
      for (const int v : open) frame[static_cast<std::size_t>(v)] = kUnbound;
    }
    if (!any) lack(test, names, types, frame);
  }

  void each(State& state, const Agenda& agenda, double cost) {
    const Item& item = agenda->item;
    const CompiledStep& s = *item.step;
    struct One {
      Frame frame;
      double order;
    };
    std::vector<One> ones;
    Frame frame = *item.frame;
    for (const int v : s.own) frame[static_cast<std::size_t>(v)] = kUnbound;
    const CompiledMethod& method = *method_of_[&s];
    bind(s.tests, 0, frame, method.types, state, method.names, [&] {
      const double* value = s.ordered ? state.find(ground_.atom(s.order, frame)) : nullptr;
      ones.push_back({frame, s.ordered && value == nullptr ? 1e9 : value != nullptr ? *value : 0.0});
    });
    std::stable_sort(ones.begin(), ones.end(), [](const One& a, const One& b) { return a.order < b.order; });
    Agenda next = agenda->rest;
    for (auto o = ones.rbegin(); o != ones.rend(); ++o) {
      Item one;
      one.kind = Item::Kind::one;
      one.step = &s;
      one.frame = std::make_shared<const Frame>(std::move(o->frame));
      one.depth = item.depth;
      for (const Call& call : s.calls) one.min_cost += call_item(call, *one.frame, 0).min_cost;
      if (s.skip_cost > 0) one.min_cost = std::min(one.min_cost, s.skip_cost);
      next = push(one, next);
    }
    step(state, next, cost);
  }

  void one(State& state, const Agenda& agenda, double cost) {
    const Item& item = agenda->item;
    Agenda next = agenda->rest;
    for (auto call = item.step->calls.rbegin(); call != item.step->calls.rend(); ++call)
      next = push(call_item(*call, *item.frame, item.depth), next);
    if (item.step->skip_cost <= 0) return step(state, next, cost);
    std::string mine, *before = std::exchange(here_, &mine);
    const std::size_t lines = tree_.size();
    step(state, next, cost);
    tree_.resize(lines);
    here_ = before;
    const Call& first = item.step->calls.front();
    const Item what = call_item(first, *item.frame, 0);
    const std::string text =
        first.action ? planned(domain_, ground_, first.index, *what.frame).text() : task_text(first.index, *what.frame);
    tree_.push_back({text, item.depth, -1, true, mine.empty() ? "there is no way to do it" : mine});
    step(state, agenda->rest, cost + item.step->skip_cost);
    tree_.resize(lines);
  }

  const Domain& domain_;
  World world_;  // a copy: names of the domain are added
  Ground ground_;
  const Forbidden& forbidden_;
  const PlanLimits limits_;
  // The min cost at which a state was reached with the same calls left to do.
  std::unordered_map<std::uint64_t, double> seen_;
  std::unordered_map<const CompiledStep*, const CompiledMethod*> method_of_;  // of an all
  std::vector<PlannedAction> actions_;
  std::vector<PlanLine> tree_;
  std::uint64_t nodes_{0};
  bool too_deep_{false};
  std::string blame_;
  std::size_t blame_at_{0};
  std::string lacking_;         // why the method looked at does not fit
  std::string* here_{nullptr};  // first reason inside the instance that might be left out
  Plan best_;
};

}  // namespace

std::string left_out(const Plan& plan) {
  std::string out;
  for (const PlanLine& line : plan.tree)
    if (line.skipped) out += (out.empty() ? "" : "; ") + line.text + ": " + line.reason;
  return out;
}

std::string PlannedAction::text() const {
  const std::string what = object.empty() ? "something" : object;
  switch (kind) {
    case ActionKind::go_to:
      return "go to " + (object.empty() ? "rest" : object);
    case ActionKind::pick:
      return "pick " + what + (human.empty() ? "" : " for " + human);
    case ActionKind::give:
      return "give " + what + (human.empty() ? "" : " to " + human);
    case ActionKind::receive:
      return "receive " + what + (human.empty() ? "" : " from " + human);
    default:
      return std::string(name(kind)) + " " + what + (surface.empty() ? "" : " on " + surface);
  }
}

Plan make_plan(const Domain& domain, const World& world, int task, const std::vector<std::string>& args, const Forbidden& forbidden,
               const PlanLimits& limits) {
  return Search(domain, world, forbidden, limits).run(task, args);
}

namespace {
/// What its first condition among `conditions` that does not hold says; empty: all hold.
std::string objection(const Domain& domain, World& world, const PlannedAction& planned, const State& state,
                      std::vector<Test> CompiledAction::*conditions, const char* otherwise) {
  const CompiledAction& action = domain.actions[static_cast<std::size_t>(planned.action)];
  const Frame frame = frame_of(world, planned.args);
  const Ground ground{world};
  const Test* test = failing(ground, action.*conditions, frame, state);
  if (test == nullptr) return "";
  return test->otherwise.empty() ? planned.text() + otherwise : ground.fill(test->otherwise, action.parameters, action.types, frame);
}
}  // namespace

std::string why_not(const Domain& domain, World& world, const PlannedAction& planned, const State& state) {
  return objection(domain, world, planned, state, &CompiledAction::when, " is not possible any more");
}

void apply(const Domain& domain, World& world, const PlannedAction& planned, State& state) {
  change(Ground{world}, domain.actions[static_cast<std::size_t>(planned.action)], frame_of(world, planned.args), state);
}

bool shows(const Domain& domain, World& world, const PlannedAction& planned, const State& state) {
  const CompiledAction& action = domain.actions[static_cast<std::size_t>(planned.action)];
  const Frame frame = frame_of(world, planned.args);
  const Ground ground{world};
  return std::all_of(action.adds.begin(), action.adds.end(), [&](const Literal& l) { return ground.holds(l, frame, state); });
}

std::string broken(const Domain& domain, World& world, const PlannedAction& planned, const State& state) {
  return objection(domain, world, planned, state, &CompiledAction::keep, " makes no sense any more");
}

std::string unachieved(const Domain& domain, World& world, int task, const std::vector<std::string>& args, const State& state) {
  const CompiledTask& t = domain.tasks[static_cast<std::size_t>(task)];
  const Frame frame = frame_of(world, args);
  const Ground ground{world};
  const Test* test = failing(ground, t.achieved, frame, state);
  if (test == nullptr) return "";
  return test->otherwise.empty() ? "not all of it was done" : ground.fill(test->otherwise, t.parameters, t.types, frame);
}

}  // namespace handsel::supervisor
