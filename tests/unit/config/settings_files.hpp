// SPDX-License-Identifier: Apache-2.0
// Every settings file of the system, as its schema describes it.
#pragma once

#include <string>
#include <vector>

#include "common/config/schema/options.pb.h"
#include "common/config/setting.hpp"
#include "tests/unit/config/settings_schemas.hpp"

namespace handsel::test {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

/// A settings file: the message it holds, its name below deploy/, the document with its table.
struct SettingsFile {
  const Descriptor* type;      ///< outermost message
  std::string file, document;  ///< paths in the source tree, below deploy/ and below the root
};

/// Returns the settings files whose schemas state options.
inline std::vector<SettingsFile> settings_files() {
  std::vector<SettingsFile> out;
  for (const Descriptor* type : settings_schemas())
    out.push_back({type, type->options().GetExtension(config::file),
                   type->options().GetExtension(config::document)});
  return out;
}

/// One field of a settings file.
struct SettingField {
  const SettingsFile* file;      ///< the file it belongs to
  const FieldDescriptor* field;  ///< the field
  std::string path;              ///< "timeouts.robot_state", "behaviours[].p_min"
  std::string before, after;     ///< of a line that gives the key a value: the messages around it
};

/// Returns the fields of a message and of the messages inside it, maps as one field.
inline void add_fields(const SettingsFile& file, const Descriptor& type, const SettingField& outer,
                       std::vector<SettingField>& out) {
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    const SettingField here{&file, &field, outer.path + field.name(), outer.before, outer.after};
    if (field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE || field.is_map()) {
      out.push_back(here);
      continue;
    }
    add_fields(file, *field.message_type(),
               {&file, &field, here.path + (field.is_repeated() ? "[]." : "."),
                outer.before + field.name() + " { ", " }" + outer.after},
               out);
  }
}

/// Returns every field of a settings file.
inline std::vector<SettingField> fields_of(const SettingsFile& file) {
  std::vector<SettingField> out;
  add_fields(file, *file.type, {&file, nullptr, "", "", ""}, out);
  return out;
}

/// Whether a field is a whole number, also one of a list.
inline bool is_whole_number(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_INT32 ||
         field.cpp_type() == FieldDescriptor::CPPTYPE_UINT32;
}

/// Whether a field is a number, also one of a list.
inline bool is_number(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE || is_whole_number(field);
}

}  // namespace handsel::test
