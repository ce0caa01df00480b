// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/choice/grasp_answer.hpp"

#include <algorithm>

namespace handsel::grasp_planner {
namespace {

constexpr std::size_t kMaxPartners = 4;  // of a grasp and a hand of the person on the wire

}  // namespace

const SceneObject* object_in(const Scene& scene, const std::string& id) {
  const auto object = std::find_if(scene.objects.begin(), scene.objects.end(),
                                   [&](const SceneObject& o) { return o.id == id; });
  return object != scene.objects.end() ? &*object : nullptr;
}

std::size_t arm_of(const GraspRequest& request, const std::vector<ArmGrasps>& arms) {
  if (request.group.empty()) return 0;
  const auto found = std::find_if(arms.begin(), arms.end(), [&](const ArmGrasps& one) {
    return one.arm.name == request.group;
  });
  return static_cast<std::size_t>(found - arms.begin());
}

std::string objection(const GraspRequest& request, const Scene& scene, const RobotModel& robot,
                      const std::vector<ArmGrasps>& arms, const ObjectModel* model) {
  const SceneObject* object = object_in(scene, request.object);
  if (object == nullptr) return "object " + request.object + " is not in the scene";
  if (!scene.robot_known) return "the place of the robot is not known yet";
  if (model == nullptr)
    return object->model.empty()
               ? "object " + request.object +
                     " is known by its outline only: grasps need a description of it"
               : "object " + request.object + " is of model " + object->model +
                     ", of which there is no description";
  if (request.start.size() != robot.dof())
    return "the start has " + std::to_string(request.start.size()) + " axes, the robot has " +
           std::to_string(robot.dof());
  if (arm_of(request, arms) == arms.size()) {
    std::string known;
    for (const ArmGrasps& one : arms)
      known += (known.empty() ? "\"" : ", \"") + one.arm.name + "\"";
    return "robot " + robot.name() + " has no arm \"" + request.group + "\" with a hand; it has " +
           known;
  }
  return {};
}

void write(const Choice& choice, const GraspList& list, GraspReply& reply) {
  reply.grasps = choice.grasps;
  reply.rejected = choice.refusals();
  for (Refusal& r : list.refusals()) reply.rejected.push_back(std::move(r));
  if (choice.grasps.empty()) reply.reason = choice.why_none(list);
}

void add_partners(const GraspList& list, const TransferTable& pairs, Side side, GraspReply& reply) {
  for (Grasp& grasp : reply.grasps) {
    const auto listed = std::find_if(list.grasps.begin(), list.grasps.end(),
                                     [&](const auto& one) { return one.grasp.id == grasp.id; });
    if (listed == list.grasps.end()) continue;
    const auto index = static_cast<std::size_t>(listed - list.grasps.begin());
    const std::vector<TransferPartner>& partners = pairs.partners(index);
    for (std::size_t i = 0; i < std::min(kMaxPartners, partners.size()); ++i)
      grasp.partners.push_back({partners[i].id, side, partners[i].T_object_wrist,
                                partners[i].opposition, partners[i].quality});
  }
}

Duration choice_time(const Choice& choice) {
  return from_seconds(0.002 + 4e-4 * static_cast<double>(choice.reaches) +
                      5e-5 * static_cast<double>(choice.transfer_reaches) +
                      3e-5 * static_cast<double>(choice.states) +
                      4e-5 * static_cast<double>(choice.touch_tests));
}

}  // namespace handsel::grasp_planner
