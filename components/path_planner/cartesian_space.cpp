// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/cartesian_space.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::path_planner {
namespace {

constexpr double kMinFromPi = 0.02;    // min distance from pi of the angle of a path segment [rad]
constexpr double kMotionStep = 0.005;  // step of the checks between two samples [rad]
constexpr int kMaxHalvings = 4;        // max halvings of a step before the joints count as jumping

}  // namespace

double wrapped(double angle) { return std::remainder(angle, 2 * M_PI); }

CartesianNode ArmKinematics::node_of(const Vector& q) const {
  ik::Axes joints = RobotModel::part(q, group_);
  return {chain_.forward(joints, nullptr), arm_.elbow_angle(joints), q};
}

int ArmKinematics::bends(const Vector& a, const Vector& b) const {
  constexpr double kMaxStretched = 1e-3;  // max angle of a stretched joint [rad]
  int other = 0;
  for (const std::size_t middle : {1, 3, 5}) {
    const double x = a[group_.axes[middle]], y = b[group_.axes[middle]];
    other += x * y < 0 && std::min(std::abs(x), std::abs(y)) > kMaxStretched;
  }
  return other;
}

std::vector<Vector> ArmKinematics::configurations(const Pose& T, double elbow,
                                                  const Vector& all) const {
  std::vector<Vector> out;
  for (const ik::Axes& q : arm_.branches(T, elbow))
    if (const auto inside = arm_.turned_inside(q, 0.5 * (chain_.lower() + chain_.upper())))
      out.push_back(RobotModel::with(all, group_, *inside));
  return out;
}

std::optional<LocalPath> LocalPath::between(const CartesianNode& a, const CartesianNode& b) {
  const Eigen::AngleAxisd turn(
      Eigen::Matrix3d(a.T_root_tool.linear().transpose() * b.T_root_tool.linear()));
  if (turn.angle() > M_PI - kMinFromPi) return std::nullopt;
  return LocalPath(a, b, turn);
}

CartesianNode LocalPath::at(double fraction) const {
  CartesianNode out;
  out.T_root_tool.linear() =
      a_.T_root_tool.linear() * Eigen::AngleAxisd(fraction * turn_, turn_axis_).toRotationMatrix();
  out.T_root_tool.translation() = a_.T_root_tool.translation() + fraction * move_;
  out.elbow = wrapped(a_.elbow + fraction * elbow_);
  return out;
}

LocalPath::LocalPath(const CartesianNode& a, const CartesianNode& b, const Eigen::AngleAxisd& turn)
    : a_(a),
      b_(b),
      move_(b.T_root_tool.translation() - a.T_root_tool.translation()),
      turn_axis_(turn.axis()),
      turn_(turn.angle()),
      elbow_(wrapped(b.elbow - a.elbow)) {}

CartesianSpace::CartesianSpace(const PlanningModels& models, const CartesianProblem& problem,
                               const CartesianSettings& settings, const Hooks& hooks,
                               const ArmKinematics& arm)
    : Budget(models.world, problem.budget, hooks),
      world_(models.world),
      cost_(models.cost),
      problem_(problem),
      settings_(settings),
      arm_(arm) {}

std::vector<Vector> CartesianSpace::configurations(const Pose& T, double elbow, const Vector& all) {
  charge(1);
  return arm_.configurations(T, elbow, all);
}

double CartesianSpace::distance(const CartesianNode& a, const CartesianNode& b) const {
  const double turn = Eigen::Quaterniond(a.T_root_tool.linear())
                          .angularDistance(Eigen::Quaterniond(b.T_root_tool.linear()));
  const double elbow = settings_.elbow * wrapped(b.elbow - a.elbow);
  double sum = settings_.metre * settings_.metre *
                   (a.T_root_tool.translation() - b.T_root_tool.translation()).squaredNorm() +
               turn * turn + elbow * elbow;
  for (int axis : problem_.also) sum += (a.q[axis] - b.q[axis]) * (a.q[axis] - b.q[axis]);
  return std::sqrt(sum);
}

double CartesianSpace::follow(const CartesianNode& a, const CartesianNode& b, double far,
                              CartesianNode& at, std::vector<Vector>* samples) {
  at = a;
  const std::optional<LocalPath> path = LocalPath::between(a, b);
  if (!path) return 0.0;
  const int steps = std::max(1, static_cast<int>(std::ceil(far * distance(a, b) / settings_.step)));
  double reached = 0;
  for (int k = 1; k <= steps; ++k) {
    const double to = far * k / steps;
    if (!advance(*path, reached, to, at, samples, 0)) return reached;
    reached = to;
  }
  return reached;
}

bool CartesianSpace::advance(const LocalPath& path, double from, double to, CartesianNode& at,
                             std::vector<Vector>* samples, int halved) {
  CartesianNode next = path.at(to);
  const Vector now = RobotModel::part(at.q, arm_.group());
  charge(1);
  const std::optional<ik::Axes> best = arm_.nearest(next.T_root_tool, next.elbow, now);
  if (!best) return false;
  if ((*best - now).lpNorm<Eigen::Infinity>() > settings_.largest_step) {
    if (halved == kMaxHalvings) return false;
    const double middle = 0.5 * (from + to);
    return advance(path, from, middle, at, samples, halved + 1) &&
           advance(path, middle, to, at, samples, halved + 1);
  }
  next.q = RobotModel::with(at.q, arm_.group(), *best);
  const Vector &a = path.begin().q, &b = path.end().q;
  for (int axis : problem_.also) next.q[axis] = a[axis] + to * (b[axis] - a[axis]);
  if (!world_.check_motion(at.q, next.q, kMotionStep).free) return false;
  at = next;
  if (samples != nullptr) samples->push_back(at.q);
  return true;
}

}  // namespace handsel::path_planner
