#include "components/supervisor/task/domain.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <sstream>

#include "common/config/resources.hpp"
#include "common/messages/names.hpp"

namespace handsel::supervisor {
namespace {

constexpr int kLeastRounds = 32;

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

template <class List, class Name>
std::string listed(const List& list, Name name) {
  std::string out;
  for (const auto& entry : list) out += (out.empty() ? "" : ", ") + std::string(name(entry));
  return out;
}

/// The variables that are known where a condition stands.
struct Scope {
  std::vector<std::string> names;
  std::vector<Type> types;
  std::vector<bool> bound;

  int find(const std::string& name) const {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? -1 : static_cast<int>(at - names.begin());
  }
};

class Compiler {
 public:
  Compiler(const config::TaskDomain& description, const TextPlace& place) : description_(description), place_(place) {}

  Domain compile() {
    declare();
    for (int i = 0; i < description_.actions_size(); ++i) action(i);
    for (int i = 0; i < description_.tasks_size(); ++i) task(i);
    find_circles();
    bound_costs();
    return std::move(domain_);
  }

 private:
  [[noreturn]] static void fail(const std::string& where, const std::string& what) { throw ConfigError(where + ": " + what); }

  void declare() {
    domain_.predicates = known_predicates();
    for (int i = 0; i < description_.predicates_size(); ++i) {
      const auto& own = description_.predicates(i);
      const TextPlace at = place_.inside("predicates", i);
      if (own.name().empty() || predicate(own.name()) >= 0)
        fail(at.of("name"), own.name().empty() ? "a predicate needs a name" : own.name() + " is a predicate already");
      if (own.types_size() > 2) fail(at.of("types", 2), own.name() + " has more than two arguments");
      PredicateSign sign{own.name(), {}};
      for (int k = 0; k < own.types_size(); ++k) sign.types.push_back(type(own.types(k), at.of("types", k)));
      domain_.predicates.push_back(sign);
    }
    std::set<std::string> names;
    for (int i = 0; i < description_.actions_size(); ++i) {
      const auto& a = description_.actions(i);
      const TextPlace at = place_.inside("actions", i);
      if (a.name().empty() || !names.insert(a.name()).second)
        fail(at.of("name"), a.name().empty() ? "an action needs a name" : a.name() + " is there already");
      CompiledAction out;
      out.name = a.name();
      parameters(a.parameters(), at, out.parameters, out.types);
      domain_.actions.push_back(std::move(out));
    }
    for (int i = 0; i < description_.tasks_size(); ++i) {
      const auto& t = description_.tasks(i);
      const TextPlace at = place_.inside("tasks", i);
      if (t.name().empty() || !names.insert(t.name()).second)
        fail(at.of("name"), t.name().empty() ? "a task needs a name" : t.name() + " is there already");
      if (t.methods().empty()) fail(at.of("name"), "task " + t.name() + " has no methods: nothing is known about how to do it");
      CompiledTask out;
      out.name = t.name();
      out.text = t.text();
      parameters(t.parameters(), at, out.parameters, out.types);
      domain_.tasks.push_back(std::move(out));
    }
  }

  Type type(const std::string& text, const std::string& where) const {
    for (const Type t : {Type::object, Type::surface, Type::human, Type::name})
      if (text == supervisor::name(t)) return t;
    fail(where, "\"" + text + "\" is no type; there is object, surface, human, name");
  }

  void variable(const std::string& text, const std::string& where, std::vector<std::string>& names, std::vector<Type>& types) const {
    const auto colon = text.find(':');
    if (!text.starts_with('?') || colon == std::string::npos || colon < 2)
      fail(where, "\"" + text + "\" declares no variable; it is written ?name:type, e.g. ?o:object");
    const std::string variable = text.substr(0, colon);
    if (std::find(names.begin(), names.end(), variable) != names.end()) fail(where, variable + " is declared already");
    types.push_back(type(text.substr(colon + 1), where));
    names.push_back(variable);
  }

