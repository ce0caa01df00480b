// SPDX-License-Identifier: Apache-2.0
// Where a robot's platform may stand to reach something. Own method.
#pragma once

#include "common/collision/collision_world.hpp"

namespace handsel {

struct PlatformPlace {
  Vector3 pose{Vector3::Zero()};  ///< x, y [m], heading [rad], world
  double distance{};  ///< from where it stands: metres, and kTurnDistance metres a radian
};
inline constexpr double kTurnDistance = 0.3;  ///< [m/rad]

/// Places about `p_world_object` from which `arm` may reach it by its length: four distances of its
/// shoulder, sixteen directions, twelve headings; the shortest drive first. `q`: all axes.
std::vector<PlatformPlace> places_around(const RobotModel& robot, const Group& arm, const Vector& q,
                                         const Pose& T_world_platform,
                                         const Vector3& p_world_object);

/// The platform at `place`, as high as in T_world_platform.
Pose standing_at(const PlatformPlace& place, const Pose& T_world_platform);

/// Distances that the robot keeps where its platform is sent to.
struct PlatformRoom {
  double people{0.5};  ///< of all of the robot [m]
  /// Level, of all of the robot: the platform stops beside its place by the errors of its
  /// localisation [m].
  double furniture{0.05};
};

/// Checks places. `mobile`: the robot on its platform (on_platform).
class PlatformFloor {
 public:
  PlatformFloor(const RobotModel& mobile, ObjectLibrary library, const Scene& scene,
                const HumanState& people, const PlatformRoom& room);

  /// Takes along what the hand holds.
  void carry(const Attachment& attachment) { world_.set_attachment(attachment, {}); }

  enum class Verdict : std::uint8_t { free, blocked, near_person };
  /// Checks the whole robot in configuration q (its own axes) with its platform there.
  Verdict check(const Vector& q, const Pose& T_world_platform);

 private:
  const RobotModel& mobile_;
  CollisionWorld world_;
  double room_to_people_;
  bool anybody_;
};

}  // namespace handsel
