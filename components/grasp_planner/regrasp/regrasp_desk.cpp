#include "components/grasp_planner/regrasp/regrasp_desk.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>

namespace handsel::grasp_planner {
namespace {

// [N] of Grasp::margin: weaker grasps are taken only where firmer ones lead nowhere.
constexpr std::array kMinMargins{0.0, -2.0, -std::numeric_limits<double>::infinity()};
constexpr std::size_t kFewest = 3;  // steps from one hand by the other to its place

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

void write(const RegraspPlan& plan, const std::vector<RegraspArm>& arms, RegraspReply& reply) {
  reply.solved = plan.solved;
  reply.reason = plan.reason;
  reply.rejected = plan.rejected;
  reply.steps.clear();
  for (const RegraspStep& step : plan.steps) reply.steps.push_back(message_of(step, arms));
}

}  // namespace

std::string objection(const RegraspRequest& request, const Scene& scene, const RobotModel& robot,
                      std::size_t arms, const ObjectLibrary& library) {
  if (arms != 2)
    return "the robot has " + std::to_string(arms) +
           " arms with hands, to pass an object it needs two";
  if (!scene.robot_known) return "the place of the robot is not known yet";
  if (request.start.size() != robot.dof())
    return "the start has " + std::to_string(request.start.size()) + " axes, the robot has " +
           std::to_string(robot.dof());
  const auto object = std::find_if(scene.objects.begin(), scene.objects.end(),
                                   [&](const SceneObject& o) { return o.id == request.object; });
  if (object == scene.objects.end()) return "object " + request.object + " is not in the scene";
  if (object->holder == Holder::robot || object->holder == Holder::human)
    return request.object + " is held: it must stand first";
  if (library(object->model) == nullptr)
    return "there is no description of " + request.object + ", grasps need one";
  return {};
}

RegraspAnswer answer_regrasp(const RegraspRequest& request, const RegraspStage& stage,
                             const ObjectModel& model, const std::function<bool()>& cancelled) {
  const std::vector<ArmGrasps>& arms = stage.arms;
  const Scene& scene = stage.scene;
  RegraspAnswer answer;
  answer.reply.id = request.id;
  const auto object = std::find_if(scene.objects.begin(), scene.objects.end(),
                                   [&](const SceneObject& o) { return o.id == request.object; });
  if (object == scene.objects.end()) {
    answer.reply.reason = "object " + request.object + " is not in the scene";
    return answer;
  }
  std::vector<std::shared_ptr<const CachedGrasps>> pages;
  std::vector<GraspList> whole(arms.size());
  for (std::size_t a = 0; a < arms.size(); ++a) {
    pages.push_back(arms[a].cache->page(model, cancelled));
    if (!pages.back()) {
      answer.reply.reason = "cancelled";
      return answer;
    }
    whole[a].grasps = pages.back()->list.grasps;
    answer.listed += whole[a].grasps.size();
  }
  RegraspTask task;
  task.start.T_world_object = object->T_world_object;
  task.goal.T_world_object = request.T_world_goal;
  if (request.both) {
    std::vector<RegraspArm> sides;
    for (std::size_t a = 0; a < arms.size(); ++a)
      sides.push_back({arms[a].arm, arms[a].hand_geometry.get(), &whole[a]});
    RegraspPlanner planner(stage.robot, sides, *pages.front()->object, stage.library, scene,
                           request.object);
    planner.set_settings(stage.settings);
    const RegraspPlan plan =
        planner.plan_together(task.start.T_world_object, task.goal.T_world_object, cancelled);
    answer.checked = plan.checked;
    write(plan, sides, answer.reply);
    for (std::size_t a = 0; a < plan.load_shares.size(); ++a) {
      answer.reply.steps[a].grasp.hand_effort = plan.load_shares[a].effort;
      answer.reply.steps[a].grasp.margin = plan.load_shares[a].margin;
    }
    return answer;
  }
  for (const double min_margin : kMinMargins) {
    std::vector<GraspList> firm(arms.size());
    std::vector<RegraspArm> sides;
    for (std::size_t a = 0; a < arms.size(); ++a) {
      std::copy_if(whole[a].grasps.begin(), whole[a].grasps.end(),
                   std::back_inserter(firm[a].grasps),
                   [min_margin](const ListedGrasp& g) { return g.grasp.margin >= min_margin; });
      sides.push_back({arms[a].arm, arms[a].hand_geometry.get(), &firm[a]});
    }
    const bool any = std::all_of(firm.begin(), firm.end(),
                                 [](const GraspList& list) { return !list.grasps.empty(); });
    if (!any && min_margin != kMinMargins.back()) continue;
    RegraspPlanner planner(stage.robot, sides, *pages.front()->object, stage.library, scene,
                           request.object);
    planner.set_settings(stage.settings);
    const RegraspPlan plan = planner.plan(task, cancelled);
    answer.checked += plan.checked;
    // A firm grip is not worth handing the object to and fro.
    if (!plan.solved ? !answer.reply.solved
                     : !answer.reply.solved || plan.steps.size() < answer.reply.steps.size()) {
      write(plan, sides, answer.reply);
    }
    const bool better_by_weaker = min_margin >= 0 && answer.reply.steps.size() > kFewest;
    if ((answer.reply.solved && !better_by_weaker) || (cancelled && cancelled())) break;
  }
  return answer;
}

Duration regrasp_time(const RegraspAnswer& answer) {
  return from_seconds(0.05 + 4e-3 * static_cast<double>(answer.checked) +
                      2e-4 * static_cast<double>(answer.listed));
}

}  // namespace handsel::grasp_planner