  template <class List>
  void parameters(const List& list, const TextPlace& at, std::vector<std::string>& names, std::vector<Type>& types) const {
    for (int i = 0; i < list.size(); ++i) variable(list[i], at.of("parameters", i), names, types);
  }

  int predicate(const std::string& name) const {
    const auto at = std::find_if(domain_.predicates.begin(), domain_.predicates.end(), [&](const auto& p) { return p.name == name; });
    return at == domain_.predicates.end() ? -1 : static_cast<int>(at - domain_.predicates.begin());
  }

  Term term(const std::string& text, const Scope& scope, const std::string& where) const {
    if (!text.starts_with('?')) return {-1, text};
    const int index = scope.find(text);
    if (index < 0) fail(where, text + " is not declared here; there is " + listed(scope.names, [](const auto& n) { return n; }));
    return {index, ""};
  }

  void check_type(const Term& term, Type wanted, const Scope& scope, const std::string& where, const std::string& what) const {
    if (term.variable < 0 || wanted == Type::name) return;
    const Type has = scope.types[static_cast<std::size_t>(term.variable)];
    if (has != wanted && has != Type::name)
      fail(where, what + " wants a " + supervisor::name(wanted) + " where " + scope.names[static_cast<std::size_t>(term.variable)] +
                      " is a " + supervisor::name(has));
  }

  Literal literal(const std::string& text, const Scope& scope, const std::string& where) const {
    std::vector<std::string> parts = words(text);
    Literal out;
    if (!parts.empty() && parts[0] == "not") out.negated = true, parts.erase(parts.begin());
    if (parts.empty()) fail(where, "a condition is empty; it is written like \"on_surface ?o ?s\"");
    out.predicate = predicate(parts[0]);
    if (out.predicate < 0)
      fail(where, "\"" + parts[0] + "\" is no predicate; there is " + listed(domain_.predicates, [](const auto& p) { return p.name; }));
    const PredicateSign& sign = domain_.predicates[static_cast<std::size_t>(out.predicate)];
    if (parts.size() - 1 != sign.types.size())
      fail(where, sign.name + " has " + std::to_string(sign.types.size()) + " arguments, not " + std::to_string(parts.size() - 1));
    for (std::size_t i = 1; i < parts.size(); ++i) {
      out.args.push_back(term(parts[i], scope, where));
      check_type(out.args.back(), sign.types[i - 1], scope, where, sign.name);
    }
    return out;
  }

  void bind_by_type(int variable, Scope& scope, std::vector<Test>& out, const std::string& where) const {
    const auto i = static_cast<std::size_t>(variable);
    if (scope.bound[i]) return;
    if (scope.types[i] == Type::name) fail(where, scope.names[i] + " is a name that no condition before this binds");
    out.push_back({variable, {}, ""});
    scope.bound[i] = true;
  }

  bool looked_up(int predicate) const { return predicate != predicate_of(Derived::given) && predicate != predicate_of(Derived::same); }

  void test(const std::string& text, const std::string& otherwise, Scope& scope, std::vector<Test>& out, const std::string& where) const {
    const Literal l = literal(text, scope, where);
    for (const Term& t : l.args) {
      if (t.variable < 0) continue;
      if (l.negated || !looked_up(l.predicate)) bind_by_type(t.variable, scope, out, where);
      scope.bound[static_cast<std::size_t>(t.variable)] = true;
    }
    out.push_back({-1, l, otherwise});
  }

  template <class List>
  std::vector<Test> tests(const List& list, const TextPlace& at, const char* field, Scope& scope) const {
    std::vector<Test> out;
    for (int i = 0; i < list.size(); ++i) test(list[i].is(), list[i].otherwise(), scope, out, at.inside(field, i).of("is"));
    return out;
  }

  /// Of a condition that is only looked at: nothing is bound by it.
  Literal closed(const std::string& text, const Scope& scope, const std::string& where) const {
    Literal l = literal(text, scope, where);
    for (const Term& t : l.args)
      if (t.variable >= 0 && !scope.bound[static_cast<std::size_t>(t.variable)])
        fail(where, scope.names[static_cast<std::size_t>(t.variable)] + " is not bound by any condition before this");
    return l;
  }

