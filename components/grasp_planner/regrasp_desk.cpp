#include "components/grasp_planner/regrasp_desk.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>

namespace handsel::grasp_planner {
namespace {

// [N] of Grasp::margin: weaker grasps are taken only where firmer ones lead nowhere.
constexpr std::array kLeastMargins{0.0, -2.0, -std::numeric_limits<double>::infinity()};
constexpr std::size_t kFewest = 3;     // steps from one hand by the other to its place
constexpr double kLeastEffort = 0.05;  // [Nm]

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

/// Two hands bear half of the weight each, at their own contacts: the other hand sees to it that nothing turns. The squeeze for that.
void share_load(const HandKit& kit, const ObjectModel& model, const GripForceSettings& settings, Grasp& g) {
  std::vector<PointContact> contacts;
  Vector3 middle = Vector3::Zero();
  for (const Contact& c : g.contacts) {
    contacts.push_back({c.position, -c.normal, c.friction});
    middle += c.position / static_cast<double>(g.contacts.size());
  }
  const GripForces grip = grip_forces(contacts, middle, 0.5 * model.mass, settings);
  g.margin = grip.margin;
  g.hand_effort = Vector::Zero(g.hand_joints.size());
  std::vector<std::vector<Pose>> T_hand_step;
  kit.forward(g.hand_joints, T_hand_step);
  const Pose T_hand_object = g.T_object_hand.inverse();
  for (std::size_t k = 0; k < grip.forces.size(); ++k) {
    const std::size_t finger = g.contacts[k].finger;
    kit.chains[finger].add_effort(T_hand_step[finger], T_hand_object, g.contacts[k].position, grip.forces[k], g.hand_effort);
  }
  // Where nothing bears it for sure the hand squeezes as it does when it is told no efforts.
  if (!g.hand_effort.allFinite() || g.hand_effort.cwiseAbs().maxCoeff() < kLeastEffort) g.hand_effort.resize(0);
}

handsel::RegraspStep told(const RegraspStep& step, const std::vector<RegraspArm>& arms) {
  handsel::RegraspStep out;
  out.kind = kind_of(step.kind);
  const auto name_of = [&](int arm) { return arm < 0 ? std::string() : arms[static_cast<std::size_t>(arm)].arm.name; };
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

}  // namespace

RegraspAnswer answer_regrasp(const RegraspRequest& request, const RobotModel& robot, const std::vector<ArmBook>& arms,
                             const ObjectModel& model, const ObjectLibrary& library, const Scene& scene, const RegraspSettings& settings,
                             const std::function<bool()>& cancelled) {
  RegraspAnswer answer;
  answer.reply.id = request.id;
  const auto object =
      std::find_if(scene.objects.begin(), scene.objects.end(), [&](const SceneObject& o) { return o.id == request.object; });
  if (object == scene.objects.end()) {
    answer.reply.reason = "object " + request.object + " is not in the scene";
    return answer;
  }
  std::vector<std::shared_ptr<const GraspPage>> pages;
  std::vector<GraspList> whole(arms.size());
  for (std::size_t a = 0; a < arms.size(); ++a) {
    pages.push_back(arms[a].book->page(model, cancelled));
    if (!pages.back()) {
      answer.reply.reason = "cancelled";
      return answer;
    }
    whole[a].grasps = pages.back()->list.grasps;
    if (request.both)
      for (ListedGrasp& g : whole[a].grasps) share_load(*arms[a].kit, model, settings.grip, g.grasp);
    answer.listed += whole[a].grasps.size();
  }
  RegraspTask task;
  task.start.T_world_object = object->T_world_object;
  task.goal.T_world_object = request.T_world_goal;
  for (const double least : kLeastMargins) {
    std::vector<GraspList> firm(arms.size());
    std::vector<RegraspArm> sides;
    for (std::size_t a = 0; a < arms.size(); ++a) {
      std::copy_if(whole[a].grasps.begin(), whole[a].grasps.end(), std::back_inserter(firm[a].grasps),
                   [least](const ListedGrasp& g) { return g.grasp.margin >= least; });
      sides.push_back({arms[a].arm, arms[a].kit.get(), &firm[a]});
    }
    const bool any = std::all_of(firm.begin(), firm.end(), [](const GraspList& list) { return !list.grasps.empty(); });
    if (!any && least != kLeastMargins.back()) continue;
    RegraspPlanner planner(robot, sides, *pages.front()->object, library, scene, request.object, settings);
    const RegraspPlan plan = request.both ? planner.plan_together(task.start.T_world_object, task.goal.T_world_object, cancelled)
                                          : planner.plan(task, cancelled);
    answer.judged += plan.judged;
    // A firm grip is not worth handing the object to and fro.
    if (!plan.solved ? !answer.reply.solved : !answer.reply.solved || plan.steps.size() < answer.reply.steps.size()) {
      answer.reply.solved = plan.solved;
      answer.reply.reason = plan.reason;
      answer.reply.rejected = plan.rejected;
      answer.reply.steps.clear();
      for (const RegraspStep& step : plan.steps) answer.reply.steps.push_back(told(step, sides));
    }
    const bool better_by_weaker = least >= 0 && answer.reply.steps.size() > kFewest;
    if ((answer.reply.solved && !better_by_weaker) || (cancelled && cancelled())) break;
  }
  return answer;
}

}  // namespace handsel::grasp_planner
