// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>

#include "common/bus/process.hpp"
#include "components/bridge/node.hpp"

int main(int argc, char** argv) {
  setpriority(PRIO_PROCESS, 0, 2);  // inherited by every thread started from here
  return handsel::run_process<handsel::bridge::Node>(argc, argv, "bridge");
}
