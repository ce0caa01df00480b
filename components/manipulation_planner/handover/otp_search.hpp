// SPDX-License-Identifier: Apache-2.0
// Where and how to offer an object: object transfer points ranked by comfort, safety, visibility,
// legibility and the robot's effort (chapter sections 3.2.9 and 4.1.2). Own method: the sum. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/config/settings/manipulation_planner.hpp"
#include "common/cost/human_cost.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_wrist.hpp"
#include "common/model/robot_model.hpp"
#include "components/manipulation_planner/handover/receiver_hands.hpp"

namespace handsel::manipulation_planner {

/// A grasp of the person, where the object is offered.
struct PartnerPose {
  std::uint64_t id{};                    ///< id of the grasp, see PartnerGrasp
  Side side{Side::right};                ///< hand of the person
  Pose T_world_wrist{Pose::Identity()};  ///< wrist of the person's hand
  double strain{};                       ///< see WristPosture
  double hand_cost{};                    ///< see TakingArm
};

/// An arm of a person that is free to take something.
struct TakingArm {
  HumanArm arm;        ///< where it starts, how long it is
  double hand_cost{};  ///< added to the strain, as hand_cost() returns it
};

/// A pose in which an object is handed over.
struct OtpPose {
  Pose T_world_object{Pose::Identity()};  ///< where and how the object is offered
  Vector arm_joints;                      ///< arm axes that put the held object there [rad]
  double cost{};                          ///< as otp_cost() counts it, the lower the better
  /// How the person can take the object there; nullopt: no grasp of theirs is known, or none fits.
  std::optional<PartnerPose> partner{};
};

/// Result of a search.
struct OtpSearch {
  std::vector<OtpPose> poses;  ///< best first, reachable by robot and person
  std::string reason;          ///< when there is none
  std::uint32_t tried{};       ///< poses that inverse kinematics was solved for
};

/// What is offered to whom; what is referred to must outlive the query.
struct OtpQuery {
  const Scene& scene;                  ///< furniture and base of the robot
  const Person& person;                ///< the receiver
  const LayersNow& layers;             ///< cost layers
  const Pose& T_world_object;          ///< where the object is now
  const Pose& T_tool_object;           ///< how the hand holds the object
  const std::vector<Vector3>& barred;  ///< as barred_directions() returns them
  /// Hands of the person that find room beside the robot's; empty: not known.
  const std::vector<PartnerGrasp>& partners;
  ReceiverHands hands{};  ///< which hands are free, and which is ready
  /// Unit vector in which the hand retreats after the release, tool frame; nullopt: not known.
  std::optional<Vector3> back{};
  /// Where the robot stands in the world; nullopt: at the root of its model [m].
  std::optional<Vector3> p_robot{};
  /// Poses of the object in which the receiver did not take it, world.
  std::vector<Pose> vain_offers{};
};

/// Returns the directions, seen from the object, in which a hand that pinches stands (outward
/// normals, object frame): the object cannot be drawn out in these directions. Empty when more than
/// two fingers hold the object: they open away from it.
std::vector<Vector3> barred_directions(const Grasp& grasp);

/// Returns the arms with which a person can take something; empty: their body is not known, or both
/// hands hold something.
std::vector<TakingArm> taking_arms(const Person& person, const ReceiverHands& hands,
                                   const settings::ManipulationPlannerSettings& settings);

/// Returns the grasp in which a person takes an object at `T_world_object` with the smallest sum of
/// strain of wrist and arm and cost of the hand; nullopt: in none, wrist or arm do not get there.
std::optional<PartnerPose> easiest_partner(const std::vector<TakingArm>& arms,
                                           const std::vector<PartnerGrasp>& partners,
                                           const Pose& T_world_object);

/// Searches object transfer points for what `arm` holds. `q`: all axes, near which configurations
/// are searched [rad, m]. The object keeps its tilt; only its place and heading change. Places in,
/// under or behind furniture as the person sees it, and those an outside layer forbids, are left
/// out. The person must be able to draw the object toward them, and to grasp it with a wrist that
/// is comfortable: the grasp of theirs with the smallest strain counts at each pose, of the hand
/// that is ready where this is known. A hand that holds something takes nothing. Poses from which
/// the robot's hand cannot retreat by `min_retreat` are returned only where there are no others.
OtpSearch find_otp(const RobotModel& robot, const Group& arm, const OtpQuery& query,
                   const Vector& q, const settings::ManipulationPlannerSettings& settings);

/// A handover pose that is to be shifted.
struct PoseShift {
  Pose T_world_object{Pose::Identity()};  ///< where and how the object was to be offered
  Vector3 p_wanted{Vector3::Zero()};      ///< where the object is wanted, world [m]
};

/// Shifts a handover from the pose to the point wanted, with the heading of the object
/// as little changed as reach permits, by at most four of the headings that find_otp() compares.
/// Where that is no object transfer
/// point, out of reach, or fits no grasp of the person's ready hand, shifts by three quarters, the
/// half or a quarter of that. Returns at most one pose; none where the shift would fall below
/// min_shift.
OtpSearch shifted_otp(const RobotModel& robot, const Group& arm, const OtpQuery& query,
                      const PoseShift& wanted, const Vector& q,
                      const settings::ManipulationPlannerSettings& settings);

/// Returns the cost of a pose of the object as find_otp() counts it, whether the robot reaches the
/// pose or not; nullopt: it is no object transfer point.
std::optional<double> otp_cost(const OtpQuery& query, const Pose& T_world_object,
                               const settings::ManipulationPlannerSettings& settings);

}  // namespace handsel::manipulation_planner
