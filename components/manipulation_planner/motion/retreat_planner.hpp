// SPDX-License-Identifier: Apache-2.0
// Retreat from people that are too near to the arm. Own method. The guard permits such a motion
// only when every link near a person moves clearly away from the person.
#pragma once

#include <string>
#include <vector>

#include "common/config/settings/manipulation_planner.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel::manipulation_planner {

class RetreatPlanner {
 public:
  /// The references must outlive what is made; a group that changes is followed.
  RetreatPlanner(const RobotModel& robot, const Group& arm,
                 const settings::ManipulationPlannerSettings& settings);

  /// Returns whether the straight motion of all axes [rad, m] begins with every link that is near a
  /// person going clearly away from that person.
  bool leads_away(const Vector& from, const Vector& to, const Pose& T_world_base,
                  const HumanState& people) const;
  /// Returns configurations of the arm, each about `retreat_step` further, that lead every link
  /// near a person away from them, at most `max_distance` [m] in all, ending where no person is
  /// near any more or a link or a joint limit allows no more; empty: no person is near, or nothing
  /// leads away.
  std::vector<Vector> steps_away(const Vector& from, const Pose& T_world_base,
                                 const HumanState& people, double max_distance) const;
  /// Returns the distance between the robot in a configuration and a point of the world [m].
  double distance(const Vector& q, const Pose& T_world_base, const Vector3& p_world) const;
  /// Returns the distance between the robot in a configuration and the nearest person, without
  /// the forearms and hands of the person `partner` [m]; infinity: nobody is there.
  double separation(const Vector& q, const Pose& T_world_base, const HumanState& people,
                    const std::string& partner) const;

 private:
  bool within_limits(const Vector& q) const;
  std::vector<Pose> links(const Vector& q) const;

  const RobotModel& robot_;
  const Group& arm_;
  const settings::ManipulationPlannerSettings& settings_;
  std::vector<LinkCapsule> capsules_;
};

/// Returns directions in the world that lead a tool off a point, the likeliest first: backwards,
/// then level away from the point, upwards, downwards and to the sides.
std::vector<Vector3> retreat_directions(const Pose& T_world_tool, const Vector3& p_world_from,
                                        const Vector3& p_world_base);

}  // namespace handsel::manipulation_planner
