// SPDX-License-Identifier: Apache-2.0
// Closed-form inverse kinematics of seven-joint arms with a spherical shoulder, an elbow and a
// spherical wrist (KUKA LWR and iiwa). Own method: searches the whole circle of elbow positions
// inside the limits.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "common/model/ik_chain.hpp"

namespace handsel::ik {

class SrsArm {
 public:
  /// The arm, if the chain is one: axes 1 to 3 meet in the shoulder, 5 to 7 in the wrist,
  /// neighbours are perpendicular and the elbow is on axes 3 and 5, which are parallel when all
  /// joints are 0.
  static std::optional<SrsArm> recognise(const Chain& chain);
  /// Returns why the axes of a group are no such arm: how many there are, and what is needed.
  static std::string why_none(const Group& group);

  /// A solution of solve().
  struct Solution {
    Axes q;          ///< within the limits [rad]
    double outside;  ///< max violation of a limit before it was put on it [rad]
  };
  /// Returns the solution inside the limits nearest `seed`, found over the whole circle of elbow
  /// positions; a little weight goes to the rest configuration and to the distance from the limits.
  /// When there is none: the one with min violation, put on the limits, with `outside` > 0; nullopt
  /// when the wrist is out of reach.
  std::optional<Solution> solve(const Pose& T_root_tip, const Axes& seed) const;

  /// Returns every solution for the pose with the elbow at this angle on its circle about the line
  /// from shoulder to wrist; 0 is its max position along axis 1 from the shoulder. Elbow bent
  /// to either side, times two of the shoulder, times two of the wrist; limits are not checked,
  /// angles are in (-2 pi, 2 pi]. Empty when the wrist is out of reach. Where three axes of
  /// shoulder or wrist are in line their two solutions are one, given twice.
  std::vector<Axes> branches(const Pose& T_root_tip, double elbow_angle) const;
  /// Of those inside the limits the one nearest `near` by the max joint difference; nullopt when
  /// there is none.
  std::optional<Axes> nearest(const Pose& T_root_tip, double elbow_angle, const Axes& near) const;
  /// Joints moved by whole turns next to `near` and inside the limits [rad]; nullopt when they
  /// cannot be.
  std::optional<Axes> turned_inside(const Axes& q, const Axes& near) const;
  /// Where the elbow is on its circle [rad], in (-pi, pi]; 0 for a straight arm.
  double elbow_angle(const Axes& q) const;

 private:
  struct Candidate {
    double cost;
    Axes q;
  };
  struct Problem;
  using Solutions = std::array<std::array<double, 3>, 2>;

  explicit SrsArm(const Chain& chain) : chain_(&chain) {}
  template <class Take>
  void each_branch(const Pose& T_root_tip, double elbow_angle, const Take& take) const;
  double axis_cost(const Problem& problem, int axis, double& angle) const;
  std::optional<double> set_target(const Pose& T_root_tip, Problem& problem) const;
  void bend(Problem& problem) const;
  Solutions solutions(const Eigen::Matrix3d& R, int first, double first_when_in_line) const;
  double angle_of(const Vector3& to_elbow, const Vector3& to_wrist) const;
  Axes polished(const Pose& T_root_tip, const Axes& q) const;
  void choose(const Problem& problem, const Eigen::Matrix3d& R, int first,
              Candidate& candidate) const;
  Candidate at(const Problem& problem, double circle) const;
  Candidate refine(const Problem& problem, double centre) const;
  double outside(const Axes& q) const;

  const Chain* chain_;
  std::array<Vector3, 7> axis_;  // at zero, root frame
  Vector3 shoulder_, to_elbow_, to_wrist_, p_tip_wrist_;
  Eigen::Matrix3d R_zero_;  // of the tip
  // Of shoulder and wrist: columns axis2 x axis1, axis2, axis1.
  std::array<Eigen::Matrix3d, 2> basis_;
  std::array<double, 2> last_sign_;  // third axis of each along (+1) or against (-1) its first
};

}  // namespace handsel::ik
