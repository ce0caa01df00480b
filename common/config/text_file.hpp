// SPDX-License-Identifier: Apache-2.0
// Whole files into memory, with a limit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace handsel {

/// Of a description, settings or a story, far more than any of them has.
inline constexpr std::uintmax_t kMaxTextBytes = 4u << 20;

/// Returns the content of a file. Throws MissingError where there is none, ConfigError naming the
/// file when the path is a folder or another thing that is no file, when the file cannot be read,
/// or when it is larger than `max_bytes`.
std::string read_text_file(const std::filesystem::path& file,
                           std::uintmax_t max_bytes = kMaxTextBytes);

/// Whether something is at the path; false also for a path that cannot be, as one with a name of
/// 300 characters.
bool is_there(const std::filesystem::path& path);

}  // namespace handsel
