// SPDX-License-Identifier: Apache-2.0
// The arms of a robot with their hands: the one of the groups "arm" and "hand", and further ones
// its description names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel {

struct Manipulator {
  std::string name;        ///< of the arm's group
  const Group* arm{};      ///< of the robot
  const Group* fingers{};  ///< of the robot; null: the hand has no axes
  std::string hand;        ///< name or file of its hand description
  int palm{-1};            ///< link: the tip of the arm, hand frame
};

/// The hands of the robot, found from its links: the first is that of the tool link with the groups
/// "arm" and "hand", where there are those; then each group without a tip_link of its own that
/// hangs on the tip_link of another. `Manipulator::hand` is that of the robot's description for the
/// first and empty for the others. `robot` must outlive what is returned.
std::vector<Manipulator> hands_of(const RobotModel& robot);
/// Index of the hand whose group is `fingers`, the first where it is empty; -1 if there is none.
int hand_index(const std::vector<Manipulator>& hands, const std::string& fingers);

/// `description`: the file `robot` was loaded from; `robot` must outlive what is returned.
/// ConfigError naming file and field when an arm's groups are not there, or the arm has no
/// tip_link.
std::vector<Manipulator> manipulators(const std::filesystem::path& description,
                                      const RobotModel& robot);

}  // namespace handsel
