// SPDX-License-Identifier: Apache-2.0
// Models of robots, hands, objects and people; the library handsel::model. Units: rad or m.
//
//   RobotModel          a robot from its description or URDF: forward and inverse kinematics,
//                       Jacobian, limits
//   find_file()         the file of a robot, hand or object by its name
//   ObjectModel         an object from its description
//   robot_capsules(), separation()    the robot as capsules, and its distance to people
#pragma once

#include "common/base/errors.hpp"
#include "common/config/search_path.hpp"
#include "common/model/object_model.hpp"
#include "common/model/robot_capsules.hpp"
#include "common/model/robot_model.hpp"
#include "handsel/version.hpp"
