// From a broken line of joints or of the tool to soft motion that people find comfortable (chapter sections 4.4 to 4.6): smoothing at the
// comfort limits, lowered along the way by what it costs people and by what they do. Pure.
#pragma once

#include <cstdint>

#include "common/messages/planning.hpp"
#include "components/trajectory_planner/cartesian_motion.hpp"
#include "components/trajectory_planner/speed_along.hpp"

namespace handsel::trajectory_planner {

struct Settings {
  double corner_step{0.02};  ///< places outside layers forbid are looked for this often in corners [rad, max norm]
  SpeedSettings speed;
  CartesianSettings tool;  ///< of motions of the tool; its allowed excess holds for those of joints too
};

struct Result {
  TrajectoryReply reply;
  std::uint64_t checks{};          ///< configurations judged
  double cost{};                   ///< largest human-aware cost along the line, [0, 1]
  double speed_factor{1.0};        ///< least share of the comfort velocity limits: asked for x because of people
  std::vector<SpeedZones> speeds;  ///< of each leg, because of people
};

/// `world` and `cost` hold scene, people and attachment; `around` the same people. Never throws for a bad request: the reply says why not,
/// and as far as a motion of the tool goes it is there.
Result plan(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost, const Surroundings& around,
            const TrajectoryRequest& request, const Settings& settings);

}  // namespace handsel::trajectory_planner
