// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/pose_goals.hpp"

#include <algorithm>
#include <cmath>

#include "components/path_planner/search/random.hpp"

namespace handsel::path_planner {
namespace {

constexpr double kSame = 0.05;  // max difference of equal configurations [rad]

}  // namespace

PoseGoals reach(const RobotModel& robot, const Group& group, const std::vector<PoseGoal>& poses,
                const Vector& q_start, std::uint64_t seed, int each) {
  PoseGoals found;
  Random random(seed);
  IkOptions options;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::vector<Vector> of_pose;
    for (int k = 0; k < each; ++k) {
      Pose T = poses[i].T_root_tip;
      Vector q = q_start;
      if (k > 0) {
        Vector3 shift;
        for (int axis = 0; axis < 3; ++axis)
          shift[axis] = random.between(-1, 1) * poses[i].slack[axis];
        T.translate(shift).rotate(
            Eigen::AngleAxisd(random.between(-1, 1) * poses[i].turn, Vector3::UnitZ()));
        for (int axis : group.axes) {
          const Axis& of = robot.axes()[static_cast<std::size_t>(axis)];
          q[axis] = random.between(std::max(of.lower, q_start[axis] - M_PI),
                                   std::min(of.upper, q_start[axis] + M_PI));
        }
      }
      options.random_seed = random.bits();
      const std::optional<Vector> candidate = robot.inverse(group, T, q, options);
      if (!candidate) continue;
      const auto same = [&](const Vector& other) {
        return (other - *candidate).cwiseAbs().maxCoeff() < kSame;
      };
      if (std::none_of(of_pose.begin(), of_pose.end(), same)) of_pose.push_back(*candidate);
    }
    for (Vector& candidate : of_pose) {
      found.goals.push_back(std::move(candidate));
      found.pose.push_back(i);
    }
  }
  if (poses.empty()) found.reason = "no goal was given";
  if (found.goals.empty() && !poses.empty())
    found.reason =
        (poses.size() == 1 ? std::string("no configuration of the group \"")
                           : "of the " + std::to_string(poses.size()) +
                                 " goals none is reached by a configuration of the group \"") +
        group.name + (poses.size() == 1 ? "\" reaches the goal" : "\"");
  return found;
}

}  // namespace handsel::path_planner
