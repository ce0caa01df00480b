#include "components/trajectory_controller/gaze.hpp"

#include <algorithm>

namespace handsel::trajectory_controller {

namespace {

/// What must vanish: the direction to the point minus the viewing direction.
Vector3 miss(const RobotModel& robot, const Vector& q, const Vector3& p_root) {
  const Pose T = robot.link_pose(q, robot.gaze_link());
  return (p_root - T.translation()).normalized() - T.linear().col(0);
}

}  // namespace

std::vector<double> aim(const RobotModel& robot, const Group& head, const Vector& q, const Vector3& p_root) {
  Vector x = q;
  const auto n = static_cast<Eigen::Index>(head.axes.size());
  if (robot.gaze_link() >= 0 && n > 0 && (p_root - robot.link_pose(q, robot.gaze_link()).translation()).norm() > 0.05) {
    constexpr int kIterations = 12;
    constexpr double kStep = 1e-4, kDamping = 1e-4, kLargest = 0.5;
    Eigen::MatrixXd J(3, n);
    for (int k = 0; k < kIterations; ++k) {
      const Vector3 e = miss(robot, x, p_root);
      if (e.norm() < 1e-4) break;
      for (Eigen::Index i = 0; i < n; ++i) {
        Vector moved = x;
        moved[head.axes[static_cast<std::size_t>(i)]] += kStep;
        J.col(i) = (miss(robot, moved, p_root) - e) / kStep;
      }
      const Vector dx = -(J.transpose() * J + kDamping * Eigen::MatrixXd::Identity(n, n)).ldlt().solve(J.transpose() * e);
      for (Eigen::Index i = 0; i < n; ++i) {
        const int axis = head.axes[static_cast<std::size_t>(i)];
        const Axis& bounds = robot.axes()[static_cast<std::size_t>(axis)];
        x[axis] = std::clamp(x[axis] + std::clamp(dx[i], -kLargest, kLargest), bounds.lower, bounds.upper);
      }
    }
  }
  std::vector<double> out;
  for (int axis : head.axes) out.push_back(x[axis]);
  return out;
}

}  // namespace handsel::trajectory_controller
