// SPDX-License-Identifier: Apache-2.0
// The IDL as text, for viewers and recordings: what a reader of the raw samples needs to know.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "common/topics/topics.hpp"

namespace handsel {

/// Returns the files of idl/, compiled in: name ("robot.idl") and text.
std::map<std::string, std::string_view> idl_files();

/// Returns one self-contained IDL text that defines the row's struct in module handsel: what its
/// file includes stands in it, once, before its use; no line of a preprocessor is left. Throws
/// std::logic_error when no file defines the struct.
std::string idl_schema(const TopicRow& row);

/// Returns the type's name in a schema: "handsel::RobotState".
inline std::string idl_name(const TopicRow& row) { return std::string("handsel::") + row.type; }

}  // namespace handsel
