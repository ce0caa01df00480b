// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/regrasp/regrasp.hpp"

#include "components/grasp_planner/regrasp/sequence_search.hpp"
#include "components/grasp_planner/regrasp/step_check.hpp"
#include "components/grasp_planner/regrasp/two_hands.hpp"

namespace handsel::grasp_planner {

const char* name(RegraspStepKind kind) {
  switch (kind) {
    case RegraspStepKind::pick:
      return "pick";
    case RegraspStepKind::pass:
      return "pass";
    case RegraspStepKind::place:
      return "place";
    case RegraspStepKind::join:
      return "join";
  }
  return "unknown";
}

struct RegraspPlanner::Impl {
  StepCheck check;
  CheckedPasses passes;
};

RegraspPlanner::RegraspPlanner(const RobotModel& robot, std::vector<RegraspArm> arms,
                               const Graspable& object, ObjectLibrary library, const Scene& scene,
                               const std::string& object_id)
    : impl_(new Impl{
          StepCheck(robot, std::move(arms), object, std::move(library), scene, object_id), {}}) {}
RegraspPlanner::~RegraspPlanner() = default;

void RegraspPlanner::set_settings(const RegraspSettings& settings) {
  impl_->check.set_settings(settings);
  impl_->passes.clear();
}

RegraspPlan RegraspPlanner::plan(const RegraspTask& task, const std::function<bool()>& cancelled) {
  return SequenceSearch(impl_->check, impl_->passes, task).run(cancelled);
}

RegraspPlan RegraspPlanner::plan_together(const TwoHandTask& task,
                                          const std::function<bool()>& cancelled) {
  return carry_together(impl_->check, task, cancelled);
}

}  // namespace handsel::grasp_planner
