// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::ros2_lane::Node>(argc, argv, "ros2_lane");
}
