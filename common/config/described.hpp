// SPDX-License-Identifier: Apache-2.0
// Paths and names as descriptions and scenarios write them.
#pragma once

#include <filesystem>
#include <string>

namespace handsel {

/// Returns whether a text is a path, with "/" or ending in ".txtpb", and not a name.
bool is_path(const std::string& name);

/// A path as a description writes it: "$NAME/rest" and "${NAME}/rest" begin with an environment
/// variable's value, the others are relative to the description's folder. Throws MissingError when
/// the variable is not set.
std::filesystem::path described_path(const std::filesystem::path& description,
                                     const std::string& path);
/// Returns a text with "/" or ending in ".txtpb" as described_path() does, any other unchanged: it
/// is a name. Throws MissingError like described_path().
std::string described_name(const std::filesystem::path& description,
                           const std::string& name_or_path);

}  // namespace handsel
