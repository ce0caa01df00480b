// SPDX-License-Identifier: Apache-2.0
// The settings of a component as a list, with the source of each value.
#pragma once

#include <string>
#include <vector>

namespace handsel {

/// One value.
struct ListedSetting {
  std::string path;    ///< as `--set` names the setting: "spark.grip_force"
  std::string value;   ///< as a file writes it
  std::string source;  ///< "file:line", "--set key=value", or "default": of the schema
};

/// Returns the settings of a component with all overlays (`with_overlays`), else as shipped. Throws
/// ConfigError for an unknown component, ConfigError and MissingError as the component would.
std::vector<ListedSetting> list_settings(const std::string& component, bool with_overlays);

/// A setting whose value is not the shipped one.
struct ChangedSetting : ListedSetting {
  std::string shipped;  ///< value; empty: not in the shipped settings
};

/// Returns the settings of a component that overlays change. Throws as list_settings().
std::vector<ChangedSetting> changed_settings(const std::string& component);

/// Prints to stderr how many settings of all components differ from the shipped ones; nothing when
/// none does. Throws as list_settings().
void report_changed_settings();

}  // namespace handsel
