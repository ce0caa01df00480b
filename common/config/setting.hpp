// SPDX-License-Identifier: Apache-2.0
// What the schema states about a setting: the options of schema/options.proto.
#pragma once

#include <string>

#include <google/protobuf/descriptor.h>

namespace handsel {

/// Limit of the absolute value of a number without limits of its own. SI units: nothing here is
/// larger.
inline constexpr double kLargestNumber = 1e6;

/// One field of a settings file, or of a description.
struct Setting {
  std::string unit;             ///< SI; "1": a pure number; empty: no number, or not stated
  double min{-kLargestNumber};  ///< smallest number allowed [unit]
  double max{kLargestNumber};   ///< largest number allowed [unit]
  bool above_min{false};        ///< `min` itself is refused
  bool has_range{false};        ///< whether the schema states `min` and `max`
  bool has_default{false};      ///< whether the schema states a default value
  bool required{false};         ///< a file must give a value
  std::string default_value;    ///< as a file writes it, text without quotes
  std::string doc;              ///< what it is, one phrase
};

/// Returns what the schema states about a field; about a value of a map, what it states about the
/// map.
Setting setting_of(const google::protobuf::FieldDescriptor& field);

/// Returns whether a number is finite and in the range of a setting.
bool is_allowed(double value, const Setting& setting);

/// Returns the range as mathematicians write it: "(0, 10]".
std::string range_text(const Setting& setting);

/// Returns a number with up to six digits.
std::string short_form(double value);

}  // namespace handsel
