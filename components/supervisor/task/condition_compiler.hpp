// SPDX-License-Identifier: Apache-2.0
// Conditions, effects and costs of a task domain: checked text becomes literals and tests. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/config/located.hpp"
#include "common/config/schema/task_domain.pb.h"
#include "components/supervisor/task/domain.hpp"

namespace handsel::supervisor {

/// The variables known at the place of a condition.
struct Scope {
  std::vector<std::string> names;  ///< with "?"
  std::vector<Type> types;         ///< by variable
  std::vector<bool> bound;         ///< by variable; true: a condition before has given it a value

  /// Returns the scope of declared parameters, all of which are bound.
  static Scope of(const std::vector<std::string>& names, const std::vector<Type>& types);
  /// Returns the index of the variable with this name; -1: none.
  int find(const std::string& name) const;
};

/// Compiles the parts of tasks and actions that speak of the state of the world. Every function
/// throws ConfigError at the place `where` for what is unknown, unbound or of the wrong type.
class ConditionCompiler {
 public:
  using Texts = google::protobuf::RepeatedPtrField<std::string>;

  /// `predicates`: of the domain; must outlive this object and may still grow.
  explicit ConditionCompiler(const std::vector<PredicateSign>& predicates)
      : predicates_(predicates) {}

  /// Returns the index of the predicate with this name; -1: none.
  int predicate(const std::string& name) const;
  /// Returns the type with this name.
  Type type(const std::string& text, const std::string& where) const;
  /// Adds the variable that a text such as "?o:object" declares.
  void variable(const std::string& text, const std::string& where, std::vector<std::string>& names,
                std::vector<Type>& types) const;
  /// Adds the variables of the field "parameters".
  void parameters(const Texts& list, const TextPlace& at, std::vector<std::string>& names,
                  std::vector<Type>& types) const;
  /// Returns the argument as written; a variable must be declared.
  Term term(const std::string& text, const Scope& scope, const std::string& where) const;
  /// Checks that a variable has the wanted type. `what`: the predicate or task that wants it.
  void check_type(const Term& term, Type wanted, const Scope& scope, const std::string& where,
                  const std::string& what) const;
  /// Adds a test that gives the variable every name of its type, unless the variable is bound.
  void bind_by_type(int variable, Scope& scope, std::vector<Test>& out,
                    const std::string& where) const;
  /// Adds the test of one condition, which binds its variables. `otherwise`: see Test.
  void test(const std::string& text, const std::string& otherwise, Scope& scope,
            std::vector<Test>& out, const std::string& where) const;
  /// Returns the tests of a list of conditions in `field`.
  std::vector<Test> tests(const google::protobuf::RepeatedPtrField<config::Condition>& list,
                          const TextPlace& at, const char* field, Scope& scope) const;
  /// Returns a condition that binds nothing; all its variables must be bound.
  Literal closed(const std::string& text, const Scope& scope, const std::string& where) const;
  /// Returns an effect. `any`: "*" may stand for every argument.
  Literal effect(const std::string& text, const Scope& scope, const std::string& where,
                 bool any) const;
  /// Returns the value, which must be a number of 0 or more. `field`: named in the error.
  double cost(double value, const TextPlace& at, const char* field = "cost") const;
  /// Returns the costs under conditions of the field "extra".
  std::vector<Extra> extras(const google::protobuf::RepeatedPtrField<config::ExtraCost>& list,
                            const TextPlace& at, const Scope& scope) const;

 private:
  Literal literal(const std::string& text, const Scope& scope, const std::string& where) const;

  const std::vector<PredicateSign>& predicates_;
};

}  // namespace handsel::supervisor
