// From a broken line to soft motion that people find comfortable: smoothing (chapter section 4.4) at the comfort limits, lowered where the
// way costs people much (ours). Pure.
#pragma once

#include <cstdint>

#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "common/messages/planning.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::trajectory_planner {

struct Settings {
  double corner_step{0.02};        ///< corners are checked for collision this often [rad, max norm]
  double cost_step{0.1};           ///< the human-aware cost is taken this often along the line [rad, max norm]
  double least_speed_factor{0.5};  ///< of the velocity limits where the cost is 1; 1 where it is 0, linear between
  double allowed_excess{0.1};      ///< of three segments beyond the planning limits; guard limits are >= 1.1 x these
};

struct Result {
  TrajectoryReply reply;
  std::uint64_t checks{};    ///< configurations judged
  double cost{};             ///< largest human-aware cost along the line, [0, 1]
  double speed_factor{1.0};  ///< on the comfort velocity limits: asked for x because of people
};

/// `world` and `cost` hold scene, people and attachment. Never throws for a bad request: the reply says why not.
Result plan(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost, const TrajectoryRequest& request,
            const Settings& settings);

}  // namespace handsel::trajectory_planner
