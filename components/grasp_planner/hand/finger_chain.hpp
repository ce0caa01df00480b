// SPDX-License-Identifier: Apache-2.0
// One finger of a hand: where its links and fingertip are, and the inverse kinematics of the
// fingertip's centre. Any tree of joints.
#pragma once

#include <vector>

#include "common/model/hand_model.hpp"

namespace handsel::grasp_planner {

class FingerChain {
 public:
  FingerChain(const HandModel& hand, int finger);

  const std::vector<int>& axes() const { return axes_; }  ///< hand axes that move the fingertip
  double tip_radius() const { return tip_radius_; }       ///< [m]
  /// Adds the efforts of the finger's axes that give `force` [N] to the object at the point
  /// `p_object` (both object frame).
  void add_effort(const std::vector<Pose>& T_hand_step, const Pose& T_hand_object,
                  const Vector3& p_object, const Vector3& force, Vector& hand_effort) const;
  /// Links this finger's joints carry, and how each follows: T_hand_link = step pose * T_step_link.
  struct Carried {
    int link{};                          ///< index of the link in the hand model
    int step{};                          ///< index of the moving joint that carries the link
    Pose T_step_link{Pose::Identity()};  ///< fixed pose of the link in the frame of that joint
  };
  /// Returns the links that the joints of this finger move.
  const std::vector<Carried>& carried() const { return carried_; }
  /// Returns the number of moving joints of the finger, those beside the path to the tip included.
  int steps() const { return static_cast<int>(steps_.size()); }

  /// Computes the poses of the moving joints' frames in the hand frame; `T` is resized to steps().
  /// `q`: all axes of the hand.
  void forward(const Vector& q, std::vector<Pose>& T) const;
  Vector3 tip(const Vector& q) const;  ///< centre of the fingertip sphere, hand frame [m]
  /// The same from the poses of forward().
  Vector3 tip(const std::vector<Pose>& T) const {
    return T[static_cast<std::size_t>(tip_step_)] * T_step_tip_.translation();
  }
  /// Returns the pose of the fingertip in the hand frame, from the poses of forward().
  Pose tip_pose(const std::vector<Pose>& T) const {
    return T[static_cast<std::size_t>(tip_step_)] * T_step_tip_;
  }
  /// Returns the Jacobian of the tip's centre, 3 x axes().size(): velocity of the tip's centre for
  /// each of the finger's axes.
  Eigen::Matrix3Xd jacobian(const std::vector<Pose>& T) const { return jacobian(T, tip(T)); }
  /// Returns the Jacobian of the point of the outermost link that is at `p_hand` now.
  Eigen::Matrix3Xd jacobian(const std::vector<Pose>& T, const Vector3& p_hand) const;
  /// Returns the direction from the last joint to the tip's centre, hand frame, unit.
  Vector3 tip_direction(const std::vector<Pose>& T) const;
  /// Returns the sign of the closing motion of the outermost axis: 1 or -1.
  double closing_sign() const { return closing_sign_; }
  /// Returns where the tip goes when the finger's outermost axis closes (moves from its rest
  /// position into its range), hand frame, unit: the direction its pad faces.
  Vector3 closing_direction(const std::vector<Pose>& T) const;

  /// Moves this finger's axes of `q` (its other axes stay) until the tip is within `tolerance` of
  /// `p_hand_tip`, inside [lower, upper] (all hand axes), starting from q. Damped least squares.
  /// False when it does not get there; q is then the nearest found.
  bool inverse(const Vector3& p_hand_tip, const Vector& lower, const Vector& upper, Vector& q,
               double tolerance = 1e-4, int iterations = 30) const;

 private:
  void turn_to_z();

  struct Step {
    int parent{-1};  // step, -1: the hand itself
    Pose T_parent_joint{Pose::Identity()};
    Vector3 axis{Vector3::UnitZ()};
    bool prismatic{};
    int dof{};  // hand axis
    double factor{1.0}, offset{};
  };
  std::vector<int> axes_;
  std::vector<Step> steps_;
  std::vector<Carried> carried_;
  std::vector<int> tip_path_;  // steps from the hand to the tip
  int tip_step_{};
  Pose T_step_tip_{Pose::Identity()};
  double tip_radius_{};
  double closing_sign_{1};  // of the outermost axis
};

}  // namespace handsel::grasp_planner
