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

struct Literal {
  bool negated{false};
  int predicate{};
  std::vector<Term> args;
};

/// One step of binding variables: a variable is given every name of its type, or a literal is looked up or tested.
struct Test {
  int enumerate{-1};  ///< variable; -1: `literal`
  Literal literal;
  std::string otherwise;
};

struct Extra {
  Literal when;
  double cost{}, per_value{};
};

struct Call {
  bool action{false};
  int index{};  ///< of the task or the action
  std::vector<Term> args;
};

struct CompiledStep {
  bool all{false};
  Call call;  ///< unless `all`
  std::vector<Test> tests;
  bool ordered{false};
  Literal order;
  std::vector<Call> calls;
  double skip_cost{};
  std::vector<int> own;  ///< variables of this step alone
};

struct CompiledMethod {
  std::string name;
  double cost{};
  std::vector<Test> tests;
  std::vector<Extra> extra;
  std::vector<CompiledStep> steps;
  std::vector<std::string> names;  ///< of the frame's variables; the task's parameters come first
  std::vector<Type> types;
  double least{};  ///< a bound from below on the cost with all it leads to
};

struct CompiledTask {
  std::string name, text;
  std::vector<std::string> parameters;
  std::vector<Type> types;
  std::vector<CompiledMethod> methods;
  std::vector<Test> achieved;
  double least{};
};

struct CompiledAction {
  std::string name;
  std::vector<std::string> parameters;
  std::vector<Type> types;
  ActionKind kind{};
  Term object, human, surface;
  std::vector<Test> when, keep;
  std::vector<Literal> adds, removes;
  struct Change {
    Literal of;
    double by{};
  };
  std::vector<Change> changes;
  double cost{};
  std::vector<Extra> extra;
};

struct Domain {
  std::vector<PredicateSign> predicates;
  std::vector<CompiledTask> tasks;
  std::vector<CompiledAction> actions;
  int task(const std::string& name) const;  ///< -1: none
};

/// Throws ConfigError "file:line:field: ..." for what is unknown, unbound, of the wrong type, or goes round in a circle.
Domain compile_domain(const config::TaskDomain& description, const TextPlace& place);
Domain load_domain(const std::filesystem::path& file);
/// `name` stands for the file in errors.
Domain parse_domain(const std::string& text, const std::string& name);

}  // namespace handsel::supervisor
