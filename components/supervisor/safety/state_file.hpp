// SPDX-License-Identifier: Apache-2.0
// The text form of the durable state, with version and checksum. Pure.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "components/supervisor/safety/safety_latches.hpp"

namespace handsel::supervisor {

/// Returns the content of the file: one line "handsel safety state 1 <checksum>", then Protobuf
/// text (safety_state.proto). `written`: system clock, stored as the reference of the ages of lost
/// people.
std::string write_state(const DurableState& state, Stamp written);

/// Why a text is not a durable state, one sentence without the name of the file.
struct StateDamage {
  std::string reason;  ///< without a period at the end
};

/// Reads the output of write_state(). Advances the ages of lost people to `now`; a clock that was
/// set back never reduces them. Refuses another version, a wrong checksum, unknown fields, and
/// numbers that are not finite or out of range.
std::variant<DurableState, StateDamage> read_state(const std::string& text, Stamp now);

}  // namespace handsel::supervisor
