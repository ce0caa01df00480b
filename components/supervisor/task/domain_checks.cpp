// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/domain_checks.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "components/supervisor/task/domain_text.hpp"

namespace handsel::supervisor {
namespace {

constexpr int kBoundRounds = 32;  // levels of tasks considered by the lower bound

/// Returns whether a task that begins with itself gives an argument that was not given before: that
/// happens once.
bool gets_smaller(int task, const CompiledMethod& method, const Call& next) {
  if (next.index != task) return false;
  for (const Test& t : method.tests) {
    if (t.enumerate >= 0 || !t.literal.negated ||
        t.literal.predicate != predicate_of(Derived::given))
      continue;
    const int parameter = t.literal.args[0].variable;
    for (std::size_t i = 0; i < next.args.size(); ++i)
      if (static_cast<int>(i) == parameter && next.args[i].variable != parameter &&
          next.args[i].text != "-")
        return true;
  }
  return false;
}

double min_cost_of(const Domain& domain, const Call& call) {
  const auto i = static_cast<std::size_t>(call.index);
  return call.action ? domain.actions[i].cost : domain.tasks[i].min_cost;
}

}  // namespace

void check_for_circles(const Domain& domain, const TextPlace& place) {
  std::vector<int> state(domain.tasks.size(), 0);
  std::vector<std::string> path;
  const std::function<void(int)> visit = [&](int t) {
    const auto i = static_cast<std::size_t>(t);
    if (state[i] == 2) return;
    path.push_back(domain.tasks[i].name);
    state[i] = 1;
    const TextPlace at = place.inside("tasks", t);
    for (std::size_t m = 0; m < domain.tasks[i].methods.size(); ++m) {
      const CompiledMethod& method = domain.tasks[i].methods[m];
      if (method.steps.empty()) continue;
      const CompiledStep& first = method.steps.front();
      const Call& next = first.all ? first.calls.front() : first.call;
      if (next.action) continue;
      if (state[static_cast<std::size_t>(next.index)] == 1 && !gets_smaller(t, method, next)) {
        std::string circle;
        const auto begin = std::find(path.begin(), path.end(),
                                     domain.tasks[static_cast<std::size_t>(next.index)].name);
        for (auto it = begin; it != path.end(); ++it) circle += *it + ", ";
        throw_at(at.inside("methods", static_cast<int>(m))
                     .inside("steps")
                     .of(first.all ? "all" : "task"),
                 "goes round in a circle before anything is done: " + circle + *begin);
      }
      if (state[static_cast<std::size_t>(next.index)] == 0) visit(next.index);
    }
    path.pop_back();
    state[i] = 2;
  };
  for (int t = 0; t < static_cast<int>(domain.tasks.size()); ++t) visit(t);
}

void bound_costs(Domain& domain) {
  for (int round = 0; round < kBoundRounds; ++round)
    for (CompiledTask& task : domain.tasks) {
      double min_cost = INFINITY;
      for (CompiledMethod& method : task.methods) {
        method.min_cost = method.cost;
        for (const CompiledStep& step : method.steps)
          if (!step.all) method.min_cost += min_cost_of(domain, step.call);
        min_cost = std::min(min_cost, method.min_cost);
      }
      task.min_cost = min_cost;
    }
}

}  // namespace handsel::supervisor
