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

/// "jido" or a path to a .txtpb -> path of the description. MissingError lists what there is.
std::filesystem::path robot_description(const std::string& name_or_path);
/// Returns hands/<name>/<name>.txtpb, or a path as given. Throws MissingError, for a name with the
/// list of those there are.
std::filesystem::path hand_description(const std::string& name_or_path);
/// Returns objects/<name>/<name>.txtpb, or a path as given. Throws MissingError as
/// hand_description().
std::filesystem::path object_description(const std::string& name_or_path);
/// Returns scenarios/<name>.txtpb (sim/scenarios of the source tree where resource_root() has no
/// such folder), or a path as given. Throws MissingError as hand_description().
std::filesystem::path scenario_file(const std::string& name_or_path);

}  // namespace handsel
