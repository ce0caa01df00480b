// The text form of the durable state, with version and checksum. Pure.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "components/supervisor/safety/safety_latches.hpp"

namespace handsel::supervisor {

/// Returns the content of the file: one line "handsel safety state 1 <checksum>", then Protobuf
/// text (safety_state.proto). `written`: system clock, stored as the time from which the ages of
/// lost people count.
std::string write_state(const DurableState& state, Stamp written);

/// Why a text is no durable state, one sentence without the name of the file.
struct StateDamage {
  std::string reason;  ///< for people, no period at the end
};

/// Reads what write_state() made. The ages of lost people are advanced to `now`; a clock that was
/// set back never makes them younger. Refuses another version, a wrong checksum, unknown fields,
/// numbers that are not finite or out of range.
std::variant<DurableState, StateDamage> read_state(const std::string& text, Stamp now);

}  // namespace handsel::supervisor
