// SPDX-License-Identifier: Apache-2.0
#include "common/config/text_file.hpp"

#include <fstream>
#include <sstream>

#include "common/base/errors.hpp"
#include "common/config/text_check.hpp"

namespace handsel {
namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

std::string read_text_file(const fs::path& file, std::uintmax_t max_bytes) {
  constexpr std::size_t kMaxShown = 400;  // max length of a path in messages [bytes]
  if (!is_there(file))
    throw MissingError("file " + printable(file.string(), kMaxShown) + " does not exist");
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw ConfigError(file.string() + " is not a file");
  const std::uintmax_t size = fs::file_size(file, error);
  if (size > max_bytes)
    throw ConfigError(file.string() + " has " + std::to_string(size >> 20) + " MB; it may have " +
                      std::to_string(max_bytes >> 20) + " MB");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw ConfigError(file.string() + ": cannot be read; its permissions forbid it");
  std::ostringstream text;
  if (size > 0) text << in.rdbuf();
  if (!in) throw ConfigError(file.string() + ": cannot be read");
  return text.str();
}

}  // namespace handsel
