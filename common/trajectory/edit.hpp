// SPDX-License-Identifier: Apache-2.0
// Cutting, joining and comparing trajectories.
#pragma once

#include "common/trajectory/path/segment_table.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

/// The part in [from, to] (clamped to the trajectory), starting at time 0.
Trajectory cut(const Trajectory&, double from, double to);
/// Appends `next` in time; states are carried on from the end of `first` (the start state of `next`
/// is not used). Same axes.
void append(Trajectory& first, const Trajectory& next);
/// The same motion with all axes split at the same N instants (chapter section 4.2.1).
Trajectory split_alike(const Trajectory&);
/// The same motion begun `by` later [s], standing until then (it must start at rest); by < 0: its
/// first -by seconds are left out.
Trajectory shifted(const Trajectory&, double by);
/// Returns the same path from its end to its beginning, in the same time.
Trajectory reversed(const Trajectory&);
/// Returns the same path, every duration times `factor` > 0: velocities / factor, accelerations /
/// factor^2, jerks / factor^3.
Trajectory stretched(const Trajectory&, double factor);
/// All axes with the segments of the table.
Trajectory to_trajectory(const SegmentTable&);
/// State at the end.
MotionState3 final_state(const Trajectory&);
/// A trajectory of no duration at rest.
Trajectory standing(const Eigen::VectorXd& position);
/// All axes at rest at a position.
MotionState3 rest_state(const Eigen::VectorXd& position);

}  // namespace handsel
