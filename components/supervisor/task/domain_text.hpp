// SPDX-License-Identifier: Apache-2.0
// Helpers for the text of a task domain: words, lists for people, errors with their place. Pure.
#pragma once

#include <string>
#include <vector>

namespace handsel::supervisor {

/// Throws ConfigError "where: what". `where`: file, line and field, see TextPlace::of().
[[noreturn]] void throw_at(const std::string& where, const std::string& what);

/// Returns the words of a text, which white space separates.
std::vector<std::string> words(const std::string& text);

/// Returns the names of the entries, separated by ", ". `name`: gives the name of one entry.
template <class List, class Name>
std::string listed(const List& list, Name name) {
  std::string out;
  for (const auto& entry : list) out += (out.empty() ? "" : ", ") + std::string(name(entry));
  return out;
}

}  // namespace handsel::supervisor
