// SPDX-License-Identifier: Apache-2.0
// Settings of the server: its file, and the variables of the environment that override it.
#pragma once

#include "common/config/settings/bridge.hpp"
#include "components/bridge/server.hpp"

namespace handsel::bridge {

/// Throws ConfigError for a port or a token that is malformed.
ServerSettings server_settings(const settings::BridgeSettings& settings);

}  // namespace handsel::bridge
