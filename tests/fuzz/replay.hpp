// SPDX-License-Identifier: Apache-2.0
// Runs the entry point of a parser on a corpus of files and on their seeded mutations. Files whose
// names begin with good_ must be read, all others refused; a mutation may be either.
// HANDSEL_FUZZ_MUTATIONS sets the number of mutations per file.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace handsel::fuzz {

/// Reads the content of a file called `name`. True: read; false: refused in one sentence. Aborts on
/// anything else.
using EntryPoint = std::function<bool(const std::string& name, const std::string& content)>;

/// True when a refusal is one sentence that begins with the name of the file.
inline bool is_sentence(const std::string& refusal, const std::string& name) {
  constexpr std::size_t kMaxSentence = 700;
  return refusal.find(name) != std::string::npos && refusal.find('\n') == std::string::npos &&
         refusal.size() <= kMaxSentence;
}

inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

inline std::string mutated(std::string text, const std::vector<std::string>& pieces,
                           std::mt19937_64& random) {
  const auto any = [&](std::size_t n) {
    return n == 0 ? 0 : static_cast<std::size_t>(random() % n);
  };
  for (std::size_t i = 1 + any(4); i > 0; --i) {
    const std::size_t at = any(text.size() + 1);
    switch (any(7)) {
      case 0:
        text.resize(at);
        break;
      case 1:
        text.insert(at, pieces[any(pieces.size())]);
        break;
      case 2:
        text.erase(at, any(40));
        break;
      case 3:
        if (at < text.size()) text[at] = static_cast<char>(random());
        break;
      case 4: {  // replaces a digit of a number
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        const std::size_t end = text.find_first_not_of("0123456789.e+-", digit);
        text.replace(digit, (end == std::string::npos ? text.size() : end) - digit,
                     pieces[any(pieces.size())]);
        break;
      }
      case 5:
        for (std::size_t k = at; k < std::min(at + 4, text.size()); ++k)
          text[k] = static_cast<char>(random() % 2 == 0 ? 0xff : 0);
        break;
      default: {
        const std::string piece = text.substr(at, any(200));
        text.insert(any(text.size() + 1), piece);
      }
    }
  }
  return text;
}

/// Pieces that any text parser meets.
inline std::vector<std::string> common_pieces() {
  return {"nan", "inf", "-1e308",   "1e400",      "1e-320",
          "0",   "-1",  "99999999", "4294967296", "99999999999999999999",
          "-",   "\n",  " ",        "\"",         "{",
          "}",   "<",   ">",        "\xff\xfe",   std::string(1, '\0')};
}

/// Replays tests/fuzz/corpus/<folder>.
inline void replay(const std::string& folder, const EntryPoint& read,
                   std::vector<std::string> pieces, int mutations) {
  if (const char* asked = std::getenv("HANDSEL_FUZZ_MUTATIONS")) mutations = std::atoi(asked);
  const auto common = common_pieces();
  pieces.insert(pieces.end(), common.begin(), common.end());
  int files = 0, good = 0, taken = 0, refused = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(HANDSEL_SOURCE_DIR) / "tests/fuzz/corpus" / folder)) {
    const std::string name = entry.path().filename().string(), content = content_of(entry.path());
    const bool expected = name.rfind("good", 0) == 0;
    ++files;
    good += expected;
    EXPECT_EQ(read(name, content), expected) << name;
    std::seed_seq seed(name.begin(), name.end());
    std::mt19937_64 random(seed);
    for (int i = 0; i < mutations; ++i)
      (read(name, mutated(content, pieces, random)) ? taken : refused)++;
  }
  EXPECT_GE(good, 1);
  EXPECT_GE(files - good, 5);
  EXPECT_GT(taken, 0) << "the mutations never reach what follows the parser";
  EXPECT_GT(refused, 0);
}

}  // namespace handsel::fuzz
