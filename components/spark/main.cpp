// SPDX-License-Identifier: Apache-2.0
#include "components/spark/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::spark::Node>(argc, argv, "spark");
}
