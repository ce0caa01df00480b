// From a broken line of joints or of the tool to soft motion that people find comfortable (chapter
// sections 4.4 to 4.6): smoothing at the comfort limits, lowered along the path by what it costs
// people and by what they do. Pure.
#pragma once

#include <cstdint>

#include "common/messages/planning.hpp"
#include "components/trajectory_planner/cartesian_motion.hpp"
#include "components/trajectory_planner/speed_along.hpp"

namespace handsel::trajectory_planner {

struct Settings {
  /// Blends are checked this often for places outside layers forbid [rad, max norm].
  double blend_step{0.02};
  SpeedSettings speed;  ///< how people lower the speed along the path
  /// Of motions of the tool; its allowed excess holds for those of joints too.
  CartesianSettings tool;
};

struct Result {
  TrajectoryReply reply;   ///< as sent to the client; its reason says why there is no trajectory
  std::uint64_t checks{};  ///< configurations checked
  double cost{};           ///< largest human-aware cost along the line, [0, 1]
  /// Least factor of the comfort velocity limits: asked for x because of people.
  double speed_factor{1.0};
  std::vector<LimitZones> speeds;  ///< of each segment, because of people
};

/// `world` and `cost` hold scene, people and attachment; `around` the same people. Never throws for
/// a bad request: the reply says why not, and as far as a motion of the tool goes it is there.
Result plan(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost,
            const Surroundings& around, const TrajectoryRequest& request, const Settings& settings);

}  // namespace handsel::trajectory_planner
