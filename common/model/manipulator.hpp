// The arms of a robot with their hands: the one of the groups "arm" and "hand", and further ones its description names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel {

struct Manipulator {
  std::string name;    ///< of the arm's group
  const Group* arm{};  ///< of the robot
  const Group* fingers{};
  std::string hand;  ///< name or file of its hand description
  int palm{-1};      ///< link: the tip of the arm, hand frame
};

/// `description`: the file `robot` was loaded from; `robot` must outlive what is returned. ConfigError naming file and field when an arm's
/// groups are not there, or the arm has no tip_link.
std::vector<Manipulator> manipulators(const std::filesystem::path& description, const RobotModel& robot);

}  // namespace handsel
