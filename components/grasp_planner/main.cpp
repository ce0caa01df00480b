// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::grasp_planner::Node>(argc, argv, "grasp_planner");
}
