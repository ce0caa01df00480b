#include "components/grasp_planner/regrasp_desk.hpp"

#include <algorithm>
#include <iterator>

namespace handsel::grasp_planner {
namespace {

constexpr double kFirm = 1.0;          // [N] of Grasp::margin: those with less are taken only where there are not
constexpr double kLeastEffort = 0.05;  // [Nm]
constexpr std::size_t kEnough = 30;    // of the others

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
  std::vector<RegraspArm> sides;
  std::vector<GraspList> whole(arms.size()), sure(arms.size());
  for (const ArmBook& arm : arms) {
    pages.push_back(arm.book->page(model, cancelled));
    if (!pages.back()) {
      answer.reply.reason = "cancelled";
      return answer;
    }
    GraspList& list = whole[sides.size()];
    list.grasps = pages.back()->list.grasps;
    if (request.both)
      for (ListedGrasp& g : list.grasps) share_load(*arm.kit, model, settings.grip, g.grasp);
    GraspList& firm = sure[sides.size()];
    std::copy_if(list.grasps.begin(), list.grasps.end(), std::back_inserter(firm.grasps),
                 [](const ListedGrasp& g) { return g.grasp.margin > kFirm; });
    sides.push_back({arm.arm, arm.kit.get(), firm.grasps.size() >= kEnough ? &firm : &list});
    answer.listed += list.grasps.size();
  }
  RegraspPlanner planner(robot, sides, *pages.front()->object, library, scene, request.object, settings);
  RegraspTask task;
  task.start.T_world_object = object->T_world_object;
  task.goal.T_world_object = request.T_world_goal;
  const RegraspPlan plan =
      request.both ? planner.plan_together(task.start.T_world_object, task.goal.T_world_object, cancelled) : planner.plan(task, cancelled);
  answer.judged = plan.judged;
  answer.reply.solved = plan.solved;
  answer.reply.reason = plan.reason;
  answer.reply.rejected = plan.rejected;
  if (plan.solved)
    for (const RegraspStep& step : plan.steps) answer.reply.steps.push_back(told(step, sides));
  return answer;
}

}  // namespace handsel::grasp_planner