  double cost(double value, const TextPlace& at, const char* field = "cost") const {
    if (!(value >= 0) || !std::isfinite(value)) fail(at.of(field), "must be a number of 0 or more");
    return value;
  }

  template <class List>
  std::vector<Extra> extras(const List& list, const TextPlace& at, const Scope& scope) const {
    std::vector<Extra> out;
    for (int i = 0; i < list.size(); ++i) {
      const TextPlace here = at.inside("extra", i);
      out.push_back(
          {closed(list[i].when(), scope, here.of("when")), cost(list[i].cost(), here), cost(list[i].per_value(), here, "per_value")});
    }
    return out;
  }

  static Scope scope_of(const std::vector<std::string>& names, const std::vector<Type>& types) {
    return {names, types, std::vector<bool>(names.size(), true)};
  }

  void action(int index) {
    const auto& a = description_.actions(index);
    const TextPlace at = place_.inside("actions", index);
    CompiledAction& out = domain_.actions[static_cast<std::size_t>(index)];
    Scope scope = scope_of(out.parameters, out.types);
    const auto kind = std::find(std::begin(kActionKindNames), std::end(kActionKindNames), a.kind());
    if (kind == std::end(kActionKindNames))
      fail(at.of("kind"),
           "\"" + a.kind() + "\" is no action of the robot; there is " + listed(kActionKindNames, [](const char* n) { return n; }));
    out.kind = static_cast<ActionKind>(kind - std::begin(kActionKindNames));
    const auto field = [&](const std::string& text, const char* name) {
      return text.empty() ? Term{-1, "-"} : term(text, scope, at.of(name));
    };
    out.object = field(a.object(), "object");
    out.human = field(a.human(), "human");
    out.surface = field(a.surface(), "surface");
    out.when = tests(a.when(), at, "when", scope);
    out.keep = tests(a.keep(), at, "keep", scope);
    for (int i = 0; i < a.adds_size(); ++i) out.adds.push_back(effect(a.adds(i), scope, at.of("adds", i), false));
    for (int i = 0; i < a.removes_size(); ++i) out.removes.push_back(effect(a.removes(i), scope, at.of("removes", i), true));
    for (int i = 0; i < a.changes_size(); ++i)
      out.changes.push_back({effect(a.changes(i).of(), scope, at.inside("changes", i).of("of"), false), a.changes(i).by()});
    out.cost = cost(a.cost(), at);
    out.extra = extras(a.extra(), at, scope);
  }

  Literal effect(const std::string& text, const Scope& scope, const std::string& where, bool any) const {
    const Literal l = literal(text, scope, where);
    if (l.negated) fail(where, "an effect is not negated; what holds no more is listed under removes");
    for (const Term& t : l.args)
      if (!any && t.text == "*") fail(where, "* stands in conditions and removes only");
    return l;
  }

  Call call(const std::string& text, Scope& scope, std::vector<Test>& before, const std::string& where) const {
    const std::vector<std::string> parts = words(text);
    if (parts.empty()) fail(where, "a step is empty; it is written like \"move ?o ?t\"");
    Call out;
    const auto named = [&](const auto& list) {
      const auto it = std::find_if(list.begin(), list.end(), [&](const auto& entry) { return entry.name == parts[0]; });
      return it == list.end() ? -1 : static_cast<int>(it - list.begin());
    };
    out.index = named(domain_.tasks);
    if (out.index < 0) out.index = named(domain_.actions), out.action = true;
    if (out.index < 0)
      fail(where, "\"" + parts[0] + "\" is neither a task nor an action; there is " +
                      listed(domain_.tasks, [](const auto& t) { return t.name; }) + ", " +
                      listed(domain_.actions, [](const auto& a) { return a.name; }));
    const auto i = static_cast<std::size_t>(out.index);
    const std::vector<Type>& types = out.action ? domain_.actions[i].types : domain_.tasks[i].types;
    if (parts.size() - 1 != types.size())
      fail(where, parts[0] + " has " + std::to_string(types.size()) + " arguments, not " + std::to_string(parts.size() - 1));
    for (std::size_t k = 1; k < parts.size(); ++k) {
      const Term t = term(parts[k], scope, where);
      if (t.text == "*") fail(where, "* stands in conditions and removes only");
      check_type(t, types[k - 1], scope, where, parts[0]);
      if (t.variable >= 0) bind_by_type(t.variable, scope, before, where);
      out.args.push_back(t);
    }
    return out;
  }

