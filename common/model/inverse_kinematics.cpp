// SPDX-License-Identifier: Apache-2.0
// Closed form for shoulder-elbow-wrist chains (srs_arm.hpp); otherwise damped least squares
// (Levenberg-Marquardt, damping by the remaining error) on the chain of one group: joints at a
// limit are frozen and the others solved again; the null space pulls toward the rest configuration;
// seeded restarts. Own method: combines known parts.
#include <Eigen/Cholesky>

#include <cmath>
#include <random>

#include "common/model/ik_chain.hpp"
#include "common/model/srs_arm.hpp"

namespace handsel {
namespace {

constexpr double kMetresPerRadian = 0.3;  // weight of rotation against translation [m/rad]
constexpr double kMaxStep = 0.6;          // max step per iteration [rad]
constexpr double kOnLimit = 1e-7, kWorthTrying = 0.3;  // excess over limits, closed form [rad]
constexpr double kPullNearSeed = 0.05, kPullElsewhere = 0.3;
constexpr int kMaxStalledIterations = 15;  // max iterations without 5 % progress

using ik::Axes;
using ik::Chain;
using ik::error_of;
using ik::Jacobian;
using ik::kMaxAxes;
using ik::Vector6;

/// Computes one step; joints that would exceed their range are put on the limit and the others
/// compensate.
Axes step_of(const Chain& chain, const Axes& q, const Jacobian& J, const Vector6& error,
             double damping, double pull) {
  const int n = chain.size();
  Axes dq = Axes::Zero(n);
  bool frozen[kMaxAxes] = {};
  Vector6 left = error;
  Jacobian A = J;
  for (int round = 0; round < n; ++round) {
    Axes wish(n);
    for (int i = 0; i < n; ++i) wish[i] = frozen[i] ? 0.0 : pull * (chain.rest()[i] - q[i]);
    Eigen::Matrix<double, 6, 6> H = A * A.transpose();
    H.diagonal().array() += damping;
    const Vector6 y = H.ldlt().solve(left - A * wish);
    const Axes free_step = wish + A.transpose() * y;
    bool again = false;
    for (int i = 0; i < n; ++i) {
      if (frozen[i]) continue;
      dq[i] = free_step[i];
      const double to = std::min(std::max(q[i] + dq[i], chain.lower()[i]), chain.upper()[i]);
      if (to == q[i] + dq[i]) continue;
      dq[i] = to - q[i];
      frozen[i] = true;
      left -= A.col(i) * dq[i];
      A.col(i).setZero();
      again = true;
    }
    if (!again) break;
  }
  const double largest = dq.cwiseAbs().maxCoeff();
  if (largest > kMaxStep) dq *= kMaxStep / largest;
  return dq;
}

bool converge(const Chain& chain, const Pose& target, const IkOptions& options, double pull,
              Axes& q) {
  Jacobian J;
  double best = std::numeric_limits<double>::infinity();
  int stalled_iterations_left = kMaxStalledIterations;
  for (int i = 0; i < options.max_iterations; ++i) {
    Vector6 error = error_of(target, chain.forward(q, &J));
    if (error.head<3>().norm() <= options.position_tolerance &&
        error.tail<3>().norm() <= options.angle_tolerance)
      return true;
    error.tail<3>() *= kMetresPerRadian;
    J.bottomRows<3>() *= kMetresPerRadian;
    const double size = error.squaredNorm();
    if (size < 0.95 * best) {
      best = size;
      stalled_iterations_left = kMaxStalledIterations;
    } else if (--stalled_iterations_left == 0) {
      return false;
    }
    q += step_of(chain, q, J, error, 0.05 * size + 1e-10, size < 1e-6 ? 0.0 : pull);
    q = q.cwiseMax(chain.lower()).cwiseMin(chain.upper());
  }
  return false;
}

}  // namespace

std::optional<Vector> RobotModel::inverse(const Group& group, const Pose& T_root_tip,
                                          const Vector& q_seed, const IkOptions& options) const {
  if (group.tip < 0 || group.axes.empty()) return std::nullopt;
  const Chain chain(*this, group, q_seed);
  if (chain.empty() || !chain.fits() || !T_root_tip.matrix().allFinite() ||
      !chain.within_reach(T_root_tip.translation()))
    return std::nullopt;

  Axes q(chain.size());
  for (int i = 0; i < chain.size(); ++i) q[i] = q_seed[group.axes[i]];
  q = q.cwiseMax(chain.lower()).cwiseMin(chain.upper());
  if (const auto arm = ik::SrsArm::recognise(chain)) {
    const auto solution = arm->solve(T_root_tip, q);
    if (!solution || solution->outside > kWorthTrying) return std::nullopt;
    q = solution->q;
    if (solution->outside < kOnLimit || converge(chain, T_root_tip, options, 0.0, q))
      return Vector(q);
    return std::nullopt;
  }
  if (converge(chain, T_root_tip, options, kPullNearSeed, q)) return Vector(q);

  std::mt19937_64 engine(options.random_seed);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  for (int restart = 0; restart < options.restarts; ++restart) {
    for (int i = 0; i < chain.size(); ++i)
      q[i] = restart == 0 ? chain.rest()[i]
                          : chain.lower()[i] + uniform() * (chain.upper()[i] - chain.lower()[i]);
    if (converge(chain, T_root_tip, options, kPullElsewhere, q)) return Vector(q);
  }
  return std::nullopt;
}

}  // namespace handsel
