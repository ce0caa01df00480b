// Where a robot's platform may stand to take something. Own method.
#pragma once

#include "common/collision/collision_world.hpp"

namespace handsel::grasp_planner {

struct PlatformPlace {
  Vector3 pose{Vector3::Zero()};  ///< x, y [m], heading [rad], world
  double distance{};  ///< from where it stands: metres, and kTurnDistance metres a radian
};
inline constexpr double kTurnDistance = 0.3;  ///< [m/rad]

/// Places about `p_world_object` from which `arm` may reach it by its length: four distances of its
/// shoulder, sixteen directions, twelve headings; the shortest drive first. `q`: all axes.
std::vector<PlatformPlace> places_around(const RobotModel& robot, const Group& arm, const Vector& q,
                                         const Pose& T_world_base, const Vector3& p_world_object);

/// The robot's root where its platform is at `place`, as high as in T_world_base.
Pose standing_at(const PlatformPlace& place, const Pose& T_world_base);

/// Checks places. `mobile`: the robot on its platform (on_platform).
class PlatformFloor {
 public:
  /// `room` [m]: kept between all of the robot and people.
  PlatformFloor(const RobotModel& mobile, ObjectLibrary library, const Scene& scene,
                const HumanState& people, double room);

  enum class Verdict : std::uint8_t { free, blocked, near_person };
  /// Checks the whole robot in configuration q (its own axes) at the place.
  Verdict check(const Vector& q, const Pose& T_world_base);

 private:
  CollisionWorld world_;
  double room_;
  bool anybody_;
};

}  // namespace handsel::grasp_planner
