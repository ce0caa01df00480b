// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/platform_odometry.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::sim {
namespace {

constexpr double kSlipRatio = 0.5;  // additional rolling of slipping wheels per distance driven

Place compose(const Place& a, const Place& b) {
  const double c = std::cos(a.z()), s = std::sin(a.z());
  return {a.x() + c * b.x() - s * b.y(), a.y() + s * b.x() + c * b.y(), a.z() + b.z()};
}

Place inverse(const Place& a) {
  const double c = std::cos(a.z()), s = std::sin(a.z());
  return {-c * a.x() - s * a.y(), s * a.x() - c * a.y(), -a.z()};
}

}  // namespace

PlatformOdometry::PlatformOdometry(const RobotModel& robot, const Vector& start,
                                   const OdometrySettings& odometry,
                                   const LocalisationSettings& localisation, std::uint64_t seed)
    : axes_(robot.require_group(kPlatformGroup).axes),
      odometry_(odometry),
      localisation_(localisation),
      random_(seed),
      actual_(place_of(start)),
      measured_(actual_),
      offset_(Place::Zero()) {}

Place PlatformOdometry::place_of(const Vector& all) const {
  return {all[axes_[0]], all[axes_[1]], all[axes_[2]]};
}

void PlatformOdometry::advance(const Vector& position, double now) {
  const Place here = place_of(position);
  Place step = compose(inverse(actual_), here);
  const double distance = std::sqrt(step.head<2>().norm());
  const double turned = std::sqrt(step.head<2>().norm() + std::abs(step.z()));
  step.x() += draw(odometry_.noise * distance);
  step.y() += draw(odometry_.noise * distance);
  step.z() += draw(odometry_.turn_noise * turned);
  const double slipped = std::min(to_slip_, kSlipRatio * step.head<2>().norm());
  to_slip_ -= slipped;
  if (slipped > 0) step.head<2>() += slipped * Eigen::Vector2d(step.head<2>()).normalized();
  actual_ = here;
  measured_ = compose(measured_, step);
  offset_ = compose(actual_, inverse(measured_));
  localise(now);
}

void PlatformOdometry::localise(double now) {
  if (now + 1e-9 < next_) return;
  next_ = now + 1 / localisation_.rate;
  if (now < lost_until_) return;
  // The measured pose has noise; the pose of the odometry frame follows from the odometry.
  const Place found(actual_.x() + shift_ + draw(localisation_.noise),
                    actual_.y() + draw(localisation_.noise),
                    actual_.z() + draw(localisation_.turn_noise));
  const Place frame = compose(found, inverse(measured_));
  const double period = now - found_;
  found_ = now;
  const double jump = (compose(estimate_, measured_) - found).head<2>().norm();
  constexpr double kMaxJump = 0.1;  // max error of the estimate before the filter restarts [m]
  const double weight = jump > kMaxJump ? 1.0 : period / (localisation_.filter_time + period);
  // Filters the platform's pose: the position of a distant frame depends strongly on its heading.
  const Place filtered = compose(estimate_, measured_) * (1 - weight) + found * weight;
  estimate_ = weight < 1 ? compose(filtered, inverse(measured_)) : frame;
}

void PlatformOdometry::to_root(Vector& position, Vector& velocity, Vector& acceleration) const {
  const Place place = compose(offset_, place_of(position));
  for (int i = 0; i < 3; ++i) position[axes_[static_cast<std::size_t>(i)]] = place[i];
  const Eigen::Rotation2Dd turn(offset_.z());
  for (Vector* rate : {&velocity, &acceleration}) {
    const Eigen::Vector2d v = turn * Eigen::Vector2d((*rate)[axes_[0]], (*rate)[axes_[1]]);
    (*rate)[axes_[0]] = v.x();
    (*rate)[axes_[1]] = v.y();
  }
}

Vector PlatformOdometry::measured_position(const Vector& position) const {
  Vector out = position;
  const Place place = compose(inverse(offset_), place_of(position));
  for (int i = 0; i < 3; ++i) out[axes_[static_cast<std::size_t>(i)]] = place[i];
  return out;
}

Vector PlatformOdometry::measured_velocity(const Vector& velocity) const {
  Vector out = velocity;
  const Eigen::Vector2d v =
      Eigen::Rotation2Dd(-offset_.z()) * Eigen::Vector2d(velocity[axes_[0]], velocity[axes_[1]]);
  out[axes_[0]] = v.x();
  out[axes_[1]] = v.y();
  return out;
}

Pose PlatformOdometry::T_root_odometry() const {
  return make_pose({estimate_.x(), estimate_.y(), 0},
                   Eigen::Quaterniond(Eigen::AngleAxisd(estimate_.z(), Vector3::UnitZ())));
}

}  // namespace handsel::sim
