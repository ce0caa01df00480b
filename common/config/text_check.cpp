// SPDX-License-Identifier: Apache-2.0
#include "common/config/text_check.hpp"

#include <algorithm>
#include <set>

#include "common/base/errors.hpp"
#include "common/config/setting.hpp"

namespace handsel {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using Places = google::protobuf::TextFormat::ParseInfoTree;

constexpr std::size_t kMaxText = 4096;  // max length of a text [bytes]

/// Returns the length of the UTF-8 character at `at`; 0 if there is none.
std::size_t character_length(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return static_cast<unsigned char>(i < text.size() ? text[i] : 0);
  };
  const unsigned char first = byte(at);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xc2 && first < 0xe0 ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xc0) != 0x80) return 0;
  return length;
}

bool is_utf8(const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(text, at);
    if (length == 0 || text[at] == '\0') return false;
    at += length;
  }
  return true;
}

class TextCheck {
 public:
  explicit TextCheck(const std::string& file) : file_(file) {}

  void check(const Message& message, const Places* places) const {
    const Descriptor& type = *message.GetDescriptor();
    for (int i = 0; i < type.field_count(); ++i) {
      const FieldDescriptor& field = *type.field(i);
      if (field.is_map()) require_different_keys(message, field, places);
      const int count =
          field.is_repeated() ? message.GetReflection()->FieldSize(message, &field) : 1;
      for (int k = 0; k < count; ++k) check(message, field, field.is_repeated() ? k : -1, places);
    }
  }

 private:
  [[noreturn]] void fail(const FieldDescriptor& field, int index, const Places* places,
                         const std::string& what) const {
    int line = places != nullptr ? places->GetLocation(&field, index).line : -1;
    if (line < 0 && index > 0 && places != nullptr)
      line = places->GetLocation(&field, 0).line;  // list in brackets
    throw ConfigError(file_ + (line < 0 ? "" : ":" + std::to_string(line + 1)) + ":" +
                      field.name() + ": " + what);
  }

  void check(const Message& message, const FieldDescriptor& field, int index,
             const Places* places) const {
    const Reflection& get = *message.GetReflection();
    const auto value = [&](auto single, auto repeated) {
      return index < 0 ? (get.*single)(message, &field) : (get.*repeated)(message, &field, index);
    };
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_DOUBLE:
        return number(value(&Reflection::GetDouble, &Reflection::GetRepeatedDouble), field, index,
                      places);
      case FieldDescriptor::CPPTYPE_FLOAT:
        return number(value(&Reflection::GetFloat, &Reflection::GetRepeatedFloat), field, index,
                      places);
      case FieldDescriptor::CPPTYPE_INT32:
        return number(value(&Reflection::GetInt32, &Reflection::GetRepeatedInt32), field, index,
                      places);
      case FieldDescriptor::CPPTYPE_UINT32:
        return number(value(&Reflection::GetUInt32, &Reflection::GetRepeatedUInt32), field, index,
                      places);
      case FieldDescriptor::CPPTYPE_STRING:
        return text(value(&Reflection::GetString, &Reflection::GetRepeatedString), field, index,
                    places);
      case FieldDescriptor::CPPTYPE_MESSAGE:
        if (index < 0 && !get.HasField(message, &field)) return;
        return check(index < 0 ? get.GetMessage(message, &field)
                               : get.GetRepeatedMessage(message, &field, index),
                     places != nullptr ? places->GetTreeForNested(&field, index) : nullptr);
      default:
        return;
    }
  }

  void number(double value, const FieldDescriptor& field, int index, const Places* places) const {
    const bool written =
        value != 0 || (places != nullptr && places->GetLocation(&field, index).line >= 0);
    if (!written) return;  // the component checks whether a field may be omitted
    const Setting setting = setting_of(field);
    if (is_allowed(value, setting)) return;
    fail(field, index, places,
         "is " + short_form(value) + ", must be a number in " + range_text(setting));
  }

  void text(const std::string& value, const FieldDescriptor& field, int index,
            const Places* places) const {
    if (value.size() > kMaxText)
      fail(field, index, places,
           "is " + std::to_string(value.size()) + " bytes long, must be at most " +
               std::to_string(kMaxText));
    if (!is_utf8(value))
      fail(field, index, places, "is no text in UTF-8: \"" + printable(value, 40) + "\"");
  }

  void require_different_keys(const Message& message, const FieldDescriptor& field,
                              const Places* places) const {
    const FieldDescriptor& key = *field.message_type()->map_key();
    if (key.cpp_type() != FieldDescriptor::CPPTYPE_STRING) return;
    std::set<std::string> known;
    for (int i = 0; i < message.GetReflection()->FieldSize(message, &field); ++i) {
      const Message& entry = message.GetReflection()->GetRepeatedMessage(message, &field, i);
      const std::string name = entry.GetReflection()->GetString(entry, &key);
      if (!known.insert(name).second)
        fail(field, i, places,
             "has the key \"" + printable(name, 60) + "\" twice; each may be there once");
    }
  }

  const std::string& file_;
};

}  // namespace

void check_text(const Message& message, const Places& places, const std::string& file) {
  TextCheck(file).check(message, &places);
}

std::string printable(const std::string& text, std::size_t max_bytes) {
  std::string out = text.substr(0, max_bytes);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < 32 || c > 126; }, '?');
  return text.size() > max_bytes ? out + "..." : out;
}

}  // namespace handsel
