// SPDX-License-Identifier: Apache-2.0
// What the simulator would refuse, before anything is started.
#pragma once

#include "deploy/handsel/system/system_options.hpp"

namespace handsel {

/// Sets the scene up as the simulator does, unless the options leave the simulator out. Throws
/// ConfigError / MissingError.
void check_scene(const SystemOptions& options);

}  // namespace handsel
