// SPDX-License-Identifier: Apache-2.0
#include "common/bus/process_state.hpp"

#include <fstream>
#include <string>

namespace handsel {

char process_state(pid_t pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  std::getline(in, text);
  const std::size_t name_ends = text.rfind(')');  // the name may contain any character
  return name_ends == std::string::npos || name_ends + 2 >= text.size() ? 'X' : text[name_ends + 2];
}

}  // namespace handsel
