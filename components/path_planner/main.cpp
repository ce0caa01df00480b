// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::path_planner::Node>(argc, argv, "path_planner");
}
