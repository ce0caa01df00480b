// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/condition_compiler.hpp"

#include <algorithm>
#include <cmath>

#include "components/supervisor/task/domain_text.hpp"

namespace handsel::supervisor {
namespace {

bool looked_up(int predicate) {
  return predicate != predicate_of(Derived::given) && predicate != predicate_of(Derived::same);
}

}  // namespace

Scope Scope::of(const std::vector<std::string>& names, const std::vector<Type>& types) {
  return {names, types, std::vector<bool>(names.size(), true)};
}

int Scope::find(const std::string& name) const {
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

Type ConditionCompiler::type(const std::string& text, const std::string& where) const {
  for (const Type t : {Type::object, Type::surface, Type::human, Type::name})
    if (text == supervisor::name(t)) return t;
  throw_at(where, "\"" + text + "\" is no type; there is object, surface, human, name");
}

void ConditionCompiler::variable(const std::string& text, const std::string& where,
                                 std::vector<std::string>& names, std::vector<Type>& types) const {
  const auto colon = text.find(':');
  if (!text.starts_with('?') || colon == std::string::npos || colon < 2)
    throw_at(where,
             "\"" + text + "\" declares no variable; it is written ?name:type, e.g. ?o:object");
  const std::string variable = text.substr(0, colon);
  if (std::find(names.begin(), names.end(), variable) != names.end())
    throw_at(where, variable + " is declared already");
  types.push_back(type(text.substr(colon + 1), where));
  names.push_back(variable);
}

void ConditionCompiler::parameters(const Texts& list, const TextPlace& at,
                                   std::vector<std::string>& names,
                                   std::vector<Type>& types) const {
  for (int i = 0; i < list.size(); ++i) variable(list[i], at.of("parameters", i), names, types);
}

int ConditionCompiler::predicate(const std::string& name) const {
  const auto at = std::find_if(predicates_.begin(), predicates_.end(),
                               [&](const auto& p) { return p.name == name; });
  return at == predicates_.end() ? -1 : static_cast<int>(at - predicates_.begin());
}

Term ConditionCompiler::term(const std::string& text, const Scope& scope,
                             const std::string& where) const {
  if (!text.starts_with('?')) return {-1, text};
  const int index = scope.find(text);
  if (index < 0)
    throw_at(where, text + " is not declared here; there is " +
                        listed(scope.names, [](const auto& n) { return n; }));
  return {index, ""};
}

void ConditionCompiler::check_type(const Term& term, Type wanted, const Scope& scope,
                                   const std::string& where, const std::string& what) const {
  if (term.variable < 0 || wanted == Type::name) return;
  const Type has = scope.types[static_cast<std::size_t>(term.variable)];
  if (has != wanted && has != Type::name)
    throw_at(where, what + " wants a " + supervisor::name(wanted) + " where " +
                        scope.names[static_cast<std::size_t>(term.variable)] + " is a " +
                        supervisor::name(has));
}

Literal ConditionCompiler::literal(const std::string& text, const Scope& scope,
                                   const std::string& where) const {
  std::vector<std::string> parts = words(text);
  Literal out;
  if (!parts.empty() && parts[0] == "not") out.negated = true, parts.erase(parts.begin());
  if (parts.empty())
    throw_at(where, "a condition is empty; it is written like \"on_surface ?o ?s\"");
  out.predicate = predicate(parts[0]);
  if (out.predicate < 0)
    throw_at(where, "\"" + parts[0] + "\" is no predicate; there is " +
                        listed(predicates_, [](const auto& p) { return p.name; }));
  const PredicateSign& sign = predicates_[static_cast<std::size_t>(out.predicate)];
  if (parts.size() - 1 != sign.types.size())
    throw_at(where, sign.name + " has " + std::to_string(sign.types.size()) + " arguments, not " +
                        std::to_string(parts.size() - 1));
  for (std::size_t i = 1; i < parts.size(); ++i) {
    out.args.push_back(term(parts[i], scope, where));
    check_type(out.args.back(), sign.types[i - 1], scope, where, sign.name);
  }
  return out;
}

void ConditionCompiler::bind_by_type(int variable, Scope& scope, std::vector<Test>& out,
                                     const std::string& where) const {
  const auto i = static_cast<std::size_t>(variable);
  if (scope.bound[i]) return;
  if (scope.types[i] == Type::name)
    throw_at(where, scope.names[i] + " is a name that no condition before this binds");
  out.push_back({variable, {}, ""});
  scope.bound[i] = true;
}

void ConditionCompiler::test(const std::string& text, const std::string& otherwise, Scope& scope,
                             std::vector<Test>& out, const std::string& where) const {
  const Literal l = literal(text, scope, where);
  for (const Term& t : l.args) {
    if (t.variable < 0) continue;
    if (l.negated || !looked_up(l.predicate)) bind_by_type(t.variable, scope, out, where);
    scope.bound[static_cast<std::size_t>(t.variable)] = true;
  }
  out.push_back({-1, l, otherwise});
}

std::vector<Test> ConditionCompiler::tests(
    const google::protobuf::RepeatedPtrField<config::Condition>& list, const TextPlace& at,
    const char* field, Scope& scope) const {
  std::vector<Test> out;
  for (int i = 0; i < list.size(); ++i)
    test(list[i].is(), list[i].otherwise(), scope, out, at.inside(field, i).of("is"));
  return out;
}

Literal ConditionCompiler::closed(const std::string& text, const Scope& scope,
                                  const std::string& where) const {
  Literal l = literal(text, scope, where);
  for (const Term& t : l.args)
    if (t.variable >= 0 && !scope.bound[static_cast<std::size_t>(t.variable)])
      throw_at(where, scope.names[static_cast<std::size_t>(t.variable)] +
                          " is not bound by any condition before this");
  return l;
}

double ConditionCompiler::cost(double value, const TextPlace& at, const char* field) const {
  if (!(value >= 0) || !std::isfinite(value))
    throw_at(at.of(field), "must be a number of 0 or more");
  return value;
}

std::vector<Extra> ConditionCompiler::extras(
    const google::protobuf::RepeatedPtrField<config::ExtraCost>& list, const TextPlace& at,
    const Scope& scope) const {
  std::vector<Extra> out;
  for (int i = 0; i < list.size(); ++i) {
    const TextPlace here = at.inside("extra", i);
    out.push_back({closed(list[i].when(), scope, here.of("when")), cost(list[i].cost(), here),
                   cost(list[i].per_value(), here, "per_value")});
  }
  return out;
}

Literal ConditionCompiler::effect(const std::string& text, const Scope& scope,
                                  const std::string& where, bool any) const {
  Literal l = literal(text, scope, where);
  if (l.negated)
    throw_at(where, "an effect is not negated; what holds no more is listed under removes");
  for (const Term& t : l.args)
    if (!any && t.text == "*") throw_at(where, "* stands in conditions and removes only");
  return l;
}

}  // namespace handsel::supervisor
