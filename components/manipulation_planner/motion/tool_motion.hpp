// SPDX-License-Identifier: Apache-2.0
// Straight motions of the tool of the arm in use (chapter section 4.6): up, down, toward a grasp
// and off an object, with the fingers moving along.
#pragma once

#include <optional>

#include "components/manipulation_planner/motion/motion_spec.hpp"

namespace handsel::manipulation_planner {

struct Parts;

/// Returns the node at which the hand of the arm in use has a pose in the world; its elbow is that
/// of `q`, all axes [rad, m], where the arm has one.
TipNode tip_node(const Parts& parts, const Pose& T_world_tool, const Vector& q);
/// Opens a request for the straight motion of the tool from where the arm is to the first goal of
/// `motion`; its fingers move in the last part (setting `closing_part`). nullopt: the arm is not
/// one of shoulder, elbow and wrist, and moves its axes straight instead.
std::optional<TrajectoryRequest> tool_request(Parts& parts, const MotionSpec& motion);

}  // namespace handsel::manipulation_planner
