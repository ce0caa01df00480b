// SPDX-License-Identifier: Apache-2.0
// A copy of the project's settings with single values changed.
#pragma once

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>

#include "common/config/resources.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::test {

class EditedSettings {
 public:
  EditedSettings() {
    std::filesystem::copy(resource("config"), folder(),
                          std::filesystem::copy_options::recursive |
                              std::filesystem::copy_options::overwrite_existing);
  }
  /// Sets a number or word at the top level of a file; throws unless the file has the key once.
  void set(const std::string& file, const std::string& key, const std::string& value) {
    const std::filesystem::path path = folder() / file;
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    const std::regex line("(^|\\n)" + key + ": *[^ \\n]+");
    const std::string before = text.str();
    if (std::distance(std::sregex_iterator(before.begin(), before.end(), line), {}) != 1)
      throw std::runtime_error(path.string() + " does not have " + key + " once");
    std::ofstream(path) << std::regex_replace(before, line, "$1" + key + ": " + value);
  }
  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

}  // namespace handsel::test
