// SPDX-License-Identifier: Apache-2.0
// Grasps that leave a person a good one (chapter section 3.2.9): which grasps of the person's hand
// go with each of the robot's, and where and how the object is best offered to them.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "common/model/human/human_wrist.hpp"
#include "components/grasp_planner/pair/double_grasp.hpp"

namespace handsel::grasp_planner {

struct TransferSettings {
  double clearance{0.004};       ///< between the two hands [m]
  double palm_clearance{0.01};   ///< between either palm and the other hand [m]
  double min_opposition{2.1};    ///< angle of the wrists, more than 120 degrees [rad]
  std::size_t max_of_each{400};  ///< best grasps taken from each list
  /// Max distinct grasps of the person per grasp of the robot.
  std::size_t partners{10};
  std::size_t pool{120};  ///< best double grasps of one grasp of the robot that these are from
  double min_turn{0.5};   ///< min rotation between the hands of two partners [rad]
  /// Strain of wrist and arm of the person; beyond it a pose is left out.
  double max_strain{kComfortableStrain};
  /// Angle between the person's hand and the level direction from their body to the object [rad].
  double max_aim{1.05};
  int headings{24};    ///< of the object
  double max_tilt{0};  ///< max tilt of the object [rad]; upright is preferred
};

/// A grasp of the person that is compatible with one grasp of the robot.
struct TransferPartner {
  std::size_t human{};                    ///< index into the person's list
  std::uint64_t id{};                     ///< of the person's grasp
  Pose T_object_wrist{Pose::Identity()};  ///< of the person's hand
  double opposition{};                    ///< [rad]
  double quality{};                       ///< the smaller of the two
};

/// All double grasps of robot and person on one object; made once for an object and kept.
class TransferTable {
 public:
  /// `cancelled`: as of list_double_grasps().
  TransferTable(const HandSide& robot, const HandSide& human, const Graspable& object,
                const TransferSettings& settings = {}, const std::function<bool()>& cancelled = {});

  /// Returns the person's grasps for grasp `robot_grasp` of the robot's list, best first; empty:
  /// nothing is left for the person.
  const std::vector<TransferPartner>& partners(std::size_t robot_grasp) const;
  /// Returns how good the best partner is, [0, 1]: opposition and quality; 0 when there is none.
  /// Independent of where the person is.
  double promise(std::size_t robot_grasp) const;
  /// Returns the counts of the double grasps behind the table; its own grasps are empty.
  const DoubleList& doubles() const { return doubles_; }
  /// Returns the settings the table was made with.
  const TransferSettings& settings() const { return settings_; }

 private:
  TransferSettings settings_;
  DoubleList doubles_;  // without their grasps: those are in partners_
  std::vector<std::vector<TransferPartner>> partners_;
};

/// A place to offer the object.
struct TransferPose {
  Pose T_world_object{Pose::Identity()};  ///< where and how the object is offered
  Vector arm_joints;                      ///< of the robot
  TransferPartner partner;                ///< grasp of the person that the pose is for
  WristPosture wrist;                     ///< of the person
  /// Angle between the person's hand and the direction from their body to the object [rad].
  double aim{};
  double tilt{};   ///< of the object, against how it is held now [rad]
  double score{};  ///< at most 1: legibility (opposition), comfort (strain), aim, little tilt
};

/// Returns how far the object may be tilted, in steps, upright first [rad].
std::vector<double> tilt_levels(const TransferSettings& settings);

/// Exchange poses for one person: places before their chest and headings of the object.
class TransferPlaces {
 public:
  /// `p_object_middle`: of the object's box, object frame. `R_world_object`: how it is held now.
  TransferPlaces(const Person& person, const HumanArm& arm, const Vector3& p_world_robot,
                 const Eigen::Matrix3d& R_world_object, const Vector3& p_object_middle);

  /// Returns the best place for a grasp of the robot, the object tilted by `tilt` [rad] in some
  /// direction, at which `reach` finds an arm configuration for the robot's hand. `reach` is asked
  /// `max_reaches` times at most, best score first.
  std::optional<TransferPose> best(
      const TransferTable& table, std::size_t robot_grasp, const Pose& T_object_hand, double tilt,
      const std::function<std::optional<Vector>(const Pose& T_world_object,
                                                const Pose& T_world_hand)>& reach,
      int max_reaches) const;

 private:
  HumanArm arm_;
  Eigen::Matrix3d R_world_object_;
  Vector3 p_object_middle_;
  Vector3 chest_, to_robot_;
  std::vector<Vector3> places_;  // of the object's middle, world
};

}  // namespace handsel::grasp_planner
