// SPDX-License-Identifier: Apache-2.0
// Which Go is accepted: one issued from the durable safety state, not from an older one, and newer
// than this controller's start. Pure.
#pragma once

#include <cstdint>

#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"

namespace handsel::trajectory_controller {

/// Why a Go is not taken.
enum class GoRefusal : std::uint8_t {
  none,
  no_state,     ///< it was issued from no safety state (revision 0)
  older_state,  ///< its supervisor knows an older safety state than one received before
  older_epoch,  ///< one with a newer epoch has been received
};

/// Returns one sentence; empty for none.
const char* text_of(GoRefusal refusal);

class GoGate {
 public:
  /// Takes a Go, or says why not; one from no state or an older one withdraws the permission. The
  /// first one received permits no motion, whatever its content: it may have been issued before
  /// this process started.
  GoRefusal receive(const Go& go) noexcept;
  /// Notes whether the safety state is paused, at fault or waiting for a person.
  void receive(const SafetyState& state) noexcept;
  /// Notes a protective, user or emergency stop: from then on only a Go from a newer state permits
  /// motion, as a person makes it.
  void receive(DriveMode mode) noexcept;

  /// Returns whether the Go in force permits motion.
  bool allowed() const noexcept { return allowed_ && !waits_; }
  /// Returns whether motion waits for a person.
  bool awaits_person() const noexcept;
  /// Returns the epoch that a Go must exceed because it was received first; the largest number
  /// before any was received.
  std::uint64_t first_epoch() const noexcept { return first_epoch_; }
  /// Result of the last receive() of a Go; none before the first.
  GoRefusal last_refusal() const noexcept { return last_refusal_; }

 private:
  bool received_{false}, allowed_{false}, awaits_person_{false};
  bool waits_{false};  ///< a stop was seen; a Go from a state newer than stop_revision_ ends it
  std::uint64_t epoch_{}, first_epoch_{~std::uint64_t{0}}, revision_{}, stop_revision_{};
  DriveMode drive_{DriveMode::enabled};
  GoRefusal last_refusal_{GoRefusal::none};
};

}  // namespace handsel::trajectory_controller
