// SPDX-License-Identifier: Apache-2.0
// Fuzzes settings, scenarios and stories, which people write. For libFuzzer: clang++
// -fsanitize=fuzzer,address with the sources of common/config and deploy/handsel/story/story.cpp;
// here corpora and their seeded mutations are replayed.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "common/base/errors.hpp"
#include "common/config/located.hpp"
#include "common/config/schema/scenario.pb.h"
#include "deploy/handsel/story/story.hpp"

namespace handsel {

bool finite(const google::protobuf::Message& message) {
  const auto& get = *message.GetReflection();
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  get.ListFields(message, &fields);
  for (const auto* field : fields) {
    const int count = field->is_repeated() ? get.FieldSize(message, field) : 1;
    for (int i = 0; i < count; ++i) {
      if (field->cpp_type() == field->CPPTYPE_MESSAGE &&
          !finite(field->is_repeated() ? get.GetRepeatedMessage(message, field, i)
                                       : get.GetMessage(message, field)))
        return false;
      if (field->cpp_type() == field->CPPTYPE_DOUBLE && !field->is_repeated() &&
          !std::isfinite(get.GetDouble(message, field)))
        return false;
    }
  }
  return true;
}

/// Calls `read`; true when it returns. Aborts when a refusal is no sentence that begins with the
/// name.
template <class Read>
bool taken(const std::string& name, const Read& read) {
  try {
    read();
    return true;
  } catch (const ConfigError& error) {
    const std::string what = error.what();
    if (what.rfind(name, 0) != 0 || what.find('\n') != std::string::npos || what.size() > 1000) {
      std::fprintf(stderr, "no sentence: %s\n", what.c_str());
      std::abort();
    }
    return false;
  }
}

bool read_scenario(const std::string& name, const std::string& content) {
  return taken(name, [&] {
    config::Scenario scenario;
    google::protobuf::TextFormat::ParseInfoTree places;
    parse_text_proto(content, name, scenario, places);
    if (!finite(scenario)) std::abort();
  });
}

bool read_story_text(const std::string& name, const std::string& content) {
  return taken(name, [&] {
    for (const StoryStep& step : parse_story(content, name).steps)
      if (step.condition && !std::isfinite(step.condition->value)) std::abort();
  });
}

}  // namespace handsel

#ifdef HANDSEL_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string content(reinterpret_cast<const char*>(data) + 1, size - 1);
  data[0] & 1 ? handsel::read_scenario("f.txtpb", content)
              : handsel::read_story_text("f.story", content);
  return 0;
}
#else
#include "tests/fuzz/replay.hpp"

namespace handsel {
namespace {

TEST(TextFuzz, no_scenario_crashes_and_each_refusal_is_one_sentence) {
  fuzz::replay("txtpb", read_scenario,
               {"pose { xyz { x: ", "people {", "id: \"a\"", "start { key: \"j\" value: 1 }",
                "boxes <", "x: [1, 2]", "\"\\377\"", "# c\n", "rate: nan"},
               200);
}

TEST(TextFuzz, no_story_crashes_and_each_refusal_is_one_sentence) {
  fuzz::replay("story", read_story_text,
               {"start a\n", "within 1s", "at 1e9s ", "expect ", "speed below ", "for 2ms",
                "kill -9 ", "never "},
               200);
}

}  // namespace
}  // namespace handsel
#endif
