// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::manipulation_planner::Node>(argc, argv,
                                                                   "manipulation_planner");
}
