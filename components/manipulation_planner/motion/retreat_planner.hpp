// Off from people the arm stands too near to. Own method. The guard lets a motion go there only
// when every link near them leads clearly away.
#pragma once

#include <vector>

#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel::manipulation_planner {

class WayOut {
 public:
  WayOut(const RobotModel& robot, const Group& arm);

  /// Returns whether the straight motion of all axes [rad, m] begins with every link that is near a
  /// person going clearly away from that person.
  bool leads_away(const Vector& from, const Vector& to, const Pose& T_world_base, const HumanState& people) const;
  /// Returns configurations of the arm, each about a centimetre further, that lead every link near
  /// a person away from them, at most `way` [m] in all, ending where no person is near any more or
  /// a link or a joint limit allows no more; empty: no person is near, or nothing leads away.
  std::vector<Vector> steps_away(const Vector& from, const Pose& T_world_base, const HumanState& people, double way) const;
  /// Returns the distance between the robot in a configuration and a point of the world [m].
  double distance(const Vector& posture, const Pose& T_world_base, const Vector3& p_world) const;

 private:
  bool within_limits(const Vector& posture) const;
  std::vector<Pose> links(const Vector& posture) const;

  const RobotModel& robot_;
  const Group& arm_;
  std::vector<LinkCapsule> capsules_;
};

}  // namespace handsel::manipulation_planner
