// SPDX-License-Identifier: Apache-2.0
// The volume of a robot in motion, as reported to other robots. Own method: the capsules around
// the links, with the velocities of their ends.
#pragma once

#include <memory>
#include <vector>

#include "common/messages/perception.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {

/// Bound of RobotReport::parts.
inline constexpr std::size_t kMaxReportParts = 128;

class RobotVolume {
 public:
  explicit RobotVolume(std::shared_ptr<const RobotModel> robot);

  /// Returns whether `values` has one finite value for each axis of the robot.
  bool fits(const Vector& values) const;
  /// Returns the volume of the robot at a configuration, see fits(). `position`, `velocity`: of all
  /// axes; `T_world_base`: pose of the root link. At most kMaxReportParts parts: of a robot with
  /// more capsules the smallest ones are left out. Not thread safe.
  std::vector<MovingPart> parts(const Vector& position, const Vector& velocity,
                                const Pose& T_world_base);

 private:
  std::shared_ptr<const RobotModel> robot_;
  std::vector<LinkCapsule> capsules_;
  std::vector<Pose> links_, later_;  // in the root frame: now, and kStep later
};

}  // namespace handsel
