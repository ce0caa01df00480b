// SPDX-License-Identifier: Apache-2.0
// Contacts to wrenches, and the strict force-closure test (formulas: section 3).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "common/geometry/pose.hpp"

namespace handsel {

/// One wrench a column (force above torque for contacts; any dimension >= 1 otherwise).
using WrenchMatrix = Eigen::MatrixXd;

/// A contact: where, and the unit normal pointing into the object. A patch also resists turning
/// about the normal.
struct PointContact {
  Vector3 position{Vector3::Zero()};        ///< [m], in a frame that all contacts share
  Vector3 inward_normal{Vector3::UnitZ()};  ///< unit vector into the object
  double friction{0.5};                     ///< Coulomb coefficient
  /// Torque about the normal per normal force [m]; 0: a point (hard finger).
  double torsion{0.0};
};

/// The edges of the linearised friction cones: n + mu (cos a t1 + sin a t2), t1 = n x ex (n x ey
/// when |n.x| >= 0.9), normalised, t2 = n x t1, a = 2 pi k / edges; the torque is about `centre`
/// [m] times `torque_scale` [1/m].
/// A patch adds two: n with the torque +-torsion n.
WrenchMatrix contact_wrenches(const std::vector<PointContact>& contacts, int edges,
                              const Vector3& centre, double torque_scale);

/// Strict: some combination of ALL wrenches with positive weights is zero, and they span the space.
/// Exactly when the largest t with sum(lambda w) = 0, sum(lambda) = 1, lambda >= t is positive.
/// Rank is tested first. Own simplex method; allocates only its tableau.
bool force_closure(const WrenchMatrix& wrenches);

/// Rank of the set at a relative tolerance of 1e-10.
int wrench_rank(const WrenchMatrix& wrenches);

}  // namespace handsel
