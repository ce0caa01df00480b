// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/contact_speeds.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/model/platform.hpp"

namespace handsel::trajectory_controller {

namespace {

/// Returns half of the mass that the axes move (ISO/TS 15066:2016, A.3.4), with or without the axes
/// of the platform [kg].
double half_moving_mass(const RobotModel& robot, bool with_platform) {
  std::vector<char> moves(robot.links().size(), 0);
  const Group* platform = robot.group(kPlatformGroup);
  const auto counts = [&](const Joint& joint) {
    if (joint.kind == JointKind::fixed || joint.dof < 0) return false;
    return with_platform || platform == nullptr ||
           std::count(platform->axes.begin(), platform->axes.end(), joint.dof) == 0;
  };
  double mass = 0.0;
  for (const Joint& joint : robot.joints()) {
    const auto parent = static_cast<std::size_t>(joint.parent);
    const auto child = static_cast<std::size_t>(joint.child);
    moves[child] = moves[parent] || counts(joint);
    if (moves[child]) mass += robot.links()[child].mass;
  }
  return 0.5 * mass;
}

}  // namespace

ContactSpeeds::ContactSpeeds(const ContactLimits& limits, const RobotModel& robot,
                             double min_robot_mass, double finger_mass)
    : limits_(limits),
      min_robot_mass_(min_robot_mass),
      finger_mass_(finger_mass),
      moving_mass_(half_moving_mass(robot, false)),
      platform_mass_(half_moving_mass(robot, true) - moving_mass_) {}

double ContactSpeeds::arm_mass(double payload) const noexcept {
  return std::max(min_robot_mass_, moving_mass_ + std::max(0.0, payload));
}

double ContactSpeeds::max_speed_at(BodyRegion region, double payload) const noexcept {
  return max_contact_speed(limits_[static_cast<std::size_t>(region)], arm_mass(payload));
}

double ContactSpeeds::finger_ratio_at(BodyRegion region, double payload) const noexcept {
  const ContactLimit& limit = limits_[static_cast<std::size_t>(region)];
  return std::sqrt(reduced_mass(limit, finger_mass_) / reduced_mass(limit, arm_mass(payload)));
}

void ContactSpeeds::set_payload(double payload) noexcept {
  for (std::size_t r = 0; r < kBodyRegions; ++r) {
    max_speed_[r] = max_speed_at(static_cast<BodyRegion>(r), payload);
    finger_ratio_[r] = finger_ratio_at(static_cast<BodyRegion>(r), 0.0);
  }
  min_speed_ = *std::min_element(max_speed_.begin(), max_speed_.end());
}

double ContactSpeeds::of(double carried, double inner, std::size_t region) const noexcept {
  return inner == 0.0 ? carried : std::hypot(carried, finger_ratio_[region] * inner);
}

}  // namespace handsel::trajectory_controller
