// SPDX-License-Identifier: Apache-2.0
#include "common/grasp/force_closure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handsel {

WrenchMatrix contact_wrenches(const std::vector<PointContact>& contacts, int edges,
                              const Vector3& centre, double torque_scale) {
  const auto patches = std::count_if(contacts.begin(), contacts.end(),
                                     [](const PointContact& c) { return c.torsion > 0; });
  WrenchMatrix out(6, static_cast<Eigen::Index>(contacts.size()) * edges + 2 * patches);
  Eigen::Index column = 0;
  for (const PointContact& c : contacts) {
    const Vector3& n = c.inward_normal;
    const Vector3 t1 =
        n.cross(std::abs(n.x()) < 0.9 ? Vector3::UnitX().eval() : Vector3::UnitY().eval())
            .normalized();
    const Vector3 t2 = n.cross(t1);
    const Vector3 arm = torque_scale * (c.position - centre);
    for (int k = 0; k < edges; ++k) {
      const double angle = 2 * std::numbers::pi * k / edges;
      const Vector3 f = n + c.friction * (std::cos(angle) * t1 + std::sin(angle) * t2);
      out.col(column).head<3>() = f;
      out.col(column).tail<3>() = arm.cross(f);
      ++column;
    }
    if (!(c.torsion > 0)) continue;
    for (const double sign : {1.0, -1.0}) {
      out.col(column).head<3>() = n;
      out.col(column).tail<3>() = arm.cross(n) + sign * torque_scale * c.torsion * n;
      ++column;
    }
  }
  return out;
}

int wrench_rank(const WrenchMatrix& wrenches) {
  // Elimination along the few rows, each pivoted on its largest entry; a row of zeros adds no rank.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> a = wrenches;
  const double min_pivot = 1e-10 * (a.size() == 0 ? 0.0 : a.cwiseAbs().maxCoeff());
  int rank = 0;
  for (Eigen::Index k = 0; k < a.rows(); ++k) {
    Eigen::Index pivot = 0;
    if (a.cols() == 0 || !(a.row(k).cwiseAbs().maxCoeff(&pivot) > min_pivot)) continue;
    ++rank;
    for (Eigen::Index i = k + 1; i < a.rows(); ++i)
      a.row(i) -= (a(i, pivot) / a(k, pivot)) * a.row(k);
  }
  return rank;
}

// With w the sum of all wrenches, weights mu >= 0 with W mu = -w give lambda = mu + 1 > 0, and
// back: one feasibility problem, phase one of the simplex method on a tableau of dimension + 1
// rows. Its right-hand side is not degenerate, unlike that of the form with t.
bool force_closure(const WrenchMatrix& wrenches) {
  const Eigen::Index d = wrenches.rows(), n = wrenches.cols();
  if (d == 0 || n <= d || wrench_rank(wrenches) < d) return false;
  const double scale = wrenches.cwiseAbs().maxCoeff();
  // Row-major so that a pivot streams along rows; last column right-hand side, last row reduced
  // costs of the sum of artificials.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> t(d + 1, n + 1);
  t.topLeftCorner(d, n) = wrenches / scale;
  t.col(n).head(d) = -t.topLeftCorner(d, n).rowwise().sum();
  for (Eigen::Index i = 0; i < d; ++i) {
    if (t(i, n) < 0) t.row(i) *= -1;
  }
  t.row(d) = t.topRows(d).colwise().sum();
  const double feasible = 1e-11 * static_cast<double>(n);
  const int bland_after = static_cast<int>(10 * (n + d)), limit = 100 * bland_after;
  std::vector<Eigen::Index> basis(static_cast<std::size_t>(d), -1);
  for (int iteration = 0; iteration < limit; ++iteration) {
    if (t(d, n) <= feasible) return true;
    Eigen::Index enter = -1;
    double best = 1e-12;
    for (Eigen::Index j = 0; j < n; ++j) {
      if (t(d, j) > best) {
        enter = j;
        if (iteration >= bland_after) break;
        best = t(d, j);
      }
    }
    if (enter < 0) return false;
    Eigen::Index leave = -1;
    double ratio = 0;
    for (Eigen::Index i = 0; i < d; ++i) {
      if (t(i, enter) <= 1e-12) continue;
      const double r = t(i, n) / t(i, enter);
      const auto var = [&](Eigen::Index row) { return basis[static_cast<std::size_t>(row)]; };
      if (leave < 0 || r < ratio || (r == ratio && var(i) < var(leave))) {
        leave = i;
        ratio = r;
      }
    }
    if (leave < 0) return false;
    basis[static_cast<std::size_t>(leave)] = enter;
    t.row(leave) /= t(leave, enter);
    for (Eigen::Index i = 0; i <= d; ++i) {
      if (i != leave && t(i, enter) != 0.0) t.row(i) -= t(i, enter) * t.row(leave);
    }
  }
  return false;
}

}  // namespace handsel
