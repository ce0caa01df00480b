#include "common/grasp/grip_force.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Dense>

namespace handsel {

// Simplex method from the slack basis; the free variables are split into two that are not negative.
Eigen::VectorXd maximise(const Eigen::VectorXd& c, const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
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
      if (leave < 0 || r < ratio || (r == ratio && variable(i) < variable(leave))) leave = i, ratio = r;
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

GripForces grip_forces(const std::vector<PointContact>& contacts, const Vector3& com, double mass, const GripForceSettings& settings) {
  const auto m = static_cast<Eigen::Index>(contacts.size());
  GripForces out;
  if (m < 3) return out;
  double size = 0;
  for (const PointContact& c : contacts) size = std::max(size, (c.position - com).norm());
  Eigen::MatrixXd G(6, 3 * m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Vector3 r = (contacts[static_cast<std::size_t>(i)].position - com) / size;
    G.block<3, 3>(0, 3 * i).setIdentity();
    G.block<3, 3>(3, 3 * i) << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(G, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[5] > 1e-6 * svd.singularValues()[0])) return out;
  const Eigen::MatrixXd free = svd.matrixV().rightCols(3 * m - 6);           // forces that cancel out
  const Eigen::MatrixXd bear = -svd.solve(Eigen::MatrixXd::Identity(6, 3));  // forces on the object that bear a force at its centre
  const Eigen::Index n = free.cols() + 1, per = settings.edges + 1;
  const double load = mass * settings.acceleration;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(m * per, n);
  Eigen::VectorXd b(m * per), c = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < m; ++i) {
    const PointContact& contact = contacts[static_cast<std::size_t>(i)];
    const Vector3& normal = contact.inward_normal;
    const Vector3 t1 = normal.cross(std::abs(normal.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY()).normalized();
    const Vector3 t2 = normal.cross(t1);
    for (int k = 0; k < settings.edges; ++k) {
      const double angle = 2 * std::numbers::pi * k / settings.edges;
      const Vector3 inside = settings.friction_share * contact.friction * normal - std::cos(angle) * t1 - std::sin(angle) * t2;
      A.row(i * per + k).head(n - 1) = -inside.transpose() * free.middleRows(3 * i, 3);
      A(i * per + k, n - 1) = 1;
      b[i * per + k] = -load * (inside.transpose() * bear.middleRows(3 * i, 3)).norm();
    }
    A.row(i * per + settings.edges).head(n - 1) = normal.transpose() * free.middleRows(3 * i, 3);
    b[i * per + settings.edges] = settings.max_normal;
    c.head(n - 1) -= 1e-3 * free.middleRows(3 * i, 3).transpose() * normal;  // of equal margins the gentlest
  }
  c[n - 1] = 1;
  const double least = b.minCoeff();  // the margin without a squeeze
  for (Eigen::Index i = 0; i < b.size(); ++i) {
    if (i % per != settings.edges) b[i] -= least;
  }
  const Eigen::VectorXd x = maximise(c, A, b);
  const Eigen::VectorXd f = free * x.head(n - 1);
  for (Eigen::Index i = 0; i < m; ++i) out.forces.push_back(f.segment<3>(3 * i));
  out.margin = x[n - 1] + least;
  return out;
}

}  // namespace handsel
