// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/closed_chain.hpp"

#include <cstdio>

namespace handsel::trajectory_planner {
namespace {

// Max error of the joined tips at the start [m], [rad].
constexpr double kMaxStartDistance = 1e-3, kMaxStartAngle = 4e-3;

}  // namespace

JoinError join_error(const Pose& T_tip_follower, const Pose& wanted) {
  return {(T_tip_follower.translation() - wanted.translation()).norm(),
          Eigen::AngleAxisd(Eigen::Matrix3d(T_tip_follower.linear().transpose() * wanted.linear()))
              .angle()};
}

ClosedChain::ClosedChain(const RobotModel& robot, const JoinedArm& joined, const Vector& start)
    : robot_(robot),
      joined_(joined),
      chain_(robot, *joined.arm, start),
      arm_(ik::SrsArm::recognise(chain_)),
      start_(RobotModel::part(start, *joined.arm)),
      q_(start_) {
  if (arm_) elbow_ = arm_->elbow_angle(start_);
}

std::string ClosedChain::objection(const Pose& T_root_tip) const {
  if (!arm_) return ik::SrsArm::why_none(*joined_.arm);
  const JoinError off = error(T_root_tip, start_);
  if (off.apart <= kMaxStartDistance && off.turned <= kMaxStartAngle) return {};
  char out[200];
  std::snprintf(out, sizeof out,
                "the tip of %s is %.1f mm and %.1f degrees from where it is said to be joined to "
                "the other arm's",
                joined_.arm->name.c_str(), 1e3 * off.apart, off.turned * 180 / M_PI);
  return out;
}

JoinError ClosedChain::error(const Pose& T_root_tip, const Vector& joints) const {
  return join_error(T_root_tip.inverse() * chain_.forward(joints, nullptr), joined_.T_tip_follower);
}

bool ClosedChain::follow(const Pose& T_root_tip, double largest_step, std::string& why) {
  const Pose T = T_root_tip * joined_.T_tip_follower;
  const auto next = arm_->nearest(T, elbow_, q_);
  if (!next) {
    why = joined_.arm->name +
          (arm_->branches(T, elbow_).empty() ? " does not reach so far" : " meets a joint limit");
    return false;
  }
  Eigen::Index joint = 0;
  if ((*next - q_).cwiseAbs().maxCoeff(&joint) > largest_step) {
    why =
        "joint " +
        robot_.axes()[static_cast<std::size_t>(joined_.arm->axes[static_cast<std::size_t>(joint)])]
            .name +
        " would jump: shoulder, elbow or wrist is stretched there";
    return false;
  }
  q_ = *next;
  return true;
}

}  // namespace handsel::trajectory_planner
