// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/node.hpp"

int main(int argc, char** argv) {
  return handsel::run_process<handsel::supervisor::Node>(argc, argv, "supervisor");
}