  void task(int index) {
    const auto& t = description_.tasks(index);
    const TextPlace at = place_.inside("tasks", index);
    CompiledTask& out = domain_.tasks[static_cast<std::size_t>(index)];
    Scope head = scope_of(out.parameters, out.types);
    for (const std::string& word : words(out.text))
      if (word.starts_with('?')) term(word.substr(0, word.find_last_not_of(",.;:") + 1), head, at.of("text"));
    if (out.text.empty()) out.text = out.name;
    out.achieved = tests(t.achieved(), at, "achieved", head);
    for (int i = 0; i < t.methods_size(); ++i) out.methods.push_back(method(t.methods(i), at.inside("methods", i), out));
  }

  CompiledMethod method(const config::Method& m, const TextPlace& at, const CompiledTask& task) const {
    CompiledMethod out;
    out.name = m.name();
    out.cost = cost(m.cost(), at);
    Scope scope = scope_of(task.parameters, task.types);
    for (int i = 0; i < m.variables_size(); ++i) {
      variable(m.variables(i), at.of("variables", i), scope.names, scope.types);
      scope.bound.push_back(false);
    }
    out.tests = tests(m.when(), at, "when", scope);
    for (int i = static_cast<int>(task.parameters.size()); i < static_cast<int>(scope.names.size()); ++i)
      bind_by_type(i, scope, out.tests, at.of("variables", i - static_cast<int>(task.parameters.size())));
    out.extra = extras(m.extra(), at, scope);
    for (int i = 0; i < m.steps_size(); ++i) out.steps.push_back(step(m.steps(i), at.inside("steps", i), scope));
    out.names = scope.names;
    out.types = scope.types;
    return out;
  }

  CompiledStep step(const config::Step& s, const TextPlace& at, Scope& scope) const {
    CompiledStep out;
    if (s.has_all() == !s.task().empty()) fail(at.of(s.has_all() ? "all" : "task"), "a step is either a task or all { }");
    if (!s.has_all()) {
      std::vector<Test> none;
      out.call = call(s.task(), scope, none, at.of("task"));
      return out;
    }
    const auto& all = s.all();
    const TextPlace here = at.inside("all");
    out.all = true;
    if (all.variables().empty()) fail(at.of("all"), "needs variables");
    for (int i = 0; i < all.variables_size(); ++i) {
      out.own.push_back(static_cast<int>(scope.names.size()));
      variable(all.variables(i), here.of("variables", i), scope.names, scope.types);
      scope.bound.push_back(false);
    }
    for (int i = 0; i < all.when_size(); ++i) test(all.when(i), "", scope, out.tests, here.of("when", i));
    for (int i = 0; i < static_cast<int>(out.own.size()); ++i)
      bind_by_type(out.own[static_cast<std::size_t>(i)], scope, out.tests, here.of("variables", i));
    if (!all.order_by().empty()) out.ordered = true, out.order = closed(all.order_by(), scope, here.of("order_by"));
    if (all.steps().empty()) fail(at.of("all"), "needs steps");
    for (int i = 0; i < all.steps_size(); ++i) out.calls.push_back(call(all.steps(i), scope, out.tests, here.of("steps", i)));
    out.skip_cost = cost(all.skip_cost(), here, "skip_cost");
    for (const int v : out.own) scope.names[static_cast<std::size_t>(v)] += " (of an all)";
    return out;
  }

