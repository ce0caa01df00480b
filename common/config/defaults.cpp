// SPDX-License-Identifier: Apache-2.0
#include "common/config/defaults.hpp"

#include "common/base/errors.hpp"
#include "common/config/setting.hpp"

namespace handsel {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::TextFormat;
using Places = TextFormat::ParseInfoTree;

bool is_number(const FieldDescriptor& field) {
  return field.cpp_type() != FieldDescriptor::CPPTYPE_STRING &&
         field.cpp_type() != FieldDescriptor::CPPTYPE_BOOL &&
         field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE &&
         field.cpp_type() != FieldDescriptor::CPPTYPE_ENUM;
}

void set(Message& message, const FieldDescriptor& field, const std::string& value) {
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
    message.GetReflection()->SetString(&message, &field, value);
  } else if (!TextFormat::Parser().ParseFieldValueFromString(value, &field, &message)) {
    throw ConfigError("the schema gives " + field.full_name() + " the default \"" + value +
                      "\", which is none of its values");
  }
}

class Defaults {
 public:
  explicit Defaults(const std::string& file) : file_(file) {}

  /// Takes over a message. `line` is that of the message in the file, from 1; 0 means the whole
  /// file.
  void take(Message& message, const Places* places, int line) const {
    for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
      const FieldDescriptor& field = *message.GetDescriptor()->field(i);
      if (field.is_map()) continue;
      if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
        take_inside(message, field, places, line);
      } else if (!field.is_repeated() && line_of(field, -1, places) == 0) {
        take_one(message, field, line);
      }
    }
  }

 private:
  static int line_of(const FieldDescriptor& field, int index, const Places* places) {
    return places == nullptr ? 0 : places->GetLocation(&field, index).line + 1;
  }

  void take_inside(Message& message, const FieldDescriptor& field, const Places* places,
                   int line) const {
    const auto& reflection = *message.GetReflection();
    const auto inside = [&](Message& part, int index) {
      const Places* parts = places == nullptr ? nullptr : places->GetTreeForNested(&field, index);
      take(part, parts, line_of(field, index, places));
    };
    if (field.is_repeated()) {
      for (int k = 0; k < reflection.FieldSize(message, &field); ++k)
        inside(*reflection.MutableRepeatedMessage(&message, &field, k), k);
    } else if (reflection.HasField(message, &field)) {
      inside(*reflection.MutableMessage(&message, &field), -1);
    } else if (!field.has_optional_keyword() && has_required(*field.message_type())) {
      refuse(field, line);
    }
  }

  void take_one(Message& message, const FieldDescriptor& field, int line) const {
    const Setting setting = setting_of(field);
    if (setting.has_default) return set(message, field, setting.default_value);
    if (setting.required) refuse(field, line);
  }

  static bool has_required(const google::protobuf::Descriptor& type) {
    for (int i = 0; i < type.field_count(); ++i)
      if (setting_of(*type.field(i)).required) return true;
    return false;
  }

  [[noreturn]] void refuse(const FieldDescriptor& field, int line) const {
    throw ConfigError(file_ + (line == 0 ? "" : ":" + std::to_string(line)) + ":" + field.name() +
                      ": must be given" +
                      (is_number(field) ? ", a number in " + range_text(setting_of(field)) : ""));
  }

  const std::string& file_;
};

}  // namespace

void take_defaults(Message& message, const Places& places, const std::string& file) {
  Defaults(file).take(message, &places, 0);
}

}  // namespace handsel
