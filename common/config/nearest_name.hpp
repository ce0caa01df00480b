// SPDX-License-Identifier: Apache-2.0
// Which names a mistyped one may have meant.
#pragma once

#include <string>
#include <vector>

namespace handsel {

/// Returns how many letters must be changed, added, left out or exchanged with the next one between
/// two words (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b);

/// Returns up to `count` of `names`, the most similar to `name` first: those that differ in at most
/// a third of the letters, or begin with `name`. Empty: none is similar.
std::vector<std::string> nearest_names(const std::string& name,
                                       const std::vector<std::string>& names,
                                       std::size_t count = 3);

/// Returns the names with commas between them.
std::string joined(const std::vector<std::string>& names);

}  // namespace handsel
