// SPDX-License-Identifier: Apache-2.0
#include "common/bus/process.hpp"
#include "components/trajectory_controller/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::trajectory_controller::Node>(
      argc, argv, "trajectory_controller", handsel::Urgency::control);
}
