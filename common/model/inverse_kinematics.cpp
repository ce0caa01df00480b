// Damped least squares (Levenberg-Marquardt, damping by the remaining error) on the chain of one group: joints that reach a limit are
// frozen there and the rest solved again; the null space pulls toward the rest posture; seeded restarts. Ours.
#include <Eigen/Cholesky>

#include <cmath>
#include <random>

#include "common/model/robot_model.hpp"

namespace handsel {
namespace {

constexpr int kMaxAxes = 24;
constexpr double kMetresPerRadian = 0.3;  // weighs turning against moving
constexpr double kMaxStep = 0.6;          // [rad] per iteration
constexpr double kPullNearSeed = 0.05, kPullElsewhere = 0.3;
constexpr int kPatience = 15;  // iterations without 5 % progress

using Axes = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxAxes, 1>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxAxes>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

struct Element {
  Pose T_before;
  Vector3 axis;
  bool prismatic;
  int column;
  double factor, offset;
};

class Chain {
 public:
  Chain(const RobotModel& robot, const Group& group, const Vector& q) : size_(static_cast<int>(group.axes.size())) {
    lower_.resize(size_), upper_.resize(size_), rest_.resize(size_);
    for (int i = 0; i < size_; ++i) {
      const Axis& axis = robot.axes()[group.axes[i]];
      lower_[i] = axis.lower, upper_[i] = axis.upper, rest_[i] = robot.rest_posture()[group.axes[i]];
    }
    std::vector<int> path;
    for (int link = group.tip; robot.links()[link].parent_joint >= 0; link = robot.joints()[path.back()].parent)
      path.push_back(robot.links()[link].parent_joint);
    Pose T = Pose::Identity();
    for (auto j = path.rbegin(); j != path.rend(); ++j) {
      const Joint& joint = robot.joints()[*j];
      T = T * joint.T_parent_joint;
      if (joint.kind == JointKind::fixed) continue;
      int column = -1;
      for (int c = 0; c < size_; ++c)
        if (group.axes[c] == joint.dof) column = c;
      if (column < 0) {
        const double value = (joint.dof >= 0 ? joint.mimic_factor * q[joint.dof] : 0.0) + joint.mimic_offset;
        if (joint.kind == JointKind::prismatic)
          T.translation() += T.linear() * (value * joint.axis);
        else
          T.rotate(Eigen::AngleAxisd(value, joint.axis));
        continue;
      }
      const bool prismatic = joint.kind == JointKind::prismatic;
      if (!elements_.empty()) reach_ += T.translation().norm();
      if (prismatic) reach_ += std::max(std::abs(lower_[column]), std::abs(upper_[column])) * std::abs(joint.mimic_factor);
      elements_.push_back({T, joint.axis, prismatic, column, joint.mimic_factor, joint.mimic_offset});
      T = Pose::Identity();
    }
    T_after_ = T;
    reach_ += T.translation().norm();
  }

  int size() const { return size_; }
  bool empty() const { return elements_.empty(); }
  const Axes& lower() const { return lower_; }
  const Axes& upper() const { return upper_; }
  const Axes& rest() const { return rest_; }
  bool within_reach(const Vector3& p) const { return (p - elements_.front().T_before.translation()).norm() <= reach_ + 1e-6; }

  Pose forward(const Axes& q, Jacobian* J) const {
    Pose T = Pose::Identity();
    Vector3 origins[2 * kMaxAxes], axes[2 * kMaxAxes];
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      const Element& e = elements_[i];
      T = T * e.T_before;
      origins[i] = T.translation();
      axes[i] = T.linear() * e.axis;
      const double value = e.factor * q[e.column] + e.offset;
      if (e.prismatic)
        T.translation() += value * axes[i];
      else
        T.linear() = T.linear() * Eigen::AngleAxisd(value, e.axis).toRotationMatrix();
    }
    T = T * T_after_;
    if (J == nullptr) return T;
    J->setZero(6, size_);
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      const Element& e = elements_[i];
      if (e.prismatic) {
        J->block<3, 1>(0, e.column) += e.factor * axes[i];
      } else {
        J->block<3, 1>(0, e.column) += e.factor * axes[i].cross(T.translation() - origins[i]);
        J->block<3, 1>(3, e.column) += e.factor * axes[i];
      }
    }
    return T;
  }
  bool fits() const { return size_ <= kMaxAxes && elements_.size() <= 2 * kMaxAxes; }

 private:
  int size_;
  Axes lower_, upper_, rest_;
  std::vector<Element> elements_;
  Pose T_after_{Pose::Identity()};
  double reach_{0};
};

Vector6 error_of(const Pose& target, const Pose& now) {
  Vector6 e;
  e.head<3>() = target.translation() - now.translation();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(target.linear() * now.linear().transpose()));
  e.tail<3>() = turn.angle() * turn.axis();
  return e;
}

/// One step; joints that would leave their range are put on the limit and the others make up for it.
Axes step_of(const Chain& chain, const Axes& q, const Jacobian& J, const Vector6& error, double damping, double pull) {
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

bool converge(const Chain& chain, const Pose& target, const IkOptions& options, double pull, Axes& q) {
  Jacobian J;
  double best = std::numeric_limits<double>::infinity();
  int patience = kPatience;
  for (int i = 0; i < options.max_iterations; ++i) {
    Vector6 error = error_of(target, chain.forward(q, &J));
    if (error.head<3>().norm() <= options.position_tolerance && error.tail<3>().norm() <= options.angle_tolerance) return true;
    error.tail<3>() *= kMetresPerRadian;
    J.bottomRows<3>() *= kMetresPerRadian;
    const double size = error.squaredNorm();
    if (size < 0.95 * best) {
      best = size;
      patience = kPatience;
    } else if (--patience == 0) {
      return false;
    }
    q += step_of(chain, q, J, error, 0.05 * size + 1e-10, size < 1e-6 ? 0.0 : pull);
    q = q.cwiseMax(chain.lower()).cwiseMin(chain.upper());
  }
  return false;
}

}  // namespace

std::optional<Vector> RobotModel::inverse(const Group& group, const Pose& T_root_tip, const Vector& q_seed,
                                          const IkOptions& options) const {
  if (group.tip < 0 || group.axes.empty()) return std::nullopt;
  const Chain chain(*this, group, q_seed);
  if (chain.empty() || !chain.fits() || !T_root_tip.matrix().allFinite() || !chain.within_reach(T_root_tip.translation()))
    return std::nullopt;

  Axes q(chain.size());
  for (int i = 0; i < chain.size(); ++i) q[i] = q_seed[group.axes[i]];
  q = q.cwiseMax(chain.lower()).cwiseMin(chain.upper());
  if (converge(chain, T_root_tip, options, kPullNearSeed, q)) return Vector(q);

  std::mt19937_64 engine(options.random_seed);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  for (int restart = 0; restart < options.restarts; ++restart) {
    for (int i = 0; i < chain.size(); ++i)
      q[i] = restart == 0 ? chain.rest()[i] : chain.lower()[i] + uniform() * (chain.upper()[i] - chain.lower()[i]);
    if (converge(chain, T_root_tip, options, kPullElsewhere, q)) return Vector(q);
  }
  return std::nullopt;
}

}  // namespace handsel
