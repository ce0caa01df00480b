// SPDX-License-Identifier: Apache-2.0
// A small robot for tests: a fixed post and three 0.4 m links turning about z, written as a URDF.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include "common/model/robot_model.hpp"

namespace handsel::test {

inline RobotModel planar_arm() {
  std::string text =
      R"(<?xml version="1.0"?><robot name="planar"><link name="post"><collision>
<origin xyz="0 0 -0.3"/>
<geometry><box size="0.1 0.1 0.4"/></geometry></collision></link>)";
  for (int i = 1; i <= 3; ++i) {
    const std::string n = std::to_string(i),
                      parent = i == 1 ? "post" : "link" + std::to_string(i - 1);
    text += "<link name=\"link" + n +
            R"("><collision><origin xyz="0.2 0 0"/><geometry><box size="0.36 0.06 0.06"/></geometry>
</collision></link>
<joint name="joint)" +
            n + R"(" type="revolute"><parent link=")" + parent + "\"/><child link=\"link" + n +
            "\"/><origin xyz=\"" + (i == 1 ? "0" : "0.4") +
            R"( 0 0"/><axis xyz="0 0 1"/><limit lower="-2.9" upper="2.9" effort="10" velocity="1"/>
</joint>)";
  }
  text += "</robot>";
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("planar_arm_" + std::to_string(::getpid()) + ".urdf");
  std::ofstream(file) << text;
  RobotModel model = RobotModel::load_urdf(file);
  std::filesystem::remove(file);
  return model;
}

}  // namespace handsel::test
