// The space of the active variables of one arm: tool pose, elbow angle and further axes, and the
// local paths in it.
#pragma once

#include <optional>
#include <vector>

#include "common/model/srs_arm.hpp"
#include "components/path_planner/cartesian.hpp"
#include "components/path_planner/search/budget.hpp"

namespace handsel::path_planner {

/// Returns an angle in [-pi, pi] [rad].
double wrapped(double angle);

/// Kinematics of the arm alone: poses of the tool, elbow angles and branches.
class ArmKinematics {
 public:
  /// All arguments must outlive this.
  ArmKinematics(const Group& group, const ik::Chain& chain, const ik::SrsArm& arm)
      : group_(group), chain_(chain), arm_(arm) {}

  /// Returns the group of the arm's axes.
  const Group& group() const { return group_; }
  /// Returns the active variables that belong to a configuration of all axes.
  CartesianNode node_of(const Vector& q) const;
  /// Returns how many of shoulder, elbow and wrist are bent the other way: no path in active
  /// variables leads from one branch to another.
  int bends(const Vector& a, const Vector& b) const;
  /// Returns whether no joint is bent the other way.
  bool same_branch(const Vector& a, const Vector& b) const { return bends(a, b) == 0; }
  /// Returns the configurations at a pose with this elbow angle [rad], inside the limits; the other
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
  /// Returns nothing for a turn by nearly pi, where the axis is not defined. The nodes must outlive
  /// the path.
  static std::optional<LocalPath> between(const CartesianNode& a, const CartesianNode& b);

  /// Returns the node where the path begins.
  const CartesianNode& begin() const { return a_; }
  /// Returns the node where the path ends.
  const CartesianNode& end() const { return b_; }
  /// Returns tool and elbow at a fraction of the path; the joints are not set.
  CartesianNode at(double fraction) const;

 private:
  LocalPath(const CartesianNode& a, const CartesianNode& b, const Eigen::AngleAxisd& turn);

  const CartesianNode &a_, &b_;
  Vector3 move_, turn_axis_;
  double turn_, elbow_;
};

/// Which local paths are free, and how far apart nodes are.
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
  /// Follows the local path from a to b up to the fraction `far`, and returns how far it came; `at`
  /// is where. The joints continue from a's on their branch; every step is free. Adds the
  /// configurations to `samples` unless that is null.
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
