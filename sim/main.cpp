// SPDX-License-Identifier: Apache-2.0
#include "common/bus/process.hpp"
#include "sim/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::sim::Node>(argc, argv, "sim", handsel::Urgency::control);
}
