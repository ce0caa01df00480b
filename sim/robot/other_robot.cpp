// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/other_robot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/segments.hpp"

namespace handsel::sim {

OtherRobotBody::OtherRobotBody(OtherRobotMotion motion)
    : motion_(std::move(motion)), volume_(motion_.model) {
  place(0.0);
}

OtherRobotBody::Progress OtherRobotBody::progress(double time) const {
  const double since = time - motion_.begins_at, way = motion_.duration + motion_.pause;
  if (since <= 0.0 || motion_.duration <= 0.0) return {};
  const auto passes = static_cast<long>(since / way);
  const double s = std::min(1.0, (since - static_cast<double>(passes) * way) / motion_.duration);
  const double fraction = s * s * s * (10.0 + s * (6.0 * s - 15.0));
  const double rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) / motion_.duration;
  return passes % 2 == 0 ? Progress{fraction, rate} : Progress{1.0 - fraction, -rate};
}

void OtherRobotBody::place(double time) {
  const Progress at = progress(time);
  const Vector way = motion_.to - motion_.from;
  parts_ = volume_.parts(motion_.from + at.fraction * way, at.rate * way, motion_.T_world_base);
}

RobotReport OtherRobotBody::report(double time) {
  place(time);
  RobotReport report;
  report.robot = motion_.id;
  report.parts = parts_;
  return report;
}

double OtherRobotBody::distance(const std::vector<LinkCapsule>& capsules,
                                const std::vector<Pose>& T_world_link) const {
  double min_distance = std::numeric_limits<double>::infinity();
  for (const LinkCapsule& capsule : capsules) {
    const Pose& T = T_world_link[static_cast<std::size_t>(capsule.link)];
    const Vector3 a = T * capsule.a, b = T * capsule.b;
    for (const MovingPart& part : parts_) {
      Vector3 on_a, on_b;
      const double axes_apart = std::sqrt(nearest_points(a, b, part.a, part.b, on_a, on_b));
      min_distance = std::min(min_distance, axes_apart - capsule.radius - part.radius);
    }
  }
  return min_distance;
}

}  // namespace handsel::sim
