// SPDX-License-Identifier: Apache-2.0
// The space of the active variables of one arm: tool pose, elbow angle and further axes; and the
// path segments in this space.
#pragma once

#include <optional>
#include <vector>

#include "common/model/srs_arm.hpp"
#include "components/path_planner/cartesian.hpp"
#include "components/path_planner/search/budget.hpp"

namespace handsel::path_planner {

/// Returns the angle wrapped to [-pi, pi] [rad].
double wrapped(double angle);

/// Kinematics of the arm: tool poses, elbow angles and branches.
class ArmKinematics {
 public:
  /// All arguments must outlive this.
  ArmKinematics(const Group& group, const ik::Chain& chain, const ik::SrsArm& arm)
      : group_(group), chain_(chain), arm_(arm) {}

  /// Returns the group of the arm's axes.
  const Group& group() const { return group_; }
  /// Returns the active variables of a configuration of all axes.
  CartesianNode node_of(const Vector& q) const;
  /// Returns the number of shoulder, elbow and wrist with opposite bend. No path in active
  /// variables connects two branches.
  int bends(const Vector& a, const Vector& b) const;
  /// Returns whether no joint has the opposite bend.
  bool same_branch(const Vector& a, const Vector& b) const { return bends(a, b) == 0; }
  /// Returns the configurations at a pose with this elbow angle [rad], within the limits; all other
  /// axes as in `all`.
  std::vector<Vector> configurations(const Pose& T, double elbow, const Vector& all) const;
  /// Returns the joints at a pose and elbow angle [rad] that are nearest to `now`, on its branch.
  std::optional<ik::Axes> nearest(const Pose& T, double elbow, const Vector& now) const {
    return arm_.nearest(T, elbow, now);
  }

 private:
  const Group& group_;
  const ik::Chain& chain_;
  const ik::SrsArm& arm_;
};

/// The displacement of the tool from one node to another, one axis and an angle, and that of the
/// elbow.
class LocalPath {
 public:
  /// Returns nullopt for a rotation by nearly pi, whose axis is undefined. The nodes must outlive
  /// the path.
  static std::optional<LocalPath> between(const CartesianNode& a, const CartesianNode& b);

  /// Returns the first node.
  const CartesianNode& begin() const { return a_; }
  /// Returns the last node.
  const CartesianNode& end() const { return b_; }
  /// Returns tool and elbow at a fraction of the path; does not set the joints.
  CartesianNode at(double fraction) const;

 private:
  LocalPath(const CartesianNode& a, const CartesianNode& b, const Eigen::AngleAxisd& turn);

  const CartesianNode &a_, &b_;
  Vector3 move_, turn_axis_;
  double turn_, elbow_;
};

/// Checks path segments and computes distances of nodes.
class CartesianSpace : public Budget {
 public:
  /// All arguments must outlive this.
  CartesianSpace(const PlanningModels& models, const CartesianProblem& problem,
                 const CartesianSettings& settings, const Hooks& hooks, const ArmKinematics& arm);

  /// Returns the settings that were given.
  const CartesianSettings& settings() const { return settings_; }
  /// Returns the kinematics that were given.
  const ArmKinematics& arm() const { return arm_; }
  /// Returns whether configurations may have a cost.
  bool concerns_people() const { return cost_.concerned(); }
  /// Returns the cost of a configuration of all axes, [0, 1].
  double cost(const Vector& q) const { return cost_.concerned() ? cost_(q) : 0.0; }
  /// Returns ArmKinematics::configurations() and counts one check.
  std::vector<Vector> configurations(const Pose& T, double elbow, const Vector& all);
  /// Returns the distance in the measure of CartesianSettings [rad].
  double distance(const CartesianNode& a, const CartesianNode& b) const;
  /// Follows the path segment from a to b up to the fraction `far` as long as every step is free.
  /// Returns the reached fraction and writes the reached node to `at`. The joints remain on the
  /// branch of a. Adds the configurations to `samples` unless null.
  double follow(const CartesianNode& a, const CartesianNode& b, double far, CartesianNode& at,
                std::vector<Vector>* samples = nullptr);

 private:
  bool advance(const LocalPath& path, double from, double to, CartesianNode& at,
               std::vector<Vector>* samples, int halved);

  CollisionWorld& world_;
  const HumanCost& cost_;
  const CartesianProblem& problem_;
  const CartesianSettings& settings_;
  const ArmKinematics& arm_;
};

}  // namespace handsel::path_planner
