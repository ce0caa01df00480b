// SPDX-License-Identifier: Apache-2.0
// Another robot of the scenario, moved along a fixed motion: an obstacle that reports itself.
// Nobody feels its contact; the oracle measures its distance.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/messages/perception.hpp"
#include "common/model/robot_capsules.hpp"
#include "common/model/robot_volume.hpp"

namespace handsel::sim {

/// Motion of another robot: moves repeatedly between two configurations, each motion in the
/// same time and with minimum jerk.
struct OtherRobotMotion {
  std::string id;                           ///< name in RobotReport
  std::shared_ptr<const RobotModel> model;  ///< not null
  Pose T_world_base{Pose::Identity()};      ///< of its root link
  Vector from, to;                          ///< all axes [rad, m]
  double begins_at{};                       ///< at rest at `from` until then [s]
  double duration{};                        ///< duration of one motion [s]; 0: always at rest
  double pause{};                           ///< at each end [s]
  bool silent{};                            ///< does not report itself
};

class OtherRobotBody {
 public:
  explicit OtherRobotBody(OtherRobotMotion motion);

  /// Returns the report that the robot gives about itself; stamp left to the publisher.
  RobotReport report(double time);
  /// Returns the min distance of capsules at these poses of their links in the world to the robot
  /// at the time of the last place() [m]; negative: overlapping.
  double distance(const std::vector<LinkCapsule>& capsules,
                  const std::vector<Pose>& T_world_link) const;
  /// Moves the robot to where it is at this time [s].
  void place(double time);
  /// Whether the robot reports itself.
  bool reports() const { return !motion_.silent; }
  /// Name of the robot.
  const std::string& id() const { return motion_.id; }

 private:
  /// Completed fraction of the motion from `from` to `to`, and its rate [1/s].
  struct Progress {
    double fraction{}, rate{};
  };
  Progress progress(double time) const;

  OtherRobotMotion motion_;
  RobotVolume volume_;
  std::vector<MovingPart> parts_;
};

}  // namespace handsel::sim
