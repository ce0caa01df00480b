// From a broken line to soft motion (chapter section 4.4): point-to-point with a stop at each node, then the stops smoothed.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/trajectory/trajectory.hpp"

namespace handsel {

/// Along a straight leg, up to a place on it, this share of the velocity limits holds.
struct SpeedZone {
  double end{1};    ///< share of the way from node to node; grows from zone to zone, the last is 1
  double share{1};  ///< (0, 1]
};
using SpeedZones = std::vector<SpeedZone>;  ///< of a leg; none: the limits as they are

/// Rest-to-rest motion on the straight line from one configuration to another, all axes in phase: time-optimal with one zone; with several
/// the acceleration is 0 where one meets the next, and it is never slower than at the lowest share all along (ours).
Trajectory straight_motion(const Eigen::VectorXd& from, const Eigen::VectorXd& to, const KinematicLimits& limits,
                           const SpeedZones& speeds = {});

enum class CornerMethod {
  three_segment,  ///< minimum-time transition, three segments an axis, at most the allowed excess (the chapter's rule)
  stretched,      ///< the same, made longer (ours)
  overlap,        ///< the second leg starts before the first has ended; no excess; stays in the plane of the legs (ours)
  stop,           ///< the stop at the node is kept
};
const char* name(CornerMethod);

struct CornerReport {
  int node{};  ///< index into the nodes given
  CornerMethod method{CornerMethod::stop};
  double excess{};     ///< beyond the limits, 0.1 = 10 %; never negative
  double saved{};      ///< against the stop [s]
  std::string reason;  ///< why the stop is kept; empty otherwise
};

struct SmoothSettings {
  std::optional<double> tau;  ///< transition reaches this far from the node, at most to the middle of a leg [s]; 0 stops.
                              ///< Left out: the transition starts and ends where the legs cruise.
  bool three_segments{true}, stretching{true}, overlapping{true};  ///< which transitions are tried
  double allowed_excess{0.1};  ///< of three segments (planning limits <= guard limits / 1.1, so the guarantee stands)
};

struct SmoothResult {
  Trajectory trajectory;
  std::string reason;     ///< why there is none; empty when there is
  double duration_ptp{};  ///< with a stop at each node [s]
  std::vector<CornerReport> corners;
  std::vector<double> legs;  ///< duration of the motion to each node but the first, with a stop there [s]; 0 for equal neighbours
  bool ok() const { return reason.empty(); }
};

/// Says whether the robot may follow this piece of trajectory (all axes of the nodes).
using CornerIsFree = std::function<bool(const Trajectory& corner)>;

/// Of the transitions possible at a node the one that saves most time and is free. Equal neighbours in `nodes` are taken as one. `speeds`:
/// zones of the leg to each node but the first, or empty; a transition keeps the lowest share of all the zones it reaches into (ours).
SmoothResult smooth(const std::vector<Eigen::VectorXd>& nodes, const KinematicLimits& limits, const SmoothSettings& settings = {},
                    const CornerIsFree& is_free = {}, const std::vector<SpeedZones>& speeds = {});

}  // namespace handsel
