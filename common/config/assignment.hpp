// SPDX-License-Identifier: Apache-2.0
// One setting as a command line gives it: "component.key=value".
#pragma once

#include <string>

namespace handsel {

/// Returns an assignment as Protobuf text of config::SettingsOverlay. Keys of messages inside are
/// separated by dots; an entry of a list is named behind the list:
/// "attention.behaviours.give.p_min". Values of a list of plain values are separated by commas.
/// Throws ConfigError that names the assignment, the key, and what would be right: the nearest
/// keys, the type, the range.
std::string assignment_text(const std::string& assignment);

}  // namespace handsel
