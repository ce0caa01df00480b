// When a Go is sent: on every change, and repeated at the Go rate. Pure.
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/time.hpp"
#include "common/messages/execution.hpp"

namespace handsel::supervisor {

/// Repeats the motion permission in force.
class GoSender {
 public:
  /// `period`: between two Go without a change [s].
  explicit GoSender(double period) : period_(period) {}

  /// Returns the Go if it has to be sent now.
  std::optional<Go> step(const Go& go, TimePoint now);
  /// Motion-permission counter of the Go sent last; 0: none was sent.
  std::uint64_t epoch() const { return sent_.epoch; }

 private:
  double period_;
  Go sent_;
  TimePoint sent_at_{};
};

}  // namespace handsel::supervisor
