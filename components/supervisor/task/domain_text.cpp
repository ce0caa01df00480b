// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/domain_text.hpp"

#include <sstream>

#include "common/base/errors.hpp"

namespace handsel::supervisor {

void throw_at(const std::string& where, const std::string& what) {
  throw ConfigError(where + ": " + what);
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

}  // namespace handsel::supervisor
