// SPDX-License-Identifier: Apache-2.0
#include "common/config/nearest_name.hpp"

#include <algorithm>
#include <numeric>

namespace handsel {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    row[0] = i + 1;
    for (std::size_t k = 0; k < b.size(); ++k) {
      row[k + 1] = std::min({last[k] + (a[i] == b[k] ? 0 : 1), last[k + 1] + 1, row[k] + 1});
      if (i > 0 && k > 0 && a[i] == b[k - 1] && a[i - 1] == b[k])
        row[k + 1] = std::min(row[k + 1], before[k - 1] + 1);
    }
    before = last;
    last = row;
  }
  return last.back();
}

std::vector<std::string> nearest_names(const std::string& name,
                                       const std::vector<std::string>& names, std::size_t count) {
  constexpr std::size_t kMaxCompared = 200;  // longer words are no typing errors [bytes]
  std::vector<std::pair<std::size_t, std::string>> similar;
  if (name.empty() || name.size() > kMaxCompared) return {};
  for (const std::string& known : names) {
    if (known.size() > kMaxCompared) continue;
    const std::size_t distance = edit_distance(name, known);
    const std::size_t allowed = std::max<std::size_t>(1, std::max(name.size(), known.size()) / 3);
    if (distance <= allowed || known.starts_with(name)) similar.emplace_back(distance, known);
  }
  std::sort(similar.begin(), similar.end());
  similar.erase(std::unique(similar.begin(), similar.end()), similar.end());
  std::vector<std::string> out;
  for (std::size_t i = 0; i < std::min(count, similar.size()); ++i)
    out.push_back(similar[i].second);
  return out;
}

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace handsel
