// SPDX-License-Identifier: Apache-2.0
#include "components/costmap/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::costmap::Node>(argc, argv, "costmap");
}
