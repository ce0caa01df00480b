// SPDX-License-Identifier: Apache-2.0
// Third-party robots, recordings and problems in the folder of the environment's HANDSEL_DATA.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

namespace handsel::test {

/// Returns a file or folder of the reference data; nullopt without HANDSEL_DATA: its tests are
/// skipped. Throws std::runtime_error if HANDSEL_DATA lacks the part, to prevent a silent skip.
inline std::optional<std::filesystem::path> reference_data(const std::string& part) {
  const char* data = std::getenv("HANDSEL_DATA");
  if (data == nullptr || *data == '\0') return std::nullopt;
  std::filesystem::path found = std::filesystem::path(data) / part;
  if (!std::filesystem::exists(found))
    throw std::runtime_error(std::string("HANDSEL_DATA is ") + data + ", and there is no " + part);
  return found;
}

}  // namespace handsel::test
