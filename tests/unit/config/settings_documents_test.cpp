// SPDX-License-Identifier: Apache-2.0
// The shipped settings files contain meaning and unit of each key as a comment, and a document
// contains the table of each file. Both follow from the schema: HANDSEL_WRITE_SETTINGS=1 writes
// them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

#include "tests/unit/config/settings_files.hpp"

namespace handsel::settings_documents_test {
namespace {

using test::Descriptor;
using test::FieldDescriptor;
using test::fields_of;
using test::SettingField;
using test::SettingsFile;

const std::filesystem::path kRoot = HANDSEL_SOURCE_DIR;

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Compares a file with its required content, or writes it.
void expect_content(const std::filesystem::path& file, const std::string& content) {
  if (std::getenv("HANDSEL_WRITE_SETTINGS")) std::ofstream(file, std::ios::binary) << content;
  EXPECT_EQ(content_of(file), content)
      << file << "; HANDSEL_WRITE_SETTINGS=1 ctest -R config writes it";
}

/// A phrase in a cell of a table.
std::string in_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
    text.insert(at, "\\");
  return text;
}

std::string shown_default(const SettingField& field, const Setting& setting) {
  if (setting.required) return "must be given";
  if (field.field->is_repeated()) return "none";
  if (field.field->cpp_type() != FieldDescriptor::CPPTYPE_STRING) return setting.default_value;
  return "\"" + setting.default_value + "\"";
}

std::string table_of(const SettingsFile& file) {
  std::ostringstream out;
  out << "| key | unit | range | default | meaning |\n|---|---|---|---|---|\n";
  for (const SettingField& field : fields_of(file)) {
    const Setting setting = setting_of(*field.field);
    out << "| `" << field.path << "` | " << setting.unit << " | "
        << (test::is_number(*field.field) ? range_text(setting) : "") << " | "
        << in_cell(shown_default(field, setting)) << " | " << in_cell(setting.doc) << " |\n";
  }
  return out.str();
}

/// The document with the table of a file: between two comments, else in a section at the end.
std::string with_table(const std::string& document, const SettingsFile& file) {
  const std::string begin = "<!-- settings: " + file.file + " -->\n", end = "<!-- end -->\n";
  const std::string section = begin + table_of(file) + end;
  const std::size_t at = document.find(begin);
  if (at == std::string::npos)
    return document + "\n## Settings: `deploy/" + file.file + "`\n\n" + section;
  const std::size_t after = document.find(end, at);
  return document.substr(0, at) + section +
         (after == std::string::npos ? "" : document.substr(after + end.size()));
}

/// Puts meaning and unit as a comment behind each line of a text that gives one key a value.
std::string with_comments(const std::string& text, const Descriptor& root) {
  static const std::regex opens(R"(^\s*(\w+) \{\s*(#.*)?$)"), closes(R"(^\s*\}\s*(#.*)?$)");
  static const std::regex value(R"(^(\s*(\w+): ("[^"]*"|[^\s#"\[]+))(\s+#.*)?$)");
  std::vector<const Descriptor*> inside{&root};
  std::ostringstream out;
  std::istringstream in(text);
  std::smatch match;
  for (std::string line; std::getline(in, line); out << line << "\n") {
    const Descriptor* here = inside.back();
    if (std::regex_match(line, match, opens)) {
      const FieldDescriptor* field = here ? here->FindFieldByName(match[1]) : nullptr;
      inside.push_back(field ? field->message_type() : nullptr);
    } else if (std::regex_match(line, closes)) {
      if (inside.size() > 1) inside.pop_back();
    } else if (std::regex_match(line, match, value) && here != nullptr) {
      const FieldDescriptor* field = here->FindFieldByName(match[2]);
      if (field == nullptr || setting_of(*field).doc.empty()) continue;
      const Setting setting = setting_of(*field);
      line = match[1].str() + "  # " + setting.doc +
             (setting.unit.empty() ? "" : " [" + setting.unit + "]");
    }
  }
  return out.str();
}

TEST(Settings, each_shipped_file_says_what_its_keys_mean) {
  for (const SettingsFile& file : test::settings_files()) {
    const std::filesystem::path path = kRoot / "deploy" / file.file;
    expect_content(path, with_comments(content_of(path), *file.type));
  }
}

TEST(Settings, each_shipped_number_is_the_default) {
  for (const SettingsFile& file : test::settings_files()) {
    const std::string text = content_of(kRoot / "deploy" / file.file);
    for (int i = 0; i < file.type->field_count(); ++i) {
      const FieldDescriptor& field = *file.type->field(i);
      const Setting setting = setting_of(field);
      std::smatch match;
      const std::regex line("(^|\n)" + field.name() + ": (\"([^\"]*)\"|[^\\s#\\[]+)");
      if (!setting.has_default || !test::is_number(field)) continue;
      if (!std::regex_search(text, match, line)) continue;
      EXPECT_EQ(match[3].matched ? match[3].str() : match[2].str(), setting.default_value)
          << file.file << ": " << field.name();
    }
  }
}

TEST(Settings, each_file_has_its_table_in_a_document) {
  for (const SettingsFile& file : test::settings_files()) {
    const std::filesystem::path path = kRoot / file.document;
    expect_content(path, with_table(content_of(path), file));
  }
}

}  // namespace
}  // namespace handsel::settings_documents_test
