// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/regrasp/regrasp_desk.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>

namespace handsel::grasp_planner {
namespace {

// [N] of Grasp::margin: weaker grasps are used only where firmer ones give no plan.
constexpr std::array kMinMargins{0.0, -2.0, -std::numeric_limits<double>::infinity()};
constexpr std::size_t kMinSteps = 3;  // pick, pass and place: the min of a regrasp plan

RegraspKind kind_of(RegraspStepKind kind) {
  switch (kind) {
    case RegraspStepKind::pick:
      return RegraspKind::pick;
    case RegraspStepKind::pass:
      return RegraspKind::pass;
    case RegraspStepKind::join:
      return RegraspKind::join;
    case RegraspStepKind::place:
      break;
  }
  return RegraspKind::place;
}

handsel::RegraspStep message_of(const RegraspStep& step, const std::vector<RegraspArm>& arms) {
  handsel::RegraspStep out;
  out.kind = kind_of(step.kind);
  const auto name_of = [&](int arm) {
    return arm < 0 ? std::string() : arms[static_cast<std::size_t>(arm)].arm.name;
  };
  out.from = name_of(step.from);
  out.to = name_of(step.to);
  out.T_world_object = step.T_world_object;
  out.q = step.q;
  out.before = step.before;
  out.after = step.after;
  const bool comes = step.to >= 0;
  const RegraspArm& arm = arms[static_cast<std::size_t>(comes ? step.to : step.from)];
  out.grasp = arm.list->grasps[comes ? step.grasp_to : step.grasp_from].grasp;
  out.grasp.arm_joints = RobotModel::part(step.q, *arm.arm.arm);
  out.grasp.approach_joints = RobotModel::part(comes ? step.before : step.after, *arm.arm.arm);
  return out;
}

/// Returns the index of the arm that holds the object; -1: on a support.
int holder_of(const RegraspRequest& request, const std::vector<ArmGrasps>& arms) {
  const auto holder = std::find_if(
      arms.begin(), arms.end(), [&](const ArmGrasps& a) { return a.arm.name == request.holder; });
  return holder == arms.end() ? -1 : static_cast<int>(holder - arms.begin());
}

/// Returns why the object cannot be passed on by the hand that is said to hold it; empty: it can.
std::string objection_to_holder(const RegraspRequest& request, const SceneObject& object,
                                const std::vector<ArmGrasps>& arms) {
  const int index = holder_of(request, arms);
  if (index < 0) return "the robot has no arm \"" + request.holder + "\" with a hand";
  const Group& fingers = *arms[static_cast<std::size_t>(index)].arm.fingers;
  const bool is_that_hand =
      object.holder_id.empty() ? index == 0 : object.holder_id == fingers.name;
  if (object.holder != Holder::robot || !is_that_hand)
    return "the hand of " + request.holder + " does not hold " + request.object;
  const auto axes = static_cast<Eigen::Index>(fingers.axes.size());
  if (request.grasp.hand_joints.size() != axes || request.grasp.pregrasp_joints.size() != axes)
    return "the grasp does not have one value per axis of " + fingers.name + ", closed and opened";
  if (request.both) return request.object + " is held: two hands take only what stands";
  return {};
}

void write(const RegraspPlan& plan, const std::vector<RegraspArm>& arms, RegraspReply& reply) {
  reply.solved = plan.solved;
  reply.reason = plan.reason;
  reply.rejected = plan.rejected;
  reply.steps.clear();
  for (const RegraspStep& step : plan.steps) reply.steps.push_back(message_of(step, arms));
}

}  // namespace

std::string objection(const RegraspRequest& request, const Scene& scene, const RobotModel& robot,
                      const std::vector<ArmGrasps>& arms, const ObjectLibrary& library) {
  if (arms.size() != 2)
    return "the robot has " + std::to_string(arms.size()) +
           " arms with hands, to pass an object it needs two";
  if (!scene.robot_known) return "the place of the robot is not known yet";
  if (request.start.size() != robot.dof())
    return "the start has " + std::to_string(request.start.size()) + " axes, the robot has " +
           std::to_string(robot.dof());
  const auto object = std::find_if(scene.objects.begin(), scene.objects.end(),
                                   [&](const SceneObject& o) { return o.id == request.object; });
  if (object == scene.objects.end()) return "object " + request.object + " is not in the scene";
  if (library(object->model) == nullptr)
    return "there is no description of " + request.object + ", grasps need one";
  if (!request.holder.empty()) return objection_to_holder(request, *object, arms);
  if (object->holder == Holder::robot || object->holder == Holder::human)
    return request.object + " is held: it must stand first";
  return {};
}

namespace {

/// The grasps of all arms on the object.
struct ListedGrasps {
  std::vector<std::shared_ptr<const CachedGrasps>> pages;
  std::vector<GraspList> whole;  // one per arm
};

void answer_together(const RegraspRequest& request, const RegraspStage& stage,
                     const ListedGrasps& listed, const Pose& T_world_start,
                     const std::function<bool()>& cancelled, RegraspAnswer& answer) {
  std::vector<RegraspArm> sides;
  for (std::size_t a = 0; a < stage.arms.size(); ++a)
    sides.push_back({stage.arms[a].arm, stage.arms[a].hand_geometry.get(), &listed.whole[a]});
  RegraspPlanner planner(stage.robot, sides, *listed.pages.front()->object, stage.library,
                         stage.scene, request.object);
  planner.set_settings(stage.settings);
  for (const StandingPlace& goal : request.goals) {
    const RegraspPlan plan =
        planner.plan_together({T_world_start, goal.T_world_object, request.in_air}, cancelled);
    answer.checked += plan.checked;
    write(plan, sides, answer.reply);
    for (std::size_t a = 0; a < plan.load_shares.size(); ++a) {
      answer.reply.steps[a].grasp.hand_effort = plan.load_shares[a].effort;
      answer.reply.steps[a].grasp.margin = plan.load_shares[a].margin;
    }
    if (plan.solved || (cancelled && cancelled())) return;
  }
}

void answer_one_after_the_other(const RegraspRequest& request, const RegraspStage& stage,
                                const ListedGrasps& listed, RegraspTask task,
                                const std::function<bool()>& cancelled, RegraspAnswer& answer) {
  const std::vector<ArmGrasps>& arms = stage.arms;
  for (const double min_margin : kMinMargins) {
    std::vector<GraspList> firm(arms.size());
    std::vector<RegraspArm> sides;
    for (std::size_t a = 0; a < arms.size(); ++a) {
      const std::vector<ListedGrasp>& all = listed.whole[a].grasps;
      std::copy_if(all.begin(), all.end(), std::back_inserter(firm[a].grasps),
                   [min_margin](const ListedGrasp& g) { return g.grasp.margin >= min_margin; });
      if (task.start.arm == static_cast<int>(a)) {
        task.start.grasp = firm[a].grasps.size();
        firm[a].grasps.push_back({request.grasp, {}, 0});
      }
      sides.push_back({arms[a].arm, arms[a].hand_geometry.get(), &firm[a]});
    }
    const bool any = std::all_of(firm.begin(), firm.end(),
                                 [](const GraspList& list) { return !list.grasps.empty(); });
    if (!any && min_margin != kMinMargins.back()) continue;
    RegraspPlanner planner(stage.robot, sides, *listed.pages.front()->object, stage.library,
                           stage.scene, request.object);
    planner.set_settings(stage.settings);
    const RegraspPlan plan = planner.plan(task, cancelled);
    answer.checked += plan.checked;
    // A plan with weaker grasps replaces one with firmer grasps only if it has fewer steps.
    if (!plan.solved ? !answer.reply.solved
                     : !answer.reply.solved || plan.steps.size() < answer.reply.steps.size()) {
      write(plan, sides, answer.reply);
    }
    const bool better_by_weaker = min_margin >= 0 && answer.reply.steps.size() > kMinSteps;
    if ((answer.reply.solved && !better_by_weaker) || (cancelled && cancelled())) break;
  }
}

}  // namespace

RegraspAnswer answer_regrasp(const RegraspRequest& request, const RegraspStage& stage,
                             const ObjectModel& model, const std::function<bool()>& cancelled) {
  RegraspAnswer answer;
  answer.reply.id = request.id;
  const std::vector<SceneObject>& objects = stage.scene.objects;
  const auto object = std::find_if(objects.begin(), objects.end(),
                                   [&](const SceneObject& o) { return o.id == request.object; });
  if (object == objects.end()) {
    answer.reply.reason = "object " + request.object + " is not in the scene";
    return answer;
  }
  ListedGrasps listed;
  for (const ArmGrasps& arm : stage.arms) {
    listed.pages.push_back(arm.cache->page(model, cancelled));
    if (!listed.pages.back()) {
      answer.reply.reason = "cancelled";
      return answer;
    }
    listed.whole.emplace_back().grasps = listed.pages.back()->list.grasps;
    answer.listed += listed.whole.back().grasps.size();
  }
  if (request.both) {
    answer_together(request, stage, listed, object->T_world_object, cancelled, answer);
    return answer;
  }
  RegraspTask task;
  task.start.arm = request.holder.empty() ? -1 : holder_of(request, stage.arms);
  task.start.T_world_object = object->T_world_object;
  task.goal.T_world_object = request.goals.front().T_world_object;
  for (std::size_t i = 1; i < request.goals.size(); ++i)
    task.other_goals.push_back(request.goals[i].T_world_object);
  answer_one_after_the_other(request, stage, listed, task, cancelled, answer);
  return answer;
}

Duration regrasp_time(const RegraspAnswer& answer) {
  return from_seconds(0.05 + 4e-3 * static_cast<double>(answer.checked) +
                      2e-4 * static_cast<double>(answer.listed));
}

}  // namespace handsel::grasp_planner
