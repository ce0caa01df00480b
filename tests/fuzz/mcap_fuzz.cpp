// SPDX-License-Identifier: Apache-2.0
// Fuzzes MCAP recordings, which other programs also write. For libFuzzer: clang++
// -fsanitize=fuzzer,address with the sources of common/record; here a corpus and its seeded
// mutations are replayed.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/base/errors.hpp"
#include "common/record/mcap.hpp"

namespace handsel {

/// True when the file was read to its end. Aborts when a message has more bytes than the file or a
/// refusal is no sentence.
bool read_mcap(const std::string& name, const std::string& content) {
  const std::filesystem::path folder = std::filesystem::is_directory("/dev/shm")
                                           ? "/dev/shm"
                                           : std::filesystem::temp_directory_path();
  const std::filesystem::path file =
      folder / ("handsel-fuzz-" + std::to_string(getpid()) + "-" + name);
  std::ofstream(file, std::ios::binary) << content;
  bool good = true;
  try {
    mcap::Reader reader(file);
    mcap::Message message;
    while (reader.next(message))
      if (message.time < 0 || message.data.size() > content.size()) std::abort();
  } catch (const ConfigError& error) {
    const std::string what = error.what();
    if (what.find(name) == std::string::npos || what.find('\n') != std::string::npos ||
        what.size() > 400) {
      std::fprintf(stderr, "no sentence: %s\n", what.c_str());
      std::abort();
    }
    good = false;
  }
  std::filesystem::remove(file);
  return good;
}

}  // namespace handsel

#ifdef HANDSEL_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  handsel::read_mcap("f.mcap", {reinterpret_cast<const char*>(data), size});
  return 0;
}
#else
#include "tests/fuzz/replay.hpp"

namespace handsel {
namespace {

TEST(McapFuzz, no_recording_crashes_and_each_refusal_is_one_sentence) {
  fuzz::replay("mcap", read_mcap,
               {std::string("\6\377\377\377\377\0\0\0\0", 9), std::string("\5\4\0\0\0\0\0\0\0", 9),
                "\x0f", "lz4", "\x89MCAP0\r\n"},
               200);
}

}  // namespace
}  // namespace handsel
#endif
