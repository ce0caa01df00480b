// SPDX-License-Identifier: Apache-2.0
#include "common/bus/state_directory.hpp"

#include <cstdlib>
#include <string>

#include "common/bus/dds/dds_defaults.hpp"

namespace handsel {
namespace {

const char* environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0' ? value : nullptr;
}

}  // namespace

std::filesystem::path state_directory() {
  if (const char* state = environment("XDG_STATE_HOME"))
    return std::filesystem::path(state) / "handsel";
  if (const char* home = environment("HOME"))
    return std::filesystem::path(home) / ".local/state/handsel";
  return std::filesystem::temp_directory_path() / "handsel";
}

std::filesystem::path domain_state_directory(int domain) {
  if (const char* state = environment("HANDSEL_STATE")) return state;
  const std::string name = system_name();
  return state_directory() /
         ("domain-" + std::to_string(domain) + (name.empty() ? "" : "-" + name));
}

}  // namespace handsel
