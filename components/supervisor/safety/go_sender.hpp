// SPDX-License-Identifier: Apache-2.0
// Sends a Go after every change, and repeats it at the Go rate. Pure.
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/time.hpp"
#include "common/messages/execution.hpp"

namespace handsel::supervisor {

/// Repeats the present motion permission.
class GoSender {
 public:
  /// `period`: time between two Go without a change [s].
  explicit GoSender(double period) : period_(period) {}

  /// Returns the Go if it must be sent now.
  std::optional<Go> step(const Go& go, TimePoint now);
  /// Returns the epoch of the last Go; 0: none was sent.
  std::uint64_t epoch() const { return sent_.epoch; }

 private:
  double period_;
  Go sent_;
  TimePoint sent_at_{};
};

}  // namespace handsel::supervisor
