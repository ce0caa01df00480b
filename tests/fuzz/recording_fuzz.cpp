// SPDX-License-Identifier: Apache-2.0
// Fuzzes motion recordings of users. For libFuzzer: clang++ -fsanitize=fuzzer,address with
// the sources of sim/recording and sim/bvh; here a corpus and its seeded mutations are replayed:
// every input is read or refused in one sentence, without a crash.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/base/errors.hpp"
#include "sim/recordings/recording.hpp"

namespace handsel {

/// Returns whether the text was read. Aborts on an invalid result or a refusal that is no sentence.
bool read_fuzzed(bool bvh, std::string_view text) {
  try {
    const sim::Recording recording =
        bvh ? sim::parse_bvh_recording(text, "input") : sim::parse_body_csv(text, "input");
    if (recording.frames.size() < 2 || !(recording.rate > 0)) std::abort();
    for (const sim::BodyPoints& frame : recording.frames)
      for (const Vector3& p : frame)
        if (!p.allFinite()) std::abort();
    const sim::Recording other = sim::retarget(recording, 1.6);
    for (const Vector3& p : other.frames.back())
      if (!p.allFinite()) std::abort();
    return true;
  } catch (const ConfigError& error) {
    const std::string what = error.what();
    if (what.rfind("input:", 0) != 0 || what.find('\n') != std::string::npos || what.size() > 400)
      std::abort();
    return false;
  }
}

}  // namespace handsel

#ifdef HANDSEL_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  handsel::read_fuzzed(data[0] & 1, {reinterpret_cast<const char*>(data) + 1, size - 1});
  return 0;
}
#else
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

namespace handsel {
namespace {

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::string mutated(std::string text, std::mt19937_64& random) {
  const auto any = [&](std::size_t n) {
    return n == 0 ? 0 : static_cast<std::size_t>(random() % n);
  };
  static const char* const kPieces[] = {"nan",
                                        "-1e308",
                                        "0",
                                        "{",
                                        "}",
                                        "JOINT",
                                        "End Site",
                                        "CHANNELS 6",
                                        "Frames: 99999999",
                                        "\n",
                                        ",",
                                        ",,",
                                        "inf",
                                        "Xrotation",
                                        "\xff\xfe",
                                        "1e-320",
                                        "99999999999999999999",
                                        "-",
                                        "ROOT a",
                                        "MOTION"};
  for (std::size_t i = 1 + any(4); i > 0; --i) {
    const std::size_t at = any(text.size() + 1);
    switch (any(5)) {
      case 0:
        text.resize(at);
        break;
      case 1:
        text.insert(at, kPieces[any(std::size(kPieces))]);
        break;
      case 2:
        text.erase(at, any(40));
        break;
      case 3:
        if (at < text.size()) text[at] = static_cast<char>(random());
        break;
      default: {
        const std::string piece = text.substr(at, any(200));
        text.insert(any(text.size() + 1), piece);
      }
    }
  }
  return text;
}

void replay(bool bvh, const char* kind) {
  const std::filesystem::path folder =
      std::filesystem::path(HANDSEL_SOURCE_DIR) / "tests/fuzz/corpus" / kind;
  const char* asked = std::getenv("HANDSEL_FUZZ_MUTATIONS");
  const int mutations = asked != nullptr ? std::atoi(asked) : 400;
  int files = 0, good = 0, read = 0, refused = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++files;
    const std::string text = contents(entry.path()), name = entry.path().filename().string();
    const bool expected = name.rfind("good_", 0) == 0;
    good += expected;
    EXPECT_EQ(read_fuzzed(bvh, text), expected) << name;
    std::mt19937_64 random(std::hash<std::string>{}(name));
    for (int i = 0; i < mutations; ++i)
      (read_fuzzed(bvh, mutated(text, random)) ? read : refused)++;
  }
  EXPECT_GE(files - good, 8);
  EXPECT_GE(good, 1);
  EXPECT_GT(read, 0) << "the mutations never reach what follows the parser";
  EXPECT_GT(refused, 0);
}

TEST(RecordingFuzz, csv_corpus_and_mutations) { replay(false, "csv"); }
TEST(RecordingFuzz, bvh_corpus_and_mutations) { replay(true, "bvh"); }

}  // namespace
}  // namespace handsel
#endif
