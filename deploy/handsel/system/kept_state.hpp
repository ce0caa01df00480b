// SPDX-License-Identifier: Apache-2.0
// The safety state over the life of a whole system: kept when the system is killed, forgotten when
// the system ends in order.
#pragma once

#include <string>

#include "components/supervisor/safety/state_store.hpp"

namespace handsel {

/// Returns what of a state stands and how a person releases each part, one sentence; empty: nothing
/// stands.
std::string standing(const supervisor::DurableState& state);

/// To start a system is an act of a person: after an orderly end the next one starts fresh. A
/// system that was killed leaves its latches, and the next one says so.
class KeptState {
 public:
  /// `folder`: of the domain; empty: no supervisor runs here. Prints what stands from a system that
  /// did not end in order.
  explicit KeptState(const std::filesystem::path& folder);
  /// The system has ended in order, with all its processes.
  ~KeptState();
  KeptState(const KeptState&) = delete;
  KeptState& operator=(const KeptState&) = delete;

 private:
  std::optional<supervisor::StateStore> store_;
};

}  // namespace handsel
