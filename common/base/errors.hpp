// SPDX-License-Identifier: Apache-2.0
// Errors by the action they require. Run-time outcomes are values, not exceptions; see Refusal.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace handsel {

/// Bad input or configuration: one sentence naming file, line and key, what is wrong and what would
/// be right. The command turns it into exit code 2.
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Something needed is not there (a file, a DDS peer). The command turns it into exit code 3.
struct MissingError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Why something was turned down: which grasp, path, corner, trajectory or message, and for what
/// reason.
struct Refusal {
  std::string what;    ///< the thing refused, e.g. "grasp 12"
  std::string reason;  ///< one sentence
};
using Refusals = std::vector<Refusal>;

}  // namespace handsel
