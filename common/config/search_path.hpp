// SPDX-License-Identifier: Apache-2.0
// Where the files of a user are searched: robots, hands, objects, scenarios, stories, behaviours,
// tasks and settings by name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace handsel {

/// A kind of file that is searched by its name.
enum class FileKind { robot, hand, object, scenario, story };

/// Returns the folders in which names are searched, the first that has one wins: those of
/// $HANDSEL_PATH (colons between them), the working directory, resource_root(). Absolute, each
/// once. Throws MissingError for a folder of $HANDSEL_PATH that is not there.
std::vector<std::filesystem::path> search_folders();

/// Puts folders before $HANDSEL_PATH, for this process and those that it starts. Throws
/// MissingError for a folder that is not there, ConfigError for one whose name has a colon.
void search_first(const std::vector<std::string>& folders);

/// Returns the file that a name stands for, or a path as given. In a folder F of the search path, a
/// robot "N" is F/robots/N/N.txtpb, F/robots/N.txtpb, F/N/N.txtpb or F/N.txtpb; a file of another
/// kind in the last two places is passed over. A name with an extension may also be that of a file
/// in F or F/robots. Throws MissingError with the nearest names and the folders that were searched.
std::filesystem::path find_file(FileKind kind, const std::string& name_or_path);

/// Returns every file of a kind, in the order of the search path: of equal names the first.
std::vector<std::filesystem::path> all_files(FileKind kind);

/// Returns the text files (.txtpb) directly in F/`folder` of the search path, without those of
/// resource_root(); the last has precedence over those before.
std::vector<std::filesystem::path> files_of_user(const std::string& folder);

}  // namespace handsel
