// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/driving/handover_place.hpp"

#include "common/model/platform.hpp"

namespace handsel::manipulation_planner {

bool can_hand_over_from(const Vector3& place, const HandoverNeeds& needs, const RobotModel& robot,
                        const Group& arm, const Scene& scene,
                        const settings::ManipulationPlannerSettings& settings) {
  const Vector there = with_platform_at(robot, needs.q, place);
  const Pose T_world_object =
      scene.T_world_base * robot.link_pose(there, needs.palm) * needs.T_palm_object;
  const Vector3 p_robot = T_world_platform(robot, there, scene.T_world_base).translation();
  const ReceiverHands hands = hands_of(needs.receiver, scene, p_robot, settings);
  const OtpQuery query{
      scene,        needs.receiver, needs.layers, T_world_object, needs.T_palm_object,
      needs.barred, needs.partners, hands,        needs.back,     p_robot};
  return !find_otp(robot, arm, query, there, settings).poses.empty();
}

}  // namespace handsel::manipulation_planner
