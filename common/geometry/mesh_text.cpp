// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/mesh_text.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>

namespace handsel::mesh {

std::optional<double> coordinate_of(std::string_view word) {
  if (word.size() > 1 && word[0] == '+') word.remove_prefix(1);
  double value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range)
    value = std::strtod(std::string(word).c_str(), nullptr);  // underflow or infinite
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  if (!std::isfinite(value) || std::abs(value) > kLargestCoordinate) return std::nullopt;
  return value;
}

std::optional<long long> whole_of(std::string_view word) {
  long long value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::string shown(std::string_view word) {
  constexpr std::size_t kShown = 40;
  std::string out = "\"";
  for (const char c : word.substr(0, kShown)) out += c >= 32 && c < 127 ? c : '?';
  return out + (word.size() > kShown ? "...\"" : "\"");
}

bool Lines::next() {
  if (rest_.empty()) return false;
  ++number_;
  const std::size_t end = rest_.find('\n');
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (line_.size() > kMaxLine)
    fail("a line of " + std::to_string(line_.size()) + " bytes; a line may have " +
         std::to_string(kMaxLine));
  return true;
}

bool Lines::is_continued() const { return line_.ends_with('\\') || line_.ends_with("\\\r"); }

std::string_view Lines::word() {
  constexpr std::string_view kBlank = " \t\r\f\v";
  line_.remove_prefix(std::min(line_.find_first_not_of(kBlank), line_.size()));
  const std::string_view word = line_.substr(0, line_.find_first_of(kBlank));
  line_.remove_prefix(word.size());
  return word;
}

double Lines::coordinate(const char* what) {
  const std::string_view found = word();
  const auto value = coordinate_of(found);
  if (!value) {
    if (found.empty()) fail(std::string("the line ends where ") + what + " should be");
    fail(std::string(what) + " is " + shown(found) + ", not finite or no number up to 1e9");
  }
  return *value;
}

void Lines::fail(const std::string& what) const {
  throw ConfigError(file_.string() + ":" + std::to_string(number_) + ": " + what);
}

}  // namespace handsel::mesh
