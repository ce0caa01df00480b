// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/finger_limit.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/segments.hpp"
#include "common/trajectory/stop.hpp"

namespace handsel::trajectory_controller {

FingerLimit::FingerLimit(const StopProof& proof, const RobotModel& robot,
                         const GuardSettings& guard)
    : proof_(proof),
      guard_(guard),
      comfort_speeds_(static_cast<std::size_t>(robot.dof()), 0.0),
      all_frames_(proof.chain().frames().size(), 1),
      motions_(all_frames_.size()),
      at_rest_(Vector::Zero(robot.dof())) {
  const KinematicLimits &comfort = robot.comfort_limits(), &stop = robot.stop_limits();
  for (const ChainCapsule& hand : proof.chain().capsules())
    for (const std::vector<Lever>& finger : hand.fingers)
      for (const Lever& lever : finger) {
        const double speed = comfort.velocity[lever.axis];
        comfort_speeds_[static_cast<std::size_t>(lever.axis)] = speed;
        stop_time_ = std::max(stop_time_, measure_stop(speed, 0.0, stop.acceleration[lever.axis],
                                                       stop.jerk[lever.axis])
                                              .duration);
      }
}

/// `to_robot` is a unit vector; `speed` [m/s] is that of the fingers.
bool FingerLimit::is_too_near(const PersonCapsule& part, const Vector3& to_robot, double distance,
                              double speed, double age) const noexcept {
  const double v_h = directed_speed(part, to_robot, guard_);
  if (part.excepted || v_h < guard_.finger_stop_speed + guard_.speed_uncertainty) return false;
  const double reaction = guard_.reaction + age;
  const double needed = v_h * (reaction + part.age + stop_time_) +
                        speed * (reaction + 0.5 * stop_time_) + guard_.intrusion +
                        guard_.uncertainty_human + guard_.uncertainty_robot;
  return distance < needed;
}

FingerBounds FingerLimit::bounds(const Vector& position, const Pose& T_world_base, double age,
                                 double payload, const PersonCapsules& people) noexcept {
  const StopProofSettings& s = proof_.settings();
  FingerBounds found;
  if (people.capsules.empty() || stop_time_ == 0.0) return found;
  proof_.chain().move(position, at_rest_, all_frames_, motions_);
  const double reaction = s.latency + s.robot_side_delay + age;
  for (const ChainCapsule& hand : proof_.chain().capsules()) {
    if (hand.fingers.empty()) continue;
    const double speed = hand.inner_bound(comfort_speeds_);
    const FrameMotion& frame = motions_[static_cast<std::size_t>(hand.frame)];
    const Vector3 a = T_world_base * (frame.p + frame.R * hand.a),
                  b = T_world_base * (frame.p + frame.R * hand.b);
    for (const PersonCapsule& part : people.capsules) {
      Vector3 on_robot, on_person;
      const double axes_apart =
          std::sqrt(nearest_points(a, b, part.a, part.b, on_robot, on_person));
      const double distance = axes_apart - hand.radius - part.radius;
      const Vector3 to_robot = (on_robot - on_person).stableNormalized();
      found.too_near = found.too_near || is_too_near(part, to_robot, distance, speed, age);
      const double fits = s.finger_ratio *
                          proof_.contact_speeds().max_speed_at(part.region, payload) /
                          (proof_.contact_speeds().finger_ratio_at(part.region, payload) * speed);
      if (!s.enabled || fits >= found.speed) continue;
      const RegionMotion& region = s.people[static_cast<std::size_t>(part.region)];
      const double reached = reach_after(reaction + part.age + stop_time_,
                                         start_speed(part, s.speed_error, region), region) +
                             speed * (reaction + 0.5 * stop_time_) + s.tracker_error +
                             s.robot_error + s.limit_margin;
      if (distance <= reached) found.speed = fits;
    }
  }
  return found;
}

}  // namespace handsel::trajectory_controller
