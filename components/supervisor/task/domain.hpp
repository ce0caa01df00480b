// SPDX-License-Identifier: Apache-2.0
// A task domain (common/config/schema/task_domain.proto) checked and ready for the planner. Pure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/located.hpp"
#include "common/config/schema/task_domain.pb.h"
#include "common/messages/task.hpp"
#include "components/supervisor/world.hpp"

namespace handsel::supervisor {

/// An argument as written: a variable of the frame, a name, "*" or "-".
struct Term {
  int variable{-1};  ///< index in the frame; -1: `text`
  std::string text;  ///< a name, "*" or "-"
};

/// A condition on the state of the world, or an effect on that state.
struct Literal {
  bool negated{false};     ///< true: the condition is met when no atom fits
  int predicate{};         ///< index in Domain::predicates
  std::vector<Term> args;  ///< as many as the predicate has types
};

/// One step of binding variables: a variable is given every name of its type, or a literal is
/// looked up or tested.
struct Test {
  int enumerate{-1};      ///< variable; -1: `literal`
  Literal literal;        ///< binds its free variables, or is tested when none is free
  std::string otherwise;  ///< reason for people when the test fails; ?x stands for its value
};

/// Cost added to that of a method or an action under a condition.
struct Extra {
  Literal when;                ///< binds no variable
  double cost{}, per_value{};  ///< constant part; factor on the value of the atom; both >= 0
};

/// A task or an action with its arguments.
struct Call {
  bool action{false};      ///< true: an action, false: a task
  int index{};             ///< in Domain::actions or Domain::tasks
  std::vector<Term> args;  ///< never "*"
};

/// A step of a method: one call, or the same calls for everything that passes the tests (`all`).
struct CompiledStep {
  bool all{false};          ///< true: `calls` for every binding of `own`, false: `call`
  Call call;                ///< unless `all`
  std::vector<Test> tests;  ///< of `all`: evaluated in the state when it is the turn of this step
  bool ordered{false};      ///< true: bindings come in the order of the value of `order`
  Literal order;            ///< smallest value first; last: where the atom does not hold
  std::vector<Call> calls;  ///< of `all`: made in this order for each binding
  double skip_cost{};       ///< > 0: a binding may be left out at this cost; 0: none may be
  std::vector<int> own;     ///< variables of this step alone
};

/// One alternative for carrying out a task.
struct CompiledMethod {
  std::string name;                 ///< as in the domain file
  double cost{};                    ///< of the method itself, >= 0
  std::vector<Test> tests;          ///< in order; every binding that passes them is an alternative
  std::vector<Extra> extra;         ///< added to `cost` where their conditions hold
  std::vector<CompiledStep> steps;  ///< in order; none: nothing has to be done
  std::vector<std::string> names;   ///< of the frame's variables; the task's parameters come first
  std::vector<Type> types;          ///< of the frame's variables
  double min_cost{};                ///< lower bound of the cost with everything the method leads to
};

/// A task with its methods.
struct CompiledTask {
  std::string name, text;               ///< identifier; phrase for people, such as "give ?o to ?h"
  std::vector<std::string> parameters;  ///< names of the variables, with "?"
  std::vector<Type> types;              ///< of the parameters
  std::vector<CompiledMethod> methods;  ///< alternatives, of which the cheapest is taken
  std::vector<Test> achieved;           ///< tested after the last action; false: planned again
  double min_cost{};                    ///< lower bound of the cost over all methods
};

/// An action of the robot with its conditions and effects.
struct CompiledAction {
  std::string name;                     ///< in the domain; several actions may have the same kind
  std::vector<std::string> parameters;  ///< names of the variables, with "?"
  std::vector<Type> types;              ///< of the parameters
  ActionKind kind{};                    ///< sent in the ActionGoal
  Term object, human, surface;          ///< sent in the ActionGoal; "-": none
  bool both_hands{};                    ///< sent in the ActionGoal
  std::vector<Test> when, keep;         ///< must hold before the action; while the action runs
  std::vector<Literal> adds, removes;   ///< hold after the action; hold no longer ("*": any)
  /// Change of the value of an atom.
  struct Change {
    Literal of;   ///< the atom
    double by{};  ///< added to the value; an atom with a value of 0 or less holds no longer
  };
  std::vector<Change> changes;  ///< of values of atoms, after the action
  double cost{};                ///< >= 0
  std::vector<Extra> extra;     ///< added to `cost` where their conditions hold
};

/// Predicates, tasks and actions of a task domain; other structures refer to them by index.
struct Domain {
  std::vector<PredicateSign> predicates;    ///< known_predicates(), then those of the domain itself
  std::vector<CompiledTask> tasks;          ///< in the order of the file
  std::vector<CompiledAction> actions;      ///< in the order of the file
  int task(const std::string& name) const;  ///< index of the task with this name; -1: none
};

/// Throws ConfigError "file:line:field: ..." for what is unknown, unbound, of the wrong type, or
/// goes round in a circle.
Domain compile_domain(const config::TaskDomain& description, const TextPlace& place);
/// Reads and compiles a domain file. Throws ConfigError or MissingError like parse_domain().
Domain load_domain(const std::filesystem::path& file);
/// `name` stands for the file in errors.
Domain parse_domain(const std::string& text, const std::string& name);

}  // namespace handsel::supervisor
