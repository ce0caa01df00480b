// SPDX-License-Identifier: Apache-2.0
// Writes a recording and reads it back; the file opens in every MCAP viewer.
#include <cstdio>
#include <filesystem>

#include <handsel/record.hpp>

int main() {
  const auto file = std::filesystem::temp_directory_path() / "handsel_example_09.mcap";
  std::filesystem::remove(file);
  {
    handsel::mcap::Writer writer(file, {{"example/counter", "json", "Counter", "jsonschema", "{}"}},
                                 {{"study", "first"}});
    for (std::int64_t i = 0; i < 3; ++i) {
      const std::string text = "{\"count\":" + std::to_string(i) + "}";
      writer.write({0, i * 1000000, {text.begin(), text.end()}});
    }
  }
  try {
    handsel::mcap::Reader reader(file);
    int count = 0;
    handsel::mcap::Message message;
    std::string topic;
    for (; reader.next(message); ++count) topic = reader.channels().at(message.channel).topic;
    std::printf("%d messages of %s, study: %s\n", count, topic.c_str(),
                reader.metadata().at("study").c_str());
  } catch (const handsel::ConfigError& error) {
    std::printf("damaged: %s\n", error.what());
    return 1;
  }
  std::filesystem::remove(file);
  return 0;
}
