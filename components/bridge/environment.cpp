// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/environment.hpp"

#include <charconv>
#include <cstdlib>
#include <string>

#include "common/base/errors.hpp"
#include "components/bridge/commands/command_gate.hpp"

namespace handsel::bridge {
namespace {

/// Returns a variable of the environment; empty if it is not set.
std::string variable(const char* name) {
  const char* text = std::getenv(name);
  return text != nullptr ? text : "";
}

}  // namespace

ServerSettings server_settings(const settings::BridgeSettings& settings) {
  ServerSettings out;
  out.port = static_cast<std::uint16_t>(settings.port);
  if (const std::string value = variable("HANDSEL_WEB_PORT"); !value.empty()) {
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), out.port);
    if (error != std::errc() || end != value.data() + value.size())
      throw ConfigError("HANDSEL_WEB_PORT is \"" + value + "\"; it must be a port, 0..65535");
  }
  if (const std::string address = variable("HANDSEL_WEB_ADDRESS"); !address.empty())
    out.address = address;
  out.token = variable("HANDSEL_WEB_TOKEN");
  if (out.token == "none") out.token.clear();
  check_token(out.token);
  out.max_clients = settings.max_clients;
  out.allowed_origins = settings.allowed_origins;
  return out;
}

}  // namespace handsel::bridge
