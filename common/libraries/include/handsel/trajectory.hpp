// SPDX-License-Identifier: Apache-2.0
// Jerk-limited trajectories of several axes (chapter sections 4.2 to 4.4); the library
// handsel::trajectory. Units: rad or m, s. Every function lies in namespace handsel; names in
// namespace detail may change at any time.
//
//   Trajectory, MotionState3, KinematicLimits    cubic segments per axis, states, limits
//   solve()                                      from any state to any state, axes ending together
//   SynchronisedAxes, SynchronisedBatch          the same without allocation: one problem, or many
//   AxisProblem, solve_axis()                    one axis
//   smooth(), straight_motion()                  through waypoints, on straight path segments
//   critical_movement(), stop_trajectory()       jerk-limited stops
//   switch_to()                                  from a state in motion onto another trajectory
//   TimeScaling                                  pause, resume, slower, backwards; 1 kHz cycle
//   cut(), append(), reversed(), stretched()     parts and variants of trajectories
//   approximate_within()                         a trajectory from samples
//   why_not_within(), extremes()                 exact check of limits
//
// Functions that can fail return a reason as one sentence, empty when there is none. Functions
// marked noexcept allocate nothing.
#pragma once

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/min_time.hpp"
#include "common/trajectory/path/approximate.hpp"
#include "common/trajectory/path/segment_table.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/stop.hpp"
#include "common/trajectory/switch.hpp"
#include "common/trajectory/time_scaling.hpp"
#include "common/trajectory/trajectory.hpp"
#include "handsel/version.hpp"
