// SPDX-License-Identifier: Apache-2.0
// Age of set-points at arrival in simulated time.
#pragma once

#include <optional>

#include "common/bus/intake.hpp"
#include "common/messages/robot.hpp"
#include "sim/time_keeper.hpp"

namespace handsel::sim {

/// Age of the set-points of one sender at a time. Own method.
class SetPointAge {
 public:
  /// Returns the age at arrival; in simulated time once `keeper` has started that, for the clock of
  /// the simulator passes on while simulated time halts.
  Duration of(const JointCommand& command, const Receipt& receipt,
              const std::optional<TimeKeeper>& keeper) {
    if (!keeper || keeper->grant_number() == 0) return receipt.age;
    if (receipt.writer != sender_) ages_ = {};
    sender_ = receipt.writer;
    return ages_.update(command.stamp, keeper->time());
  }

 private:
  AgeEstimator ages_;
  std::uint64_t sender_{};  // writer of the newest set-point
};

}  // namespace handsel::sim
