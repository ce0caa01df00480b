// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/output/command_report.hpp"

namespace handsel::trajectory_controller {

void CommandReport::accept(std::uint64_t id) {
  accept_stop(id);
  cycles_left_ = 0;
}

void CommandReport::accept_stop(std::uint64_t id) {
  accepted_ = id;
  refused_ = false;
  reason_.clear();
}

void CommandReport::refuse(std::uint64_t id, const std::string& reason, int cycles) {
  refused_ = true;
  refused_id_ = id;
  cycles_left_ = cycles;
  reason_ = "trajectory " + std::to_string(id) + ": " + reason;
}

void CommandReport::refuse_hand(std::uint64_t id, const std::string& reason) {
  reason_ = "hand command " + std::to_string(id) + ": " + reason;
}

void CommandReport::step() noexcept {
  if (cycles_left_ == 0 || --cycles_left_ > 0) return;
  refused_ = false;
  reason_.clear();
}

}  // namespace handsel::trajectory_controller
