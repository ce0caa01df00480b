// Robots, recordings and problems made by others, which the environment's HANDSEL_DATA points to.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

namespace handsel::test {

/// A part of them by its path there; nullopt without HANDSEL_DATA: what needs it is left out. Where
/// that is set and has no such part, a check would be left out unseen: throws std::runtime_error.
inline std::optional<std::filesystem::path> reference_data(const std::string& part) {
  const char* data = std::getenv("HANDSEL_DATA");
  if (data == nullptr || *data == '\0') return std::nullopt;
  std::filesystem::path found = std::filesystem::path(data) / part;
  if (!std::filesystem::exists(found))
    throw std::runtime_error(std::string("HANDSEL_DATA is ") + data + ", and there is no " + part);
  return found;
}

}  // namespace handsel::test
