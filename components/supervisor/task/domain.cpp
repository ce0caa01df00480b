// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/domain.hpp"

#include <algorithm>
#include <set>

#include "common/config/resources.hpp"
#include "common/messages/names.hpp"
#include "components/supervisor/task/condition_compiler.hpp"
#include "components/supervisor/task/domain_checks.hpp"
#include "components/supervisor/task/domain_text.hpp"

namespace handsel::supervisor {
namespace {

class Compiler {
 public:
  Compiler(const config::TaskDomain& description, const TextPlace& place)
      : description_(description), place_(place) {}

  Domain compile() {
    declare();
    for (int i = 0; i < description_.actions_size(); ++i) action(i);
    for (int i = 0; i < description_.tasks_size(); ++i) task(i);
    check_for_circles(domain_, place_);
    bound_costs(domain_);
    return std::move(domain_);
  }

 private:
  void declare() {
    domain_.predicates = known_predicates();
    for (int i = 0; i < description_.predicates_size(); ++i) {
      const auto& own = description_.predicates(i);
      const TextPlace at = place_.inside("predicates", i);
      if (own.name().empty() || conditions_.predicate(own.name()) >= 0)
        throw_at(at.of("name"), own.name().empty() ? "a predicate needs a name"
                                                   : own.name() + " is a predicate already");
      if (own.types_size() > 2)
        throw_at(at.of("types", 2), own.name() + " has more than two arguments");
      PredicateSign sign{own.name(), {}};
      for (int k = 0; k < own.types_size(); ++k)
        sign.types.push_back(conditions_.type(own.types(k), at.of("types", k)));
      domain_.predicates.push_back(sign);
    }
    std::set<std::string> names;
    for (int i = 0; i < description_.actions_size(); ++i) {
      const auto& a = description_.actions(i);
      const TextPlace at = place_.inside("actions", i);
      if (a.name().empty() || !names.insert(a.name()).second)
        throw_at(at.of("name"),
                 a.name().empty() ? "an action needs a name" : a.name() + " is there already");
      CompiledAction out;
      out.name = a.name();
      conditions_.parameters(a.parameters(), at, out.parameters, out.types);
      domain_.actions.push_back(std::move(out));
    }
    for (int i = 0; i < description_.tasks_size(); ++i) {
      const auto& t = description_.tasks(i);
      const TextPlace at = place_.inside("tasks", i);
      if (t.name().empty() || !names.insert(t.name()).second)
        throw_at(at.of("name"),
                 t.name().empty() ? "a task needs a name" : t.name() + " is there already");
      if (t.methods().empty())
        throw_at(at.of("name"),
                 "task " + t.name() + " has no methods: nothing is known about how to do it");
      CompiledTask out;
      out.name = t.name();
      out.text = t.text();
      conditions_.parameters(t.parameters(), at, out.parameters, out.types);
      domain_.tasks.push_back(std::move(out));
    }
  }

  void action(int index) {
    const auto& a = description_.actions(index);
    const TextPlace at = place_.inside("actions", index);
    CompiledAction& out = domain_.actions[static_cast<std::size_t>(index)];
    Scope scope = Scope::of(out.parameters, out.types);
    const auto kind = std::find(std::begin(kActionKindNames), std::end(kActionKindNames), a.kind());
    if (kind == std::end(kActionKindNames))
      throw_at(at.of("kind"), "\"" + a.kind() + "\" is no action of the robot; there is " +
                                  listed(kActionKindNames, [](const char* n) { return n; }));
    out.kind = static_cast<ActionKind>(kind - std::begin(kActionKindNames));
    const auto field = [&](const std::string& text, const char* name) {
      return text.empty() ? Term{-1, "-"} : conditions_.term(text, scope, at.of(name));
    };
    out.object = field(a.object(), "object");
    out.human = field(a.human(), "human");
    out.surface = field(a.surface(), "surface");
    out.both_hands = a.both_hands();
    if (out.both_hands && out.kind != ActionKind::give)
      throw_at(at.of("both_hands"), "is for actions of kind give, not " + a.kind());
    out.when = conditions_.tests(a.when(), at, "when", scope);
    out.keep = conditions_.tests(a.keep(), at, "keep", scope);
    for (int i = 0; i < a.adds_size(); ++i)
      out.adds.push_back(conditions_.effect(a.adds(i), scope, at.of("adds", i), false));
    for (int i = 0; i < a.removes_size(); ++i)
      out.removes.push_back(conditions_.effect(a.removes(i), scope, at.of("removes", i), true));
    for (int i = 0; i < a.changes_size(); ++i)
      out.changes.push_back(
          {conditions_.effect(a.changes(i).of(), scope, at.inside("changes", i).of("of"), false),
           a.changes(i).by()});
    out.cost = conditions_.cost(a.cost(), at);
    out.extra = conditions_.extras(a.extra(), at, scope);
  }

