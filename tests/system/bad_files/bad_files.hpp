// SPDX-License-Identifier: Apache-2.0
// A table of bad files: the content of each, the command that reads the file, and the required
// refusal.
#pragma once

#include <string>
#include <vector>

namespace handsel::test {

/// One bad file. In `command`, {} stands for the file and {folder} for its folder, which is the
/// row's own.
struct BadFile {
  std::string
      name;  ///< of the row, and of the file: "mesh/cut.ply"; the part before / is the parser
  std::string content;  ///< of the file
  std::string command;  ///< "grasp placements --object {}"; begins with handsel_ for a component
  std::string says;     ///< part of the sentence on stderr, or, of JSON Lines, in the answer
  int exit_code{2};
  std::string input{};  ///< on stdin
  enum class Kind { file, folder, missing, unreadable } kind{Kind::file};
};

using BadFiles = std::vector<BadFile>;

/// Rows by parser; each adds to the table.
void add_meshes(BadFiles& table);
void add_descriptions(BadFiles& table);
void add_settings(BadFiles& table);
void add_scenarios(BadFiles& table);
void add_recordings(BadFiles& table);
void add_lines(BadFiles& table);

/// `text` with the first `from` replaced; ends the test program when there is none, so that a row
/// never is good by mistake.
std::string with(std::string text, const std::string& from, const std::string& to);
/// Returns `text`, `times` times in succession.
std::string repeated(const std::string& text, int times);
/// The content of a file of the source tree.
std::string source_file(const std::string& path);

}  // namespace handsel::test
