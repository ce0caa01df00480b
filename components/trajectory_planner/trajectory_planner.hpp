// SPDX-License-Identifier: Apache-2.0
// Plans a jerk-limited trajectory along a path of joints or of the tool (chapter sections 4.4
// to 4.6): smoothing at the comfort limits, reduced along the path by human-aware cost and people's
// behaviour. Pure.
#pragma once

#include <cstdint>

#include "common/messages/planning.hpp"
#include "components/trajectory_planner/cartesian_motion.hpp"
#include "components/trajectory_planner/speed_along.hpp"

namespace handsel::trajectory_planner {

struct Settings {
  /// Step of the checks of blends for forbidden places of cost layers [rad, max norm].
  double blend_step{0.02};
  SpeedSettings speed;  ///< reduction of the speed by people
  /// Settings of tool motions; the allowed excess holds for joint motions as well.
  CartesianSettings tool;
};

struct Result {
  TrajectoryReply reply;   ///< as sent to the client; its reason explains a failure
  std::uint64_t checks{};  ///< number of checked configurations
  double cost{};           ///< max human-aware cost along the path, [0, 1]
  /// Min factor of the comfort velocity limits: request times people.
  double speed_factor{1.0};
  std::vector<LimitZones> speeds;  ///< speed limits of each segment because of people
};

/// Plans the trajectory of a request. `world` and `cost` contain scene, people and attachment,
/// `around` the same people. Never throws for an invalid request: the reply has the reason, and an
/// incomplete tool motion is included up to its end.
Result plan(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost,
            const Surroundings& around, const TrajectoryRequest& request, const Settings& settings);

}  // namespace handsel::trajectory_planner
