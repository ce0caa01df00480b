// SPDX-License-Identifier: Apache-2.0
#include "common/config/setting.hpp"

#include <cmath>
#include <cstdio>

#include "common/config/schema/options.pb.h"

namespace handsel {

namespace {

using google::protobuf::FieldDescriptor;

/// Returns the map field whose value a field is, otherwise the field itself.
const FieldDescriptor& map_of(const FieldDescriptor& field) {
  const auto& entry = *field.containing_type();
  if (!entry.options().map_entry() || field.number() != entry.map_value()->number()) return field;
  const auto& outer = *entry.containing_type();
  for (int i = 0; i < outer.field_count(); ++i)
    if (outer.field(i)->message_type() == &entry) return *outer.field(i);
  return field;
}

}  // namespace

Setting setting_of(const FieldDescriptor& field) {
  const auto& options = map_of(field).options();
  Setting s;
  s.unit = options.GetExtension(config::unit);
  s.has_range = options.HasExtension(config::min) && options.HasExtension(config::max);
  if (options.HasExtension(config::min)) s.min = options.GetExtension(config::min);
  if (options.HasExtension(config::max)) s.max = options.GetExtension(config::max);
  s.above_min = options.GetExtension(config::above_min);
  s.has_default = options.HasExtension(config::default_value);
  s.default_value = options.GetExtension(config::default_value);
  s.required = options.GetExtension(config::required);
  s.doc = options.GetExtension(config::doc);
  return s;
}

bool is_allowed(double value, const Setting& setting) {
  if (!std::isfinite(value) || value > setting.max) return false;
  return setting.above_min ? value > setting.min : value >= setting.min;
}

std::string range_text(const Setting& setting) {
  return (setting.above_min ? "(" : "[") + short_form(setting.min) + ", " +
         short_form(setting.max) + "]";
}

std::string short_form(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace handsel
