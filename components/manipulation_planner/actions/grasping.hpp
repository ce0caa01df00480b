// SPDX-License-Identifier: Apache-2.0
// Steps that several actions have in common: grasps, retreats of the hand.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {

/// Grasps, or why there are none.
struct GraspList {
  Outcome outcome;            ///< whether there are grasps
  std::vector<Grasp> grasps;  ///< best first
};

// References must outlive the routines.
/// Asks for at most `max_grasps` grasps of an object. `for_human`: who will get it, empty: nobody.
Routine<GraspList> ask_grasps(Parts& parts, const std::string& object, const std::string& for_human,
                              std::uint32_t max_grasps);
/// Asks for grasps of an object; where none is within reach, for grasps from other places of the
/// platform, each in Grasp::platform. Does not drive.
Routine<GraspList> ask_grasps_anywhere(Parts& parts, const std::string& object);
/// Returns the grasp for where the object is now; nullopt: the arm does not reach it.
std::optional<Grasp> grasp_now(const Parts& parts, const std::string& object, const Grasp& grasp);
/// Returns the part of a reaching motion that is straight: from the stand-off to the grasp.
MotionSpec reach_along(const Parts& parts, const std::string& object, const Grasp& grasp);
/// Lifts what was grasped straight up. `for_human`: as of pick(); `beside`: a person whose hand may
/// be at the object, empty: nobody.
Routine<Outcome> lift(Parts& parts, const std::string& object, const std::string& for_human,
                      const std::string& beside = {});
/// Approaches an object, closes the hand and lifts the object. `for_human`: as of pick().
Routine<Outcome> try_grasp(Parts& parts, const std::string& object, const std::string& for_human,
                           const Grasp& grasp);
/// Returns the direction in which the hand comes off what it holds or has released, back along the
/// grasp (unit vector, world).
Vector3 retreat_direction(const Parts& parts, const std::string& object);
/// Retreats the opened hand straight from what it has released, back along the grasp or, where the
/// arm cannot, a little beside that direction. `person`: who may be touched,
/// empty: nobody.
Routine<Outcome> retreat(Parts& parts, const std::string& person, const std::string& object);
/// Returns the positions of the fingers that open the hand about what it holds.
Vector opening(const Parts& parts);
/// Returns whether the scene has the object in a hand of the robot.
bool is_held_by_robot(const Parts& parts, const std::string& object);

}  // namespace handsel::manipulation_planner
