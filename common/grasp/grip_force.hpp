// SPDX-License-Identifier: Apache-2.0
// The internal grip forces of a grasp: forces of the fingers that cancel out and leave the largest
// margin inside the friction cones for the object's load. Own method: a linear program, because the
// load may pull in any direction.
#pragma once

#include <limits>
#include <vector>

#include "common/grasp/force_closure.hpp"

namespace handsel {

struct GripForceSettings {
  double max_normal{15.0};  ///< a finger presses with no more than this [N]
  /// Fraction of the friction coefficient that is used; the rest is for normals that are not where
  /// they were planned.
  double friction_fraction{0.8};
  double acceleration{13.0};  ///< of the load, gravity included, in the worst direction [m/s^2]
  /// Margin from which on the fingers press no harder than needed [N].
  double enough{std::numeric_limits<double>::infinity()};
  int edges{12};  ///< of a cone, linearised from outside
};

/// What the fingers do at their contacts, frame of the contacts.
struct GripForces {
  /// On the object, one a contact; they sum to no force and no torque [N].
  std::vector<Vector3> forces;
  /// Smallest over the contacts of friction_fraction * friction * normal force - tangential force,
  /// when the load pulls in its worst direction [N]. Not positive: the load is not resisted with
  /// that reserve of friction.
  double margin{};
};

/// What is to be borne, frame of the contacts.
struct GripLoad {
  Vector3 weight{Vector3::Zero()};  ///< always there, at the load's centre [N]
  double shake{};                   ///< besides, in the worst direction [N]
};

/// Maximises the margin, up to `enough`, by linear programming; of equal margins the gentlest. The
/// load of `mass` [kg] acts at `com` and is borne by all contacts as equal springs. Without three
/// contacts, or with all on one line, nothing can be borne: no forces, margin 0.
GripForces grip_forces(const std::vector<PointContact>& contacts, const Vector3& com, double mass,
                       const GripForceSettings& settings = {});

/// Several hands on one load, one entry a hand: the grip forces of each cancel out by themselves,
/// and the contacts of all together bear the load at `com` as equal springs, so that no hand must
/// keep it from turning that another keeps.
std::vector<GripForces> shared_grip_forces(const std::vector<std::vector<PointContact>>& hands,
                                           const Vector3& com, const GripLoad& load,
                                           const GripForceSettings& settings = {});

/// Maximises c.x subject to A x <= b with b >= 0, x free; x = 0 is where it starts. Unbounded
/// directions are not followed further.
Eigen::VectorXd maximise(const Eigen::VectorXd& c, const Eigen::MatrixXd& A,
                         const Eigen::VectorXd& b);

}  // namespace handsel
