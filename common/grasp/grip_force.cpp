// SPDX-License-Identifier: Apache-2.0
#include "common/grasp/grip_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Dense>

namespace handsel {

// Simplex method from the slack basis; each free variable is split into two non-negative ones.
Eigen::VectorXd maximise(const Eigen::VectorXd& c, const Eigen::MatrixXd& A,
                         const Eigen::VectorXd& b) {
  const Eigen::Index rows = A.rows(), n = A.cols(), columns = 2 * n + rows;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> t(rows + 1, columns + 1);
  t.setZero();
  t.topLeftCorner(rows, n) = A;
  t.block(0, n, rows, n) = -A;
  t.block(0, 2 * n, rows, rows).setIdentity();
  t.col(columns).head(rows) = b;
  t.row(rows).head(n) = c.transpose();
  t.row(rows).segment(n, n) = -c.transpose();
  std::vector<Eigen::Index> basis(static_cast<std::size_t>(rows));
  for (Eigen::Index i = 0; i < rows; ++i) basis[static_cast<std::size_t>(i)] = 2 * n + i;
  const auto variable = [&](Eigen::Index row) { return basis[static_cast<std::size_t>(row)]; };
  const int bland_after = static_cast<int>(5 * columns);
  for (int iteration = 0; iteration < 20 * bland_after; ++iteration) {
    Eigen::Index enter = -1, leave = -1;
    double best = 1e-10, ratio = 0;
    for (Eigen::Index j = 0; j < columns; ++j) {
      if (t(rows, j) <= best) continue;
      enter = j;
      if (iteration >= bland_after) break;
      best = t(rows, j);
    }
    if (enter < 0) break;
    for (Eigen::Index i = 0; i < rows; ++i) {
      if (t(i, enter) <= 1e-10) continue;
      const double r = t(i, columns) / t(i, enter);
      if (leave < 0 || r < ratio || (r == ratio && variable(i) < variable(leave)))
        leave = i, ratio = r;
    }
    if (leave < 0) break;
    basis[static_cast<std::size_t>(leave)] = enter;
    t.row(leave) /= t(leave, enter);
    for (Eigen::Index i = 0; i <= rows; ++i) {
      if (i != leave && t(i, enter) != 0.0) t.row(i) -= t(i, enter) * t.row(leave);
    }
  }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (variable(i) < 2 * n) x[variable(i) % n] += variable(i) < n ? t(i, columns) : -t(i, columns);
  }
  return x;
}

