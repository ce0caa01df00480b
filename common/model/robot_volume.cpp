// SPDX-License-Identifier: Apache-2.0
#include "common/model/robot_volume.hpp"

#include <algorithm>

namespace handsel {

RobotVolume::RobotVolume(std::shared_ptr<const RobotModel> robot)
    : robot_(std::move(robot)), capsules_(robot_capsules(*robot_)) {
  if (capsules_.size() <= kMaxReportParts) return;
  const auto extent = [](const LinkCapsule& c) { return (c.b - c.a).norm() + 2.0 * c.radius; };
  std::stable_sort(
      capsules_.begin(), capsules_.end(),
      [&](const LinkCapsule& x, const LinkCapsule& y) { return extent(x) > extent(y); });
  capsules_.resize(kMaxReportParts);
}

bool RobotVolume::fits(const Vector& values) const {
  return values.size() == robot_->dof() && values.allFinite();
}

std::vector<MovingPart> RobotVolume::parts(const Vector& position, const Vector& velocity,
                                           const Pose& T_world_base) {
  constexpr double kStep = 1e-3;  // step of the finite differences for velocities [s]
  robot_->forward(position, links_);
  robot_->forward(position + kStep * velocity, later_);
  std::vector<MovingPart> parts;
  parts.reserve(capsules_.size());
  for (const LinkCapsule& capsule : capsules_) {
    const auto link = static_cast<std::size_t>(capsule.link);
    const Pose now = T_world_base * links_[link], later = T_world_base * later_[link];
    const Vector3 a = now * capsule.a, b = now * capsule.b;
    parts.push_back(
        {a, b, capsule.radius, (later * capsule.a - a) / kStep, (later * capsule.b - b) / kStep});
  }
  return parts;
}

}  // namespace handsel
