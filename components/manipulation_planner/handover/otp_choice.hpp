// SPDX-License-Identifier: Apache-2.0
// Chooses the object transfer point for the person as they are now, and again when they move.
#pragma once

#include <optional>
#include <string>

#include "components/manipulation_planner/handover/otp_search.hpp"
#include "components/manipulation_planner/motion/motion_spec.hpp"
#include "components/manipulation_planner/routine.hpp"

namespace handsel::manipulation_planner {

struct Parts;

/// Result of a choice.
struct OtpChoice {
  /// Failure: the person is out of sight or the search took too long; good also without poses.
  Outcome outcome;
  OtpSearch search;  ///< poses, best first
  /// Cost of the pose asked about; nullopt: none was, or it is no object transfer point.
  std::optional<double> present_cost;
};

/// A handover that is shifted in place of a search.
struct OtpShift {
  Vector3 p_wanted{Vector3::Zero()};  ///< where the object is wanted, world [m]
  Vector arm_joints;                  ///< axes of the arm at the pose that is shifted [rad]
};

// References must outlive the routines.
/// Searches object transfer points with a person for what is held. `T_world_object`: a pose whose
/// cost is asked, null: none. `shift`: shifts `T_world_object` in place of a search.
Routine<OtpChoice> choose_otp(Parts& parts, const std::string& receiver, const Pose* T_world_object,
                              std::optional<OtpShift> shift = std::nullopt);
/// Reports the pose that a handover is planned for, and the grasp of the person there.
void show(const OtpPose& pose, ActionStatus& action);
/// Reports where the object is now and the easiest grasp of the receiver there: the arm may have
/// reached another pose than was reported. Where none fits, one who has taken hold keeps theirs.
void show_offered(Parts& parts, const std::string& receiver);
/// Sets the goals of a motion to what was found for the receiver as they are now. `hands`: of the
/// receiver, as they were for the search.
void aim_at(const OtpSearch& search, const Person& receiver, const ReceiverHands& hands,
            MotionSpec& motion);
/// Chooses other goals when the receiver has moved or turned so far, or has changed hands, that
/// `goal`, axes of the arm, is no good handover configuration any more. Near the point more must be
/// gained (`commit_distance`). Returns whether it is none, even where there is no other.
Routine<bool> follow_receiver(Parts& parts, MotionSpec& motion, const Vector& goal);
/// Shifts the handover as attention asks for, see TargetShift: the goals of the motion are then the
/// shifted configuration. Returns whether they are. `goal`: axes of the arm that the motion leads
/// to, or that the arm has.
Routine<bool> follow_shift(Parts& parts, MotionSpec& motion, const Vector& goal);

}  // namespace handsel::manipulation_planner
