// SPDX-License-Identifier: Apache-2.0
// Generates plain structs of settings from the schema:
//   handsel_settings_generator SCHEMA_SET FOLDER NAME...
// SCHEMA_SET is the output of `protoc --descriptor_set_out`. For each NAME, FOLDER/NAME.hpp
// contains the structs of schema/NAME.proto that belong to a settings file, with default values and
// comments, and FOLDER/NAME.cpp the functions that read and fill them. Unchanged files are not
// written.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include "common/config/schema/options.pb.h"
#include "common/config/setting.hpp"

namespace handsel {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::FileDescriptor;

std::string in_lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// Converts "CostmapSettings" to "costmap_settings", "Ros2LaneSettings" to "ros2_lane_settings".
std::string in_snake_case(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (std::isupper(static_cast<unsigned char>(c)) && !out.empty()) out += '_';
    out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return out;
}

/// Converts "robot_grip" to "RobotGrip".
std::string in_camel_case(const std::string& name) {
  std::string out;
  bool begins = true;
  for (const char c : name) {
    if (c != '_')
      out += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    begins = c == '_';
  }
  return out;
}

/// Returns the inner struct that contains a field; empty if none does.
std::string part_of(const FieldDescriptor& field) {
  return field.options().GetExtension(config::part);
}

/// Returns the name of a message or an enumeration without its package, parts joined by `joint`.
template <class Type>
std::string name_of(const Type& type, const std::string& joint = "::") {
  const auto* outer = type.containing_type();
  return outer == nullptr ? type.name() : name_of(*outer, joint) + joint + type.name();
}

std::string stem_of(const FileDescriptor& file) {
  const std::string name = file.name().substr(file.name().rfind('/') + 1);
  return name.substr(0, name.rfind('.'));
}

bool is_optional_message(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !field.is_repeated() &&
         field.has_optional_keyword();
}

std::string value_type(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return "int";
    case FieldDescriptor::CPPTYPE_INT64:
      return "std::int64_t";
    case FieldDescriptor::CPPTYPE_UINT32:
      return "std::uint32_t";
    case FieldDescriptor::CPPTYPE_UINT64:
      return "std::uint64_t";
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return "double";
    case FieldDescriptor::CPPTYPE_FLOAT:
      return "float";
    case FieldDescriptor::CPPTYPE_BOOL:
      return "bool";
    case FieldDescriptor::CPPTYPE_STRING:
      return "std::string";
    case FieldDescriptor::CPPTYPE_ENUM:
      return name_of(*field.enum_type());
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return name_of(*field.message_type());
  }
  return {};
}

/// Returns whether a scalar has no default value and may be omitted.
bool is_open(const FieldDescriptor& field) {
  return field.has_optional_keyword() && !setting_of(field).has_default &&
         !setting_of(field).required;
}

std::string member_type(const FieldDescriptor& field) {
  if (field.is_map())
    return "std::map<" + value_type(*field.message_type()->map_key()) + ", " +
           value_type(*field.message_type()->map_value()) + ">";
  if (field.is_repeated()) return "std::vector<" + value_type(field) + ">";
  if (is_open(field)) return "std::optional<" + value_type(field) + ">";
  return value_type(field);
}

/// Returns the initial value in braces, or nothing if the type has its own.
std::string initial_value(const FieldDescriptor& field) {
  if (field.is_repeated() || is_open(field)) return "";
  const std::string value = setting_of(field).default_value;
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return "";
    case FieldDescriptor::CPPTYPE_STRING:
      return value.empty() ? "" : "{\"" + value + "\"}";
    case FieldDescriptor::CPPTYPE_ENUM:
      return value.empty() ? "{}" : "{" + value_type(field) + "::" + in_lower(value) + "}";
    default:
      return "{" + value + "}";
  }
}

std::string comment_of(const FieldDescriptor& field) {
  const Setting setting = setting_of(field);
  return setting.doc + (setting.unit.empty() ? "" : " [" + setting.unit + "]");
}

/// Adds a message and its nested messages of the same file, the inner ones first.
void add_with_parts(const Descriptor& message, std::vector<const Descriptor*>& out) {
  if (std::find(out.begin(), out.end(), &message) != out.end()) return;
  for (int i = 0; i < message.field_count(); ++i) {
    const Descriptor* part = message.field(i)->message_type();
    if (part != nullptr && part != &message && !part->options().map_entry())
      add_with_parts(*part, out);
  }
  out.push_back(&message);
}