  Call call(const std::string& text, Scope& scope, std::vector<Test>& before,
            const std::string& where) const {
    const std::vector<std::string> parts = words(text);
    if (parts.empty()) throw_at(where, "a step is empty; it is written like \"move ?o ?t\"");
    Call out;
    const auto named = [&](const auto& list) {
      const auto it = std::find_if(list.begin(), list.end(),
                                   [&](const auto& entry) { return entry.name == parts[0]; });
      return it == list.end() ? -1 : static_cast<int>(it - list.begin());
    };
    out.index = named(domain_.tasks);
    if (out.index < 0) out.index = named(domain_.actions), out.action = true;
    if (out.index < 0)
      throw_at(where, "\"" + parts[0] + "\" is neither a task nor an action; there is " +
                          listed(domain_.tasks, [](const auto& t) { return t.name; }) + ", " +
                          listed(domain_.actions, [](const auto& a) { return a.name; }));
    const auto i = static_cast<std::size_t>(out.index);
    const std::vector<Type>& types = out.action ? domain_.actions[i].types : domain_.tasks[i].types;
    if (parts.size() - 1 != types.size())
      throw_at(where, parts[0] + " has " + std::to_string(types.size()) + " arguments, not " +
                          std::to_string(parts.size() - 1));
    for (std::size_t k = 1; k < parts.size(); ++k) {
      const Term t = conditions_.term(parts[k], scope, where);
      if (t.text == "*") throw_at(where, "* stands in conditions and removes only");
      conditions_.check_type(t, types[k - 1], scope, where, parts[0]);
      if (t.variable >= 0) conditions_.bind_by_type(t.variable, scope, before, where);
      out.args.push_back(t);
    }
    return out;
  }

  void task(int index) {
    const auto& t = description_.tasks(index);
    const TextPlace at = place_.inside("tasks", index);
    CompiledTask& out = domain_.tasks[static_cast<std::size_t>(index)];
    Scope head = Scope::of(out.parameters, out.types);
    for (const std::string& word : words(out.text))
      if (word.starts_with('?'))
        conditions_.term(word.substr(0, word.find_last_not_of(",.;:") + 1), head, at.of("text"));
    if (out.text.empty()) out.text = out.name;
    out.achieved = conditions_.tests(t.achieved(), at, "achieved", head);
    for (int i = 0; i < t.methods_size(); ++i)
      out.methods.push_back(method(t.methods(i), at.inside("methods", i), out));
  }

  CompiledMethod method(const config::Method& m, const TextPlace& at,
                        const CompiledTask& task) const {
    CompiledMethod out;
    out.name = m.name();
    out.cost = conditions_.cost(m.cost(), at);
    Scope scope = Scope::of(task.parameters, task.types);
    for (int i = 0; i < m.variables_size(); ++i) {
      conditions_.variable(m.variables(i), at.of("variables", i), scope.names, scope.types);
      scope.bound.push_back(false);
    }
    out.tests = conditions_.tests(m.when(), at, "when", scope);
    for (int i = static_cast<int>(task.parameters.size()); i < static_cast<int>(scope.names.size());
         ++i)
      conditions_.bind_by_type(i, scope, out.tests,
                               at.of("variables", i - static_cast<int>(task.parameters.size())));
    out.extra = conditions_.extras(m.extra(), at, scope);
    for (int i = 0; i < m.steps_size(); ++i)
      out.steps.push_back(step(m.steps(i), at.inside("steps", i), scope));
    out.names = scope.names;
    out.types = scope.types;
    return out;
  }

  CompiledStep step(const config::Step& s, const TextPlace& at, Scope& scope) const {
    CompiledStep out;
    if (s.has_all() == !s.task().empty())
      throw_at(at.of(s.has_all() ? "all" : "task"), "a step is either a task or all { }");
    if (!s.has_all()) {
      std::vector<Test> none;
      out.call = call(s.task(), scope, none, at.of("task"));
      return out;
    }
    const auto& all = s.all();
    const TextPlace here = at.inside("all");
    out.all = true;
    if (all.variables().empty()) throw_at(at.of("all"), "needs variables");
    for (int i = 0; i < all.variables_size(); ++i) {
      out.own.push_back(static_cast<int>(scope.names.size()));
      conditions_.variable(all.variables(i), here.of("variables", i), scope.names, scope.types);
      scope.bound.push_back(false);
    }
    for (int i = 0; i < all.when_size(); ++i)
      conditions_.test(all.when(i), "", scope, out.tests, here.of("when", i));
    for (int i = 0; i < static_cast<int>(out.own.size()); ++i)
      conditions_.bind_by_type(out.own[static_cast<std::size_t>(i)], scope, out.tests,
                               here.of("variables", i));
    if (!all.order_by().empty())
      out.ordered = true,
      out.order = conditions_.closed(all.order_by(), scope, here.of("order_by"));
    if (all.steps().empty()) throw_at(at.of("all"), "needs steps");
    for (int i = 0; i < all.steps_size(); ++i)
      out.calls.push_back(call(all.steps(i), scope, out.tests, here.of("steps", i)));
    out.skip_cost = conditions_.cost(all.skip_cost(), here, "skip_cost");
    for (const int v : out.own) scope.names[static_cast<std::size_t>(v)] += " (of an all)";
    return out;
  }

  const config::TaskDomain& description_;
  const TextPlace& place_;
  Domain domain_;
  const ConditionCompiler conditions_{domain_.predicates};
};

}  // namespace

int Domain::task(const std::string& name) const {
  const auto at = std::find_if(tasks.begin(), tasks.end(),
                               [&](const CompiledTask& t) { return t.name == name; });
  return at == tasks.end() ? -1 : static_cast<int>(at - tasks.begin());
}

Domain compile_domain(const config::TaskDomain& description, const TextPlace& place) {
  return Compiler(description, place).compile();
}

Domain load_domain(const std::filesystem::path& file) {
  config::TaskDomain description;
  google::protobuf::TextFormat::ParseInfoTree places;
  load_text_proto(file, description, places);
  return compile_domain(description,
                        TextPlace(file.string(), &places, description.GetDescriptor()));
}

Domain parse_domain(const std::string& text, const std::string& name) {
  config::TaskDomain description;
  google::protobuf::TextFormat::ParseInfoTree places;
  parse_text_proto(text, name, description, places);
  return compile_domain(description, TextPlace(name, &places, description.GetDescriptor()));
}

}  // namespace handsel::supervisor
