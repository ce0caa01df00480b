// SPDX-License-Identifier: Apache-2.0
#include "common/config/assignment.hpp"

#include <cstdlib>
#include <vector>

#include <google/protobuf/descriptor.h>

#include "common/base/errors.hpp"
#include "common/config/nearest_name.hpp"
#include "common/config/overlay.hpp"
#include "common/config/schema/overlay.pb.h"
#include "common/config/setting.hpp"
#include "common/config/text_check.hpp"

namespace handsel {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;

constexpr std::size_t kMaxShown = 200;  // max length of given text that messages show [bytes]

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out{""};
  for (const char c : text) {
    if (c == at)
      out.emplace_back();
    else
      out.back() += c;
  }
  return out;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

class Assignment {
 public:
  explicit Assignment(const std::string& text) : text_(text) {}

  std::string as_text() const {
    const std::size_t equals = text_.find('=');
    if (equals == std::string::npos || equals == 0)
      refuse("must be component.key=value, as spark.grip_force=2");
    const std::vector<std::string> keys = split(text_.substr(0, equals), '.');
    return inside(*config::SettingsOverlay::descriptor(), keys, 0, text_.substr(equals + 1));
  }

 private:
  [[noreturn]] void refuse(const std::string& sentence) const {
    throw ConfigError("--set " + printable(text_, kMaxShown) + ": " + sentence);
  }

  /// Returns the text of the message `type` in which the keys from `at` on give a value.
  std::string inside(const Descriptor& type, const std::vector<std::string>& keys, std::size_t at,
                     const std::string& value) const {
    const FieldDescriptor* field = type.FindFieldByName(keys[at]);
    if (field == nullptr) refuse_key(type, keys[at], at == 0);
    const bool is_last = at + 1 == keys.size();
    const std::string& key = field->name();
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) {
      if (!is_last) refuse("\"" + key + "\" is one value and has no key \"" + keys[at + 1] + "\"");
      return key + ": " + values(*field, value);
    }
    const Descriptor& entry = *field->message_type();
    if (is_last) refuse("\"" + key + "\" has keys of its own: " + joined(keys_of(entry)));
    if (!field->is_repeated()) return key + " { " + inside(entry, keys, at + 1, value) + " }";
    const std::string name = entry_key(entry);
    if (name.empty())
      refuse("\"" + key + "\" is a list without names; give the whole list in a file (--config)");
    const std::string head = key + " { " + name + ": " + quoted(keys[at + 1]) + " ";
    if (field->is_map()) return head + "value: " + values(*entry.map_value(), value) + " }";
    if (at + 2 == keys.size())
      refuse("\"" + keys[at + 1] + "\" has keys of its own: " + joined(keys_of(entry)));
    return head + inside(entry, keys, at + 2, value) + " }";
  }

  [[noreturn]] void refuse_key(const Descriptor& type, const std::string& key,
                               bool is_component) const {
    const std::vector<std::string> all = keys_of(type), nearest = nearest_names(key, all);
    refuse((is_component ? "no component \"" : "no key \"") + printable(key, kMaxShown) +
           (is_component ? "\" has settings" : "\" is there") + "; " +
           (nearest.empty() ? "there is: " + joined(all) : "the nearest: " + joined(nearest)));
  }

  static std::vector<std::string> keys_of(const Descriptor& type) {
    std::vector<std::string> out;
    out.reserve(static_cast<std::size_t>(type.field_count()));
    for (int i = 0; i < type.field_count(); ++i) out.push_back(type.field(i)->name());
    return out;
  }

  std::string values(const FieldDescriptor& field, const std::string& value) const {
    if (!field.is_repeated()) return one(field, value);
    std::string list;
    if (!value.empty())
      for (const std::string& each : split(value, ','))
        list += (list.empty() ? "" : ", ") + one(field, each);
    return "[" + list + "]";
  }

  std::string one(const FieldDescriptor& field, const std::string& value) const {
    const std::string is = "is \"" + printable(value, kMaxShown) + "\", must be ";
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_STRING:
        return quoted(value);
      case FieldDescriptor::CPPTYPE_BOOL:
        if (value != "true" && value != "false") refuse(is + "true or false");
        return value;
      case FieldDescriptor::CPPTYPE_ENUM: {
        const EnumDescriptor& type = *field.enum_type();
        if (type.FindValueByName(value) != nullptr) return value;
        std::vector<std::string> all;
        all.reserve(static_cast<std::size_t>(type.value_count()));
        for (int i = 0; i < type.value_count(); ++i) all.push_back(type.value(i)->name());
        refuse(is + "one of " + joined(all));
      }
      default:
        return number(field, value, is);
    }
  }

  std::string number(const FieldDescriptor& field, const std::string& value,
                     const std::string& is) const {
    const Setting setting = setting_of(field);
    const bool whole = field.cpp_type() != FieldDescriptor::CPPTYPE_DOUBLE &&
                       field.cpp_type() != FieldDescriptor::CPPTYPE_FLOAT;
    const std::string right =
        (whole ? "a whole number in " : "a number in ") + range_text(setting) +
        (setting.unit.empty() || setting.unit == "1" ? "" : " " + setting.unit);
    char* end = nullptr;
    const double parsed = std::strtod(value.c_str(), &end);
    const bool plain = value.find_first_not_of("+-.0123456789eE") == std::string::npos;
    if (value.empty() || *end != '\0' || !plain) refuse(is + right);
    if (whole && value.find_first_not_of("-0123456789") != std::string::npos) refuse(is + right);
    if (!is_allowed(parsed, setting)) refuse(is + right);
    return value.starts_with('+') ? value.substr(1) : value;
  }

  const std::string& text_;
};

}  // namespace

std::string assignment_text(const std::string& assignment) {
  return Assignment(assignment).as_text();
}

}  // namespace handsel