  /// A task whose first step leads back to it never gets to do anything.
  void find_circles() const {
    std::vector<int> state(domain_.tasks.size(), 0);
    std::vector<std::string> way;
    const std::function<void(int)> visit = [&](int t) {
      const auto i = static_cast<std::size_t>(t);
      if (state[i] == 2) return;
      way.push_back(domain_.tasks[i].name);
      state[i] = 1;
      const TextPlace at = place_.inside("tasks", t);
      for (std::size_t m = 0; m < domain_.tasks[i].methods.size(); ++m) {
        const CompiledMethod& method = domain_.tasks[i].methods[m];
        if (method.steps.empty()) continue;
        const CompiledStep& first = method.steps.front();
        const Call& next = first.all ? first.calls.front() : first.call;
        if (next.action) continue;
        if (state[static_cast<std::size_t>(next.index)] == 1 && !gets_smaller(t, method, next)) {
          std::string circle;
          const auto begin = std::find(way.begin(), way.end(), domain_.tasks[static_cast<std::size_t>(next.index)].name);
          for (auto it = begin; it != way.end(); ++it) circle += *it + ", ";
          fail(at.inside("methods", static_cast<int>(m)).inside("steps").of(first.all ? "all" : "task"),
               "goes round in a circle before anything is done: " + circle + *begin);
        }
        if (state[static_cast<std::size_t>(next.index)] == 0) visit(next.index);
      }
      way.pop_back();
      state[i] = 2;
    };
    for (int t = 0; t < static_cast<int>(domain_.tasks.size()); ++t) visit(t);
  }

  /// A task that begins with itself, but with an argument that was not given and now is: happens once.
  bool gets_smaller(int task, const CompiledMethod& method, const Call& next) const {
    if (next.index != task) return false;
    for (const Test& t : method.tests) {
      if (t.enumerate >= 0 || !t.literal.negated || t.literal.predicate != predicate_of(Derived::given)) continue;
      const int parameter = t.literal.args[0].variable;
      for (std::size_t i = 0; i < next.args.size(); ++i)
        if (static_cast<int>(i) == parameter && next.args[i].variable != parameter && next.args[i].text != "-") return true;
    }
    return false;
  }

  double least_of(const Call& call) const {
    const auto i = static_cast<std::size_t>(call.index);
    return call.action ? domain_.actions[i].cost : domain_.tasks[i].least;
  }

  void bound_costs() {
    for (int round = 0; round < kLeastRounds; ++round)
      for (CompiledTask& task : domain_.tasks) {
        double least = INFINITY;
        for (CompiledMethod& method : task.methods) {
          method.least = method.cost;
          for (const CompiledStep& step : method.steps)
            if (!step.all) method.least += least_of(step.call);
          least = std::min(least, method.least);
        }
        task.least = least;
      }
  }

  const config::TaskDomain& description_;
  const TextPlace& place_;
  Domain domain_;
};

}  // namespace

int Domain::task(const std::string& name) const {
  const auto at = std::find_if(tasks.begin(), tasks.end(), [&](const CompiledTask& t) { return t.name == name; });
  return at == tasks.end() ? -1 : static_cast<int>(at - tasks.begin());
}

Domain compile_domain(const config::TaskDomain& description, const TextPlace& place) { return Compiler(description, place).compile(); }

Domain load_domain(const std::filesystem::path& file) {
  config::TaskDomain description;
  google::protobuf::TextFormat::ParseInfoTree places;
  load_text_proto(file, description, places);
  return compile_domain(description, TextPlace(file.string(), &places, description.GetDescriptor()));
}

Domain parse_domain(const std::string& text, const std::string& name) {
  config::TaskDomain description;
  google::protobuf::TextFormat::ParseInfoTree places;
  parse_text_proto(text, name, description, places);
  return compile_domain(description, TextPlace(name, &places, description.GetDescriptor()));
}

}  // namespace handsel::supervisor