/// Generates the structs of one schema file.
class Structs {
 public:
  Structs(const FileDescriptor& file, const std::vector<const Descriptor*>& messages)
      : file_(file) {
    for (const Descriptor* message : messages)
      if (message->file() == &file) messages_.push_back(message);
  }

  std::string header() const {
    std::ostringstream out;
    out << "// Made from " << file_.name() << "; not edited by hand.\n#pragma once\n\n"
        << "#include <cstdint>\n#include <filesystem>\n#include <map>\n#include <optional>\n"
        << "#include <string>\n#include <vector>\n\n";
    for (const std::string& stem : used_files())
      out << "#include \"common/config/settings/" << stem << ".hpp\"\n";
    out << "\nnamespace handsel {\nclass SettingsText;\n}\nnamespace handsel::config {\n";
    for (const Descriptor* message : messages_) out << "class " << name_of(*message, "_") << ";\n";
    out << "}\n\nnamespace handsel::settings {\n\n";
    for (const EnumDescriptor* choice : choices())
      if (choice->containing_type() == nullptr) write(out, *choice);
    for (const Descriptor* message : messages_) write(out, *message);
    for (const Descriptor* message : messages_) {
      out << "/// Copies the values of a text.\n"
          << "void fill(const config::" << name_of(*message, "_") << "& in, " << name_of(*message)
          << "& out);\n";
      if (is_file(*message))
        out << "/// Reads a file. Throws MissingError, ConfigError \"file:line:key: ...\". `text`, "
               "where given,\n"
            << "/// knows the place of each value.\n"
            << name_of(*message) << " read_" << in_snake_case(message->name())
            << "(const std::filesystem::path& file, SettingsText* text = nullptr);\n";
    }
    out << "\n}  // namespace handsel::settings\n";
    return out.str();
  }

  std::string source() const {
    std::ostringstream out;
    const std::string stem = stem_of(file_);
    out << "#include \"common/config/settings/" << stem << ".hpp\"\n\n"
        << "#include \"" << file_.name().substr(0, file_.name().rfind('.')) << ".pb.h\"\n"
        << "#include \"common/config/settings_text.hpp\"\n\nnamespace handsel::settings {\n\n";
    for (const Descriptor* message : messages_) {
      write_fill(out, *message);
      if (is_file(*message)) write_read(out, *message);
    }
    out << "}  // namespace handsel::settings\n";
    return out.str();
  }

 private:
  static bool is_file(const Descriptor& message) {
    return message.options().HasExtension(config::file);
  }

  std::set<std::string> used_files() const {
    std::set<std::string> out;
    for (const Descriptor* message : messages_)
      for (int i = 0; i < message->field_count(); ++i)
        if (const Descriptor* part = message->field(i)->message_type();
            part != nullptr && part->file() != &file_)
          out.insert(stem_of(*part->file()));
    return out;
  }

  /// Returns the enumerations of the fields, each once.
  std::vector<const EnumDescriptor*> choices() const {
    std::vector<const EnumDescriptor*> out;
    for (const Descriptor* message : messages_)
      for (int i = 0; i < message->field_count(); ++i)
        if (const EnumDescriptor* choice = message->field(i)->enum_type();
            choice != nullptr && std::find(out.begin(), out.end(), choice) == out.end())
          out.push_back(choice);
    return out;
  }

  static void write(std::ostream& out, const EnumDescriptor& choice) {
    out << "enum class " << choice.name() << " {\n";
    for (int i = 0; i < choice.value_count(); ++i)
      out << "  " << in_lower(choice.value(i)->name()) << " = " << choice.value(i)->number()
          << ",\n";
    out << "};\n\n";
  }

  static void write_member(std::ostream& out, const FieldDescriptor& field) {
    const std::string type = is_optional_message(field) ? "std::optional<" + value_type(field) + ">"
                                                        : member_type(field);
    out << "  " << type << " " << field.name() << initial_value(field) << ";  ///< "
        << comment_of(field) << "\n";
  }

