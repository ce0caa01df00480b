// SPDX-License-Identifier: Apache-2.0
// Robots' configurations, obstacles and people in the lines of batch tools. LineError says what is
// wrong with a line.
#pragma once

#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "deploy/handsel/cli/json_lines.hpp"

namespace handsel::command {

/// Index of the axis.
int axis_of(const RobotModel& robot, const std::string& name);
/// Returns the rest configuration with the values of {"joint": rad, ...}; fixed joints are ignored.
/// `what`: the field that holds them.
Vector configuration_in(const RobotModel& robot, const nlohmann::json& joints, const char* what);
/// The field "obstacles": [{"id", "type": "box|cylinder|sphere", "dims", "pos", "quat_xyzw"}], root
/// frame [m]; none without it.
std::vector<Obstacle> obstacles_in(const nlohmann::json& line);
/// The field "human": {"joints": {name: [x, y, z]}, "gaze": [x, y, z]}; nobody without it.
HumanState people_in(const nlohmann::json& line);
/// The field "weights": {"safety", "visibility", "comfort"}.
CostSettings weights_in(const nlohmann::json& line);

}  // namespace handsel::command
