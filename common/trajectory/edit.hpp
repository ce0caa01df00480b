// Cutting, joining and comparing trajectories.
#pragma once

#include "common/trajectory/trajectory.hpp"

namespace handsel {

/// The part in [from, to] (clamped to the trajectory), starting at time 0.
Trajectory cut(const Trajectory&, double from, double to);
/// Appends `next` in time; states are carried on from the end of `first` (the start state of `next` is not used). Same axes.
void append(Trajectory& first, const Trajectory& next);
/// The same motion with all axes split at the same N instants (chapter section 4.2.1).
Trajectory split_alike(const Trajectory&);
/// State at the end.
MotionState3 final_state(const Trajectory&);
/// A trajectory of no duration at rest.
Trajectory standing(const Eigen::VectorXd& position);
/// All axes at rest at a position.
MotionState3 rest_state(const Eigen::VectorXd& position);

}  // namespace handsel
