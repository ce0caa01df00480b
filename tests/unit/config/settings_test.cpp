// SPDX-License-Identifier: Apache-2.0
// Each settings file: the schema of each field, and the refusals of the reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <regex>
#include <set>

#include "common/base/errors.hpp"
#include "common/config/located.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/unit/config/settings_files.hpp"

namespace handsel::settings_test {
namespace {

using google::protobuf::Message;
using test::fields_of;
using test::message_of;
using test::SettingField;
using test::SettingsFile;
using ::testing::StartsWith;

const std::filesystem::path kRoot = HANDSEL_SOURCE_DIR;

std::unique_ptr<Message> empty_message(const google::protobuf::Descriptor& type) {
  auto* const factory = google::protobuf::MessageFactory::generated_factory();
  return std::unique_ptr<Message>(factory->GetPrototype(&type)->New());
}

std::string refusal(const SettingsFile& file, const std::string& text) {
  const auto out = empty_message(*file.type);
  google::protobuf::TextFormat::ParseInfoTree places;
  return message_of<ConfigError>([&] { parse_text_proto(text, "s.txtpb", *out, places); });
}

/// A text of two lines; the key stands on the second.
std::string text_with(const SettingField& field, const std::string& value) {
  return "# a comment\n" + field.before + field.field->name() + ": " + value + field.after + "\n";
}

/// Values that are refused.
std::vector<std::string> wrong_values(const SettingField& field) {
  const Setting setting = setting_of(*field.field);
  if (field.field->is_map()) return {"3"};
  if (!test::is_number(*field.field)) {
    if (field.field->cpp_type() == test::FieldDescriptor::CPPTYPE_STRING) return {"3", "\"\\377\""};
    return {"\"x\"", "nan", "1.5"};
  }
  std::vector<std::string> out{"nan", "inf", "-inf", "\"x\"", "x y"};
  const double below = setting.above_min ? setting.min : setting.min - 1;
  out.push_back(short_form(below));
  out.push_back(short_form(std::ceil(2 * setting.max + 1)));
  out.push_back(test::is_whole_number(*field.field) ? "1.5" : "1e400");
  return out;
}

TEST(Settings, every_schema_that_names_a_file_is_tested_and_the_file_is_there) {
  std::set<std::string> named, tested;
  const std::regex option("option \\(file\\) = \"([^\"]+)\"");
  for (const auto& entry : std::filesystem::directory_iterator(kRoot / "common/config/schema")) {
    std::ifstream in(entry.path());
    std::smatch match;
    for (std::string line; std::getline(in, line);)
      if (std::regex_search(line, match, option)) named.insert(match[1]);
  }
  for (const SettingsFile& file : test::settings_files()) {
    tested.insert(file.file);
    EXPECT_TRUE(std::filesystem::exists(kRoot / "deploy" / file.file)) << file.file;
    EXPECT_TRUE(std::filesystem::exists(kRoot / file.document)) << file.document;
  }
  EXPECT_EQ(named, tested);
}

TEST(Settings, every_field_has_unit_range_default_and_meaning) {
  for (const SettingsFile& file : test::settings_files()) {
    for (const SettingField& field : fields_of(file)) {
      const Setting setting = setting_of(*field.field);
      const std::string where = file.type->name() + "." + field.path;
      EXPECT_FALSE(setting.doc.empty()) << where << " has no doc";
      if (test::is_number(*field.field)) {
        EXPECT_FALSE(setting.unit.empty()) << where << " has no unit";
        EXPECT_TRUE(setting.has_range) << where << " has no min and max";
        EXPECT_LT(setting.min, setting.max) << where;
      }
      const bool is_open = field.field->has_optional_keyword() && !setting.has_default;
      if (field.field->is_repeated() || is_open) continue;
      EXPECT_NE(setting.has_default, setting.required)
          << where << " has either a default value or the option required";
      if (!setting.has_default || !test::is_number(*field.field)) continue;
      EXPECT_TRUE(is_allowed(std::stod(setting.default_value), setting))
          << where << ": the default " << setting.default_value << " is out of range";
    }
  }
}

TEST(Settings, wrong_values_of_every_key_are_refused_with_file_line_and_key) {
  for (const SettingsFile& file : test::settings_files()) {
    for (const SettingField& field : fields_of(file)) {
      for (const std::string& value : wrong_values(field)) {
        const std::string text = text_with(field, value);
        EXPECT_THAT(refusal(file, text), StartsWith("s.txtpb:2:" + field.field->name() + ": "))
            << text;
      }
    }
  }
}

TEST(Settings, a_key_that_is_unknown_is_refused_and_the_nearest_is_named) {
  for (const SettingsFile& file : test::settings_files()) {
    for (const SettingField& field : fields_of(file)) {
      const std::string key = field.field->name() + "_";
      const std::string text = "# a comment\n" + field.before + key + ": 1" + field.after + "\n";
      const std::string expected = "s.txtpb:2:" + key + ": is no key of " +
                                   field.field->containing_type()->name() + "; the nearest is \"" +
                                   field.field->name() + "\"";
      EXPECT_EQ(refusal(file, text), expected) << text;
    }
  }
}

TEST(Settings, what_a_file_leaves_out_has_the_default_value) {
  for (const SettingsFile& file : test::settings_files()) {
    const auto out = empty_message(*file.type);
    google::protobuf::TextFormat::ParseInfoTree places;
    if (refusal(file, "").ends_with("must be given")) continue;
    parse_text_proto("", "s.txtpb", *out, places);
    for (int i = 0; i < file.type->field_count(); ++i) {
      const auto& field = *file.type->field(i);
      if (field.is_repeated() || field.cpp_type() != test::FieldDescriptor::CPPTYPE_DOUBLE)
        continue;
      EXPECT_EQ(out->GetReflection()->GetDouble(*out, &field),
                std::stod(setting_of(field).default_value))
          << file.type->name() << "." << field.name();
    }
  }
}

}  // namespace
}  // namespace handsel::settings_test
