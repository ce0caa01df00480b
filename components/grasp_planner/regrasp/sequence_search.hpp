// SPDX-License-Identifier: Apache-2.0
// The shortest sequence of picks, passes and places for one task.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "components/grasp_planner/regrasp/step_check.hpp"
#include "components/grasp_planner/regrasp/step_graph.hpp"

namespace handsel::grasp_planner {

/// Passes checked so far, whatever the task: arm and grasp of the hand that holds the object, then
/// of the hand that takes it.
using CheckedPasses = std::map<std::tuple<int, std::size_t, int, std::size_t>, CheckedStep>;

/// One task: the graph of what may be possible; its steps are checked only where the shortest
/// sequence leads over them.
class SequenceSearch {
 public:
  /// ConfigError when start or goal name an arm or a grasp that is not there. The arguments must
  /// outlive this object.
  SequenceSearch(StepCheck& check, CheckedPasses& passes, const RegraspTask& task);

  /// Returns the plan; see RegraspPlanner::plan(). To be called once.
  RegraspPlan run(const std::function<bool()>& cancelled);

 private:
  void check_task() const;
  void add_places();
  void add_grasps();
  void add_passes(const std::function<bool()>& cancelled);
  bool at_goal(const GraphNode& node) const;
  const CheckedStep& pick(const GraphNode& held, std::size_t place);
  CheckedStep pass(const GraphNode& from, const GraphNode& to);
  CheckedStep step(const GraphNode& from, const GraphNode& to);
  bool take_path(const std::vector<GraphNode>& path);
  RegraspPlan finish();

  StepCheck& check_;
  CheckedPasses& passes_;
  const RegraspTask& task_;
  /// Places of `places_`, the end not among them.
  struct PlaceRange {
    std::size_t first{}, end{};
  };

  std::vector<Pose> places_;  // start and goals where the object stands, and those between
  GraphNode start_;
  PlaceRange goals_;
  std::vector<HandSide> sides_;
  StepGraph graph_;
  DoubleList doubles_;
  std::map<std::tuple<int, std::size_t, std::size_t>, CheckedStep> picks_;  // arm, grasp, place
  std::map<std::string, std::uint64_t> rejected_;                           // by kind and reason
  RegraspPlan out_;
};

}  // namespace handsel::grasp_planner
