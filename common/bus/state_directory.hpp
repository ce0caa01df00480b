// SPDX-License-Identifier: Apache-2.0
// Where processes keep what must outlive them.
#pragma once

#include <filesystem>

namespace handsel {

/// Returns $XDG_STATE_HOME/handsel, ~/.local/state/handsel, or handsel in the temporary directory.
std::filesystem::path state_directory();
/// Returns the folder of what survives the processes of a domain: $HANDSEL_STATE, else
/// state_directory()/domain-N.
std::filesystem::path domain_state_directory(int domain);

}  // namespace handsel
