// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::trajectory_planner::Node>(argc, argv, "trajectory_planner");
}
