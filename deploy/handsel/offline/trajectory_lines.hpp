// SPDX-License-Identifier: Apache-2.0
// What `handsel trajectory` answers to a line, and trajectories as JSON. LineError says what is
// wrong with a line.
#pragma once

#include <nlohmann/json.hpp>

#include "common/trajectory/trajectory.hpp"
#include "deploy/handsel/cli/json_lines.hpp"

namespace handsel::command {

/// [{"p0", "v0", "a0", "segments": [[duration, jerk], ...]}, ...], an object an axis.
nlohmann::json axes_of(const Trajectory&);
/// The trajectory in the field "axes".
Trajectory trajectory_in(const nlohmann::json& line);

/// Answers a line of `trajectory solve`: minimum-time motion from p0, v0, a0 to pf, vf, af.
nlohmann::json solve_line(const nlohmann::json& line);
/// Answers a line of `trajectory smooth`: jerk-limited motion through "nodes", with what each
/// corner saved.
nlohmann::json smooth_line(const nlohmann::json& line);
/// Answers a line of `trajectory sample`: positions, velocities and accelerations every `period`
/// [s] and at the end. Throws LineError for more than a million samples.
nlohmann::json sample_line(const nlohmann::json& line, double period);

}  // namespace handsel::command
