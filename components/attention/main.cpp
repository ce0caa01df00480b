// SPDX-License-Identifier: Apache-2.0
#include "common/bus/process.hpp"
#include "components/attention/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::attention::Node>(argc, argv, "attention");
}