  void write(std::ostream& out, const Descriptor& message) const {
    out << "struct " << message.name() << " {\n";
    for (int i = 0; i < message.enum_type_count(); ++i) write(out, *message.enum_type(i));
    std::map<std::string, std::vector<const FieldDescriptor*>> parts;
    for (int i = 0; i < message.field_count(); ++i)
      parts[part_of(*message.field(i))].push_back(message.field(i));
    for (const auto& [part, fields] : parts) {
      if (!part.empty()) out << "  struct " << in_camel_case(part) << " {\n";
      for (const FieldDescriptor* field : fields) write_member(out, *field);
      if (!part.empty()) out << "  } " << part << ";  ///< settings of the part " << part << "\n";
    }
    out << "};\n\n";
  }

  static void write_fill(std::ostream& out, const Descriptor& message) {
    out << "void fill(const config::" << name_of(message, "_") << "& in, " << name_of(message)
        << "& out) {\n";
    if (message.field_count() == 0) out << "  (void)in;\n  (void)out;\n";
    for (int i = 0; i < message.field_count(); ++i)
      out << "  " << assignment(*message.field(i)) << "\n";
    out << "}\n\n";
  }

  static std::string assignment(const FieldDescriptor& field) {
    const std::string part = part_of(field);
    const std::string& get = field.lowercase_name();
    const std::string member = "out." + (part.empty() ? "" : part + ".") + field.name(),
                      value = "in." + get + "()";
    const bool is_message = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    if (field.is_map())
      return "for (const auto& [key, value] : " + value + ") " + member + "[key] = value;";
    if (field.is_repeated() && is_message)
      return "for (const auto& part : " + value + ") fill(part, " + member + ".emplace_back());";
    if (field.is_repeated()) return member + ".assign(" + value + ".begin(), " + value + ".end());";
    const std::string given = "if (in.has_" + get + "()) ";
    if (is_message)
      return given + "fill(" + value + ", " + member +
             (is_optional_message(field) ? ".emplace()" : "") + ");";
    const bool is_choice = field.cpp_type() == FieldDescriptor::CPPTYPE_ENUM;
    const std::string converted =
        is_choice ? "static_cast<" + value_type(field) + ">(" + value + ")" : value;
    return (is_open(field) ? given : "") + member + " = " + converted + ";";
  }

  static void write_read(std::ostream& out, const Descriptor& message) {
    const std::string name = name_of(message);
    out << name << " read_" << in_snake_case(message.name())
        << "(const std::filesystem::path& file, SettingsText* text) {\n"
        << "  config::" << name_of(message, "_") << " in;\n"
        << "  SettingsText own;\n"
        << "  (text != nullptr ? *text : own).load(file, in);\n"
        << "  " << name << " out;\n"
        << "  fill(in, out);\n"
        << "  return out;\n"
        << "}\n\n";
  }

  const FileDescriptor& file_;
  std::vector<const Descriptor*> messages_;
};

std::string content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_changed(const std::string& path, const std::string& content) {
  if (std::ifstream(path).good() && content_of(path) == content) return;
  std::ofstream out(path, std::ios::binary);
  out << content;
  if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

void generate(const std::string& schema_set, const std::string& folder,
              const std::vector<std::string>& names) {
  google::protobuf::FileDescriptorSet set;
  if (!set.ParseFromString(content_of(schema_set)))
    throw std::runtime_error(schema_set + " is no set of schemas");
  google::protobuf::DescriptorPool pool;
  std::vector<const Descriptor*> messages;
  std::set<std::string> open(names.begin(), names.end());
  std::vector<const FileDescriptor*> files;
  for (const auto& text : set.file()) {
    const FileDescriptor* file = pool.BuildFile(text);
    if (file == nullptr) throw std::runtime_error(text.name() + " cannot be used");
    if (open.erase(stem_of(*file)) > 0) files.push_back(file);
    for (int i = 0; i < file->message_type_count(); ++i)
      if (file->message_type(i)->options().HasExtension(config::file))
        add_with_parts(*file->message_type(i), messages);
  }
  if (!open.empty()) throw std::runtime_error("there is no schema " + *open.begin());
  for (const FileDescriptor* file : files) {
    const Structs structs(*file, messages);
    write_changed(folder + "/" + stem_of(*file) + ".hpp", structs.header());
    write_changed(folder + "/" + stem_of(*file) + ".cpp", structs.source());
  }
}

}  // namespace
}  // namespace handsel

int main(int argc, char** argv) {
  if (argc < 4) {
    std::cerr << "usage: handsel_settings_generator SCHEMA_SET FOLDER NAME...\n";
    return 2;
  }
  try {
    handsel::generate(argv[1], argv[2], {argv + 3, argv + argc});
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
