// SPDX-License-Identifier: Apache-2.0
// The other robots of a scenario.
#pragma once

#include <vector>

#include "common/config/schema/scenario.pb.h"
#include "sim/robot/other_robot.hpp"

namespace handsel::sim {

/// Reads the other robots. Throws ConfigError or MissingError naming what is wrong: a name that is
/// empty or taken, a robot or joint that does not exist, a position outside the bounds of its axis.
std::vector<OtherRobotMotion> read_other_robots(const config::Scenario& scenario);

}  // namespace handsel::sim