namespace {

// Returns 6 x 3m: force and torque about `centre`, torque divided by `size`, of unit contact
// forces.
Eigen::MatrixXd wrenches(const std::vector<PointContact>& contacts, const Vector3& centre,
                         double size) {
  const auto m = static_cast<Eigen::Index>(contacts.size());
  Eigen::MatrixXd G(6, 3 * m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Vector3 r = (contacts[static_cast<std::size_t>(i)].position - centre) / size;
    G.block<3, 3>(0, 3 * i).setIdentity();
    G.block<3, 3>(3, 3 * i) << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  }
  return G;
}

double size_of(const std::vector<PointContact>& contacts, const Vector3& centre) {
  double size = 0;
  for (const PointContact& c : contacts) size = std::max(size, (c.position - centre).norm());
  return size;
}

bool has_full_rank(const Eigen::JacobiSVD<Eigen::MatrixXd>& svd) {
  return svd.singularValues()[5] > 1e-6 * svd.singularValues()[0];
}

constexpr double kUnbounded = 1e6;  // upper bound of all margins [N]

// Computes the grip forces of one hand. `free`: 3m x n, internal forces that cancel out; `bear`: 3m
// x 3, contact forces that balance a force at the object's centre.
GripForces grip(const std::vector<PointContact>& contacts, const Eigen::MatrixXd& free,
                const Eigen::MatrixXd& bear, const GripLoad& load,
                const GripForceSettings& settings) {
  const auto m = static_cast<Eigen::Index>(contacts.size());
  GripForces out;
  const Eigen::Index n = free.cols() + 1, per = settings.edges + 1;
  const Eigen::Index cones = m * per;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(cones + 1, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(cones + 1), c = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < m; ++i) {
    const PointContact& contact = contacts[static_cast<std::size_t>(i)];
    const Vector3& normal = contact.inward_normal;
    const Vector3 t1 =
        normal.cross(std::abs(normal.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY()).normalized();
    const Vector3 t2 = normal.cross(t1);
    for (int k = 0; k < settings.edges; ++k) {
      const double angle = 2 * std::numbers::pi * k / settings.edges;
      const Vector3 inside = settings.friction_fraction * contact.friction * normal -
                             std::cos(angle) * t1 - std::sin(angle) * t2;
      const Eigen::RowVector3d of_load = inside.transpose() * bear.middleRows(3 * i, 3);
      A.row(i * per + k).head(n - 1) = -inside.transpose() * free.middleRows(3 * i, 3);
      A(i * per + k, n - 1) = 1;
      b[i * per + k] = of_load.dot(load.weight) - load.shake * of_load.norm();
    }
    A.row(i * per + settings.edges).head(n - 1) = normal.transpose() * free.middleRows(3 * i, 3);
    b[i * per + settings.edges] = settings.max_normal;
    c.head(n - 1) -=
        1e-3 * free.middleRows(3 * i, 3).transpose() * normal;  // gentlest of equal margins
  }
  c[n - 1] = 1;
  double min_margin = std::numeric_limits<double>::infinity();  // without internal forces [N]
  for (Eigen::Index i = 0; i < cones; ++i)
    if (i % per != settings.edges) min_margin = std::min(min_margin, b[i]);
  for (Eigen::Index i = 0; i < cones; ++i)
    if (i % per != settings.edges) b[i] -= min_margin;
  A(cones, n - 1) = 1;
  b[cones] = std::clamp(settings.enough - min_margin, 0.0, kUnbounded);
  const Eigen::VectorXd x = maximise(c, A, b);
  const Eigen::VectorXd f = free * x.head(n - 1);
  for (Eigen::Index i = 0; i < m; ++i) out.forces.push_back(f.segment<3>(3 * i));
  out.margin = x[n - 1] + min_margin;
  return out;
}

}  // namespace

GripForces grip_forces(const std::vector<PointContact>& contacts, const Vector3& com, double mass,
                       const GripForceSettings& settings) {
  const auto m = static_cast<Eigen::Index>(contacts.size());
  if (m < 3) return {};
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(wrenches(contacts, com, size_of(contacts, com)),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!has_full_rank(svd)) return {};
  const Eigen::MatrixXd bear = -svd.solve(Eigen::MatrixXd::Identity(6, 3));
  return grip(contacts, svd.matrixV().rightCols(3 * m - 6), bear,
              {Vector3::Zero(), mass * settings.acceleration}, settings);
}

std::vector<GripForces> shared_grip_forces(const std::vector<std::vector<PointContact>>& hands,
                                           const Vector3& com, const GripLoad& load,
                                           const GripForceSettings& settings) {
  std::vector<GripForces> out(hands.size());
  std::vector<PointContact> all;
  for (const auto& contacts : hands) all.insert(all.end(), contacts.begin(), contacts.end());
  if (all.size() < 3) return out;
  const Eigen::JacobiSVD<Eigen::MatrixXd> together(wrenches(all, com, size_of(all, com)),
                                                   Eigen::ComputeThinU | Eigen::ComputeThinV);
  if (!has_full_rank(together)) return out;
  const Eigen::MatrixXd bear = -together.solve(Eigen::MatrixXd::Identity(6, 3));
  Eigen::Index row = 0;
  for (std::size_t h = 0; h < hands.size(); ++h) {
    const auto m = static_cast<Eigen::Index>(hands[h].size());
    Vector3 middle = Vector3::Zero();
    for (const PointContact& c : hands[h]) middle += c.position / static_cast<double>(m);
    if (m >= 3) {
      const Eigen::JacobiSVD<Eigen::MatrixXd> own(
          wrenches(hands[h], middle, size_of(hands[h], middle)),
          Eigen::ComputeThinU | Eigen::ComputeFullV);
      if (has_full_rank(own))
        out[h] = grip(hands[h], own.matrixV().rightCols(3 * m - 6), bear.middleRows(row, 3 * m),
                      load, settings);
    }
    row += 3 * m;
  }
  return out;
}

}  // namespace handsel
