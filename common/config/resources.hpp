// SPDX-License-Identifier: Apache-2.0
// Finding and reading the files under deploy/ (or share/handsel once installed).
#pragma once

#include <filesystem>
#include <string>

#include <google/protobuf/message.h>

#include "common/base/errors.hpp"

namespace handsel {

/// Root of robots/, hands/, objects/, config/, scenarios/: $HANDSEL_HOME, else found from the
/// executable (build tree: the source's deploy/; installed: ../share/handsel). Throws MissingError.
std::filesystem::path resource_root();
/// resource_root()/relative; throws MissingError naming it when it is not there.
std::filesystem::path resource(const std::string& relative);
/// Reads strict Protobuf text. Fields that are left out get the default value of the schema.
/// Unknown keys, wrong types, numbers out of range and duplicates throw ConfigError "file:line:key:
/// what".
void load_text_proto(const std::filesystem::path& file, google::protobuf::Message& out);
/// "file:line" of the first line that contains `text` (e.g. a quoted name), or "file": says where a
/// wrong value stands.
std::string locate(const std::filesystem::path& file, const std::string& text);

/// Returns the description of a robot, from its name ("jido") or a path: find_file() of
/// search_path.hpp. Throws MissingError.
std::filesystem::path robot_description(const std::string& name_or_path);
/// Returns the description of a hand, as robot_description().
std::filesystem::path hand_description(const std::string& name_or_path);
/// Returns the description of an object, as robot_description().
std::filesystem::path object_description(const std::string& name_or_path);
/// Returns a scenario, as robot_description().
std::filesystem::path scenario_file(const std::string& name_or_path);

}  // namespace handsel
