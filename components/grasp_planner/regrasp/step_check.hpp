// SPDX-License-Identifier: Apache-2.0
// Checks one step of a regrasp in detail: configurations of the whole robot that make it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "components/grasp_planner/regrasp/regrasp.hpp"

namespace handsel::grasp_planner {

/// A step that was checked.
struct CheckedStep {
  std::optional<RegraspStep> step;  ///< nullopt: the step cannot be made
  std::string reason;               ///< why not, a phrase
};

/// Inverse kinematics and collisions of the arms with the object in the scene. For one thread.
class StepCheck {
 public:
  /// See RegraspPlanner. ConfigError unless there are one or two arms.
  StepCheck(const RobotModel& robot, std::vector<RegraspArm> arms, const Graspable& object,
            ObjectLibrary library, const Scene& scene, const std::string& object_id);

  /// Replaces the settings.
  void set_settings(const RegraspSettings& settings) { settings_ = settings; }
  /// Settings in force.
  const RegraspSettings& settings() const { return settings_; }
  /// Model of the robot.
  const RobotModel& robot() const { return robot_; }
  /// The arms, one or two.
  const std::vector<RegraspArm>& arms() const { return arms_; }
  /// The object.
  const Graspable& object() const { return object_; }
  /// Pose of the world in the frame of the robot's root.
  const Pose& T_root_world() const { return T_root_world_; }
  /// Returns a grasp of the list of an arm.
  const Grasp& grasp(int arm, std::size_t i) const;

  /// Returns `q` with the axes of an arm and its hand replaced.
  Vector with(const Vector& q, int arm, const Vector& arm_q, const Vector& hand_q) const;
  /// Returns whether the robot collides with nothing but, perhaps, the object.
  bool is_free(const Vector& q) { return world_.is_free(q); }
  /// Returns whether the robot, the named hands excluded, is clear of the object. `holding`,
  /// `other`: indices of arms; -1: none.
  bool clear_of_object(const Vector& q, const Pose& T_world_object, int holding, int other = -1);
  /// Returns the configuration with the opened hand at its stand-off, before an approach or after a
  /// retreat; the other axes as in `q`. nullopt: no straight path is free.
  std::optional<Vector> stand_off(int arm, std::size_t i, const Pose& T_world_object,
                                  const Vector& q, const Vector& arm_q);

  /// Returns a cost, [0, 1], that estimates how unlikely the arm reaches a grasp of the object at
  /// this pose: it grows as the hand points back to the shoulder and as the arm stretches. nullopt:
  /// out of reach. Takes 1 us; an inverse solution takes milliseconds. Own method.
  std::optional<double> strain(int arm, std::size_t i, const Pose& T_world_object) const;
  /// Checks a pick of the object from its support, or, in reverse, a place there.
  CheckedStep check_pick(int arm, std::size_t i, const Pose& T_world_object);
  /// A pass from one hand to the other.
  struct Pass {
    int from{}, to{};                        ///< indices of the arms
    std::size_t grasp_from{}, grasp_to{};    ///< indices into their lists
    Vector3 retreat_from{Vector3::UnitZ()};  ///< of the hand that leaves, its frame, unit
    Vector3 approach_to{Vector3::UnitZ()};   ///< of the other hand, outward, its frame, unit
  };
  /// Checks a pass at places between the arms.
  CheckedStep check_pass(const Pass& pass);

 private:
  /// A place between the arms at which the object may be passed.
  struct PassPlace {
    Pose T_world_object;
    double score;
  };
  struct LinkShape {
    int link;
    CollisionShapePtr shape;
    Pose T_link_shape;
  };

  std::optional<Vector> reach(int arm, const Pose& T_world_hand, const Vector& seed,
                              int restarts) const;
  bool object_in_furniture(const Pose& T_world_object) const;
  std::optional<Vector> straight(int arm, std::size_t i, const Pose& T_world_object,
                                 const Vector& q, const Vector& arm_q, const Vector3& direction);
  Vector3 shoulder(int arm) const;
  std::vector<PassPlace> pass_places(const Pass& pass) const;
  bool tolerates_slack(int from, int to, const RegraspStep& step);

  const RobotModel& robot_;
  std::vector<RegraspArm> arms_;
  const Graspable& object_;
  RegraspSettings settings_;
  Pose T_root_world_, T_world_base_;
  CollisionWorld world_;
  std::vector<SceneBox> boxes_;
  std::vector<LinkShape> shapes_;
  std::vector<int> hand_of_;                    // per link: the arm whose hand it belongs to
  std::vector<std::vector<Vector3>> retreats_;  // per arm: directions in the frame of its hand
  std::vector<Vector3> p_shoulders_;            // per arm, world [m]
  std::vector<double> lengths_;                 // per arm, shoulder to palm [m]
  std::vector<Pose> T_root_link_;
};

}  // namespace handsel::grasp_planner
