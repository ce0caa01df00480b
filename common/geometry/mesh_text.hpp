// SPDX-License-Identifier: Apache-2.0
// Lines, words and numbers of a mesh file in text, and the refusals that name the line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/errors.hpp"

namespace handsel::mesh {

inline constexpr std::uintmax_t kMaxBytes = 64u << 20;
inline constexpr std::size_t kMaxTriangles = 500'000;
/// Each triangle has three of its own at most.
inline constexpr std::size_t kMaxVertices = 3 * kMaxTriangles;
inline constexpr std::size_t kMaxFaceVertices =
    1000;                                          ///< of one face: splitting it costs their square
inline constexpr std::size_t kMaxLine = 1u << 16;  ///< [bytes]
inline constexpr double kLargestCoordinate = 1e9;  ///< in the unit of the file

/// Returns the number that `word` is, nothing where it is none, not finite or beyond
/// kLargestCoordinate.
std::optional<double> coordinate_of(std::string_view word);
/// Returns the whole number that `word` is.
std::optional<long long> whole_of(std::string_view word);

/// Reads a text line by line, each line word by word.
class Lines {
 public:
  Lines(const std::filesystem::path& file, std::string_view text) : file_(file), rest_(text) {}

  /// False at the end. Throws ConfigError for a line of more than kMaxLine bytes.
  bool next();
  /// The next word of the line; empty at its end.
  std::string_view word();
  /// The next word as a coordinate; throws ConfigError naming `what` where it is none.
  double coordinate(const char* what);
  /// Whether a backslash at its end joins the line with the next one.
  bool is_continued() const;
  /// The text behind the line.
  std::string_view rest() const { return rest_; }
  std::size_t number() const { return number_; }  ///< of the line, from 1; 0 before the first
  /// Throws ConfigError "file:line: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const std::filesystem::path& file_;
  std::string_view rest_, line_;
  std::size_t number_{0};  // of the line, from 1
};

/// `word` for one line of an error: cut to 40 bytes, printable.
std::string shown(std::string_view word);

}  // namespace handsel::mesh
