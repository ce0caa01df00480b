// SPDX-License-Identifier: Apache-2.0
// Steps of the actions in which both hands hold one object at once, a closed chain.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "components/manipulation_planner/actions/two_hands.hpp"
#include "components/manipulation_planner/motion/motion_spec.hpp"

namespace handsel::manipulation_planner {

/// How two hands take an object and release it, or why there is no such plan.
struct TogetherPlan {
  Outcome outcome;            ///< whether there is a plan
  RegraspStep first, second;  ///< the grasps of the leading and of the following hand
  RegraspStep down;           ///< the release of both at the goal
};

/// A motion of what both hands hold.
struct TogetherMotion {
  std::string follower;              ///< arm whose hand goes along with that of the arm in use
  std::vector<Pose> T_world_object;  ///< of the object in turn, straight from pose to pose
  MotionSpec spec;                   ///< allowed contacts, speed, and what ends the motion
  bool is_watched{};                 ///< the motion also ends early, by `spec` or `is_over`
  std::function<bool()> is_over{};   ///< ends a watched motion; empty: nothing else does
};

// References must outlive the routines.
/// Asks how two hands take the object and carry it to one of the goals (T_world_object, at most 64,
/// the best first). `use`: of two hands at once.
Routine<TogetherPlan> ask_together(Parts& parts, const std::string& object,
                                   const std::vector<Pose>& goals, HandsUse use);
/// Takes the object with both hands, `two_hand_attempts` times at most.
Routine<Outcome> try_to_take(Parts& parts, const std::string& object, const TogetherPlan& plan);
/// Makes a motion of what both hands hold by the plan; its poses are empty.
TogetherMotion together_motion(const Parts& parts, const std::string& object,
                               const TogetherPlan& plan);
/// Moves what both hands hold; the arm in use leads.
Routine<Outcome> move_together(Parts& parts, const TogetherMotion& motion);
/// Returns a pose that is higher by `by` [m].
Pose raised(Pose T, double by);
/// Opens both hands and moves them off as they came: each hand's stand-off from its grasp is the
/// same wherever the object was put down.
Routine<Outcome> release_both(Parts& parts, const std::string& object, const TogetherPlan& plan);

}  // namespace handsel::manipulation_planner
