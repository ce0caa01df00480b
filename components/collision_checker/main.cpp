// SPDX-License-Identifier: Apache-2.0
#include "components/collision_checker/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::collision_checker::Node>(argc, argv, "collision_checker");
}
