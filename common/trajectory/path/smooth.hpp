// SPDX-License-Identifier: Apache-2.0
// From a broken line to soft motion (chapter section 4.4): point-to-point with a stop at each node,
// then the stops smoothed.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/trajectory/trajectory.hpp"

namespace handsel {

/// Factors of the limits of a motion, (0, 1].
struct LimitScale {
  double velocity{1};      ///< of the velocity limits
  double acceleration{1};  ///< of the acceleration limits
  double jerk{1};          ///< of the jerk limits
  bool operator==(const LimitScale&) const = default;
  /// Returns the lower factor of both for each limit.
  LimitScale lower(const LimitScale& other) const;
};

/// Along a straight path segment, up to a place on it, the limits hold times `scale`.
struct LimitZone {
  /// Part of the distance from node to node; grows from zone to zone, the last is 1.
  double end{1};
  LimitScale scale;  ///< within the zone
};
using LimitZones = std::vector<LimitZone>;  ///< of a path segment; none: the limits as they are

/// Rest-to-rest motion on the straight line from one configuration to another, all axes in phase:
/// time-optimal with one zone; with several the acceleration is 0 where one meets the next, and it
/// is never slower than at the lowest scales all along. Own method: the zones make it slow only
/// where it has to be.
Trajectory straight_motion(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                           const KinematicLimits& limits, const LimitZones& speeds = {});

enum class BlendMethod {
  /// Minimum-time transition, three segments an axis, at most the allowed excess (the chapter's
  /// rule).
  three_segment,
  stretched,  ///< the same, made longer; own method: less excess
  /// The next path segment starts before this one has ended; no excess; stays in their plane; own
  /// method.
  overlap,
  stop,  ///< the stop at the node is kept
};
/// Returns the enumerator as text: "three_segment".
const char* name(BlendMethod);

struct BlendReport {
  int node{};                             ///< index into the nodes given
  BlendMethod method{BlendMethod::stop};  ///< transition taken
  double excess{};                        ///< beyond the limits, 0.1 = 10 %; never negative
  double saved{};                         ///< against the stop [s]
  std::string reason;                     ///< why the stop is kept; empty otherwise
};

struct SmoothSettings {
  /// A transition reaches this far from the node, at most to the middle of a path segment [s]; 0
  /// stops. Left out: the transition starts and ends at constant velocity.
  std::optional<double> tau;
  bool three_segments{true}, stretching{true}, overlapping{true};  ///< which transitions are tried
  /// Of three segments (planning limits <= guard limits / 1.1, so the guarantee stands).
  double allowed_excess{0.1};
};

struct SmoothResult {
  Trajectory trajectory;             ///< from the first node to the last, at rest at both
  std::string reason;                ///< why there is none; empty when there is
  double duration_ptp{};             ///< with a stop at each node [s]
  std::vector<BlendReport> corners;  ///< of each inner node, in order; of equal neighbours one
  /// Duration of the motion to each node but the first, with a stop there [s]; 0 for equal
  /// neighbours.
  std::vector<double> segment_durations;
  /// Returns whether there is a trajectory.
  bool ok() const { return reason.empty(); }
};

/// Says whether the robot may follow this piece of trajectory (all axes of the nodes).
using BlendIsFree = std::function<bool(const Trajectory& corner)>;

/// Of the transitions possible at a node the free one that saves the max time. Equal neighbours
/// in `nodes` are taken as one. `speeds`: zones of the path segment to each node but the first, or
/// empty; a transition keeps the lowest scales of all the zones it reaches into (own method: no
/// zone is exceeded).
SmoothResult smooth(const std::vector<Eigen::VectorXd>& nodes, const KinematicLimits& limits,
                    const SmoothSettings& settings = {}, const BlendIsFree& is_free = {},
                    const std::vector<LimitZones>& speeds = {});

}  // namespace handsel
