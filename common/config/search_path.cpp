// SPDX-License-Identifier: Apache-2.0
#include "common/config/search_path.hpp"

#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <set>

#include "common/base/errors.hpp"
#include "common/config/described.hpp"
#include "common/config/nearest_name.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/robot.pb.h"
#include "common/config/schema/scenario.pb.h"
#include "common/config/text_check.hpp"
#include "common/config/text_file.hpp"

namespace handsel {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxName = 200;    // max length of a given name in messages [bytes]
constexpr int kMaxEntries = 10'000;      // max entries of a folder that are searched
constexpr const char* kText = ".txtpb";  // extension of Protobuf text
constexpr const char* kVariable = "HANDSEL_PATH";

/// Naming and layout of the files of a kind.
struct Layout {
  const char* word;       ///< name of the kind in messages
  const char* folder;     ///< folder below a folder of the search path
  const char* extension;  ///< extension of the files
  bool nested;            ///< whether a file may lie in a folder of its own name
};

Layout layout_of(FileKind kind) {
  switch (kind) {
    case FileKind::robot:
      return {"robot", "robots", kText, true};
    case FileKind::hand:
      return {"hand", "hands", kText, true};
    case FileKind::object:
      return {"object", "objects", kText, true};
    case FileKind::scenario:
      return {"scenario", "scenarios", kText, false};
    case FileKind::story:
      break;
  }
  return {"story", "stories", ".story", false};
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// Returns whether a text parses as a message of a kind; values are not checked.
bool parses_as(FileKind kind, const std::string& text) {
  class Silent : public google::protobuf::io::ErrorCollector {
    void AddError(int, google::protobuf::io::ColumnNumber, const std::string&) override {}
  } silent;
  std::unique_ptr<google::protobuf::Message> message;
  switch (kind) {
    case FileKind::robot:
      message = std::make_unique<config::RobotDescription>();
      break;
    case FileKind::hand:
      message = std::make_unique<config::HandDescription>();
      break;
    case FileKind::object:
      message = std::make_unique<config::ObjectDescription>();
      break;
    case FileKind::scenario:
      message = std::make_unique<config::Scenario>();
      break;
    case FileKind::story:
      return false;
  }
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&silent);
  parser.SetRecursionLimit(32);
  return parser.ParseFromString(text, message.get());
}

/// Returns whether a file outside a folder of its kind is of another kind.
bool is_of_another_kind(FileKind kind, const fs::path& file) {
  constexpr FileKind kKinds[] = {FileKind::robot, FileKind::hand, FileKind::object,
                                 FileKind::scenario};
  if (file.extension() != kText) return false;
  std::string text;
  try {
    text = read_text_file(file);
  } catch (const std::exception&) {
    return false;  // the reader of the file reports the reason
  }
  return !parses_as(kind, text) &&
         std::any_of(std::begin(kKinds), std::end(kKinds),
                     [&](FileKind other) { return parses_as(other, text); });
}

/// Returns the folder of a kind below a folder of the search path. In the source tree, scenarios
/// and stories lie beside the folder with the descriptions.
fs::path kind_folder(const fs::path& folder, const Layout& layout) {
  fs::path direct = folder / layout.folder;
  std::error_code error;
  if (folder != resource_root() || fs::is_directory(direct, error)) return direct;
  return folder.parent_path() / (layout.nested || layout.extension == std::string(kText)
                                     ? "sim/scenarios"
                                     : "tests/system");
}

/// Returns the possible files of a name in a folder of the search path.
std::vector<fs::path> candidates(FileKind kind, const fs::path& folder, const std::string& name) {
  const Layout layout = layout_of(kind);
  const fs::path own = kind_folder(folder, layout);
  const bool with_extension = fs::path(name).has_extension();
  std::vector<fs::path> out;
  for (const fs::path& place : {own, folder}) {
    if (place == folder && folder == resource_root()) break;
    if (layout.nested) out.push_back(place / name / (name + layout.extension));
    out.push_back(place / (name + layout.extension));
    if (with_extension) out.push_back(place / name);
  }
  return out;
}

/// Adds the files of a kind that lie in a folder, or in a folder of their own name inside.
void add_files(const Layout& layout, const fs::path& folder, std::vector<fs::path>& out) {
  std::error_code error;
  std::vector<fs::path> found;
  int entries = 0;
  for (fs::directory_iterator at(folder, error), end; !error && at != end && entries < kMaxEntries;
       at.increment(error), ++entries) {
    const fs::path nested = at->path() / (at->path().filename().string() + layout.extension);
    if (at->path().extension() == layout.extension && is_file(at->path()))
      found.push_back(at->path());
    else if (layout.nested && is_file(nested))
      found.push_back(nested);
  }
  std::sort(found.begin(), found.end());
  out.insert(out.end(), found.begin(), found.end());
}

[[noreturn]] void refuse(FileKind kind, const std::string& name) {
  const Layout layout = layout_of(kind);
  std::vector<std::string> names, folders;
  for (const fs::path& file : all_files(kind)) names.push_back(file.stem());
  std::sort(names.begin(), names.end());
  for (const fs::path& folder : search_folders())
    folders.push_back(folder == resource_root() ? kind_folder(folder, layout) : folder);
  const std::vector<std::string> nearest = nearest_names(name, names);
  throw MissingError("no " + std::string(layout.word) + " \"" + printable(name, kMaxName) +
                     "\"; there is: " + (names.empty() ? "none" : joined(names)) +
                     (nearest.empty() ? "" : "; the nearest: " + joined(nearest)) +
                     "; searched in " + joined(folders));
}

}  // namespace

std::vector<fs::path> search_folders() {
  std::vector<fs::path> out;
  const auto add = [&](const fs::path& folder) {
    if (std::find(out.begin(), out.end(), folder) == out.end()) out.push_back(folder);
  };
  if (const char* text = std::getenv(kVariable); text != nullptr) {
    const std::string all = text;
    for (std::size_t begin = 0; begin <= all.size();) {
      const std::size_t end = std::min(all.find(':', begin), all.size());
      const std::string folder = all.substr(begin, end - begin);
      std::error_code error;
      if (!folder.empty()) {
        const fs::path real = fs::canonical(folder, error);
        if (error || !fs::is_directory(real, error))
          throw MissingError(std::string(kVariable) + " names " + printable(folder, kMaxName) +
                             ", which is no folder");
        add(real);
      }
      begin = end + 1;
    }
  }
  std::error_code error;
  const fs::path working = fs::current_path(error);
  if (!error) add(working);
  const fs::path root = resource_root();
  std::erase(out, root);
  out.push_back(root);
  return out;
}

void search_first(const std::vector<std::string>& folders) {
  std::string all;
  for (const std::string& folder : folders) {
    std::error_code error;
    const fs::path real = fs::canonical(folder, error);
    if (error || !fs::is_directory(real, error))
      throw MissingError("--path " + printable(folder, kMaxName) + ": no such folder");
    if (real.string().find(':') != std::string::npos)
      throw ConfigError("--path " + printable(folder, kMaxName) +
                        ": a folder of the search path must have no colon in its name");
    all += (all.empty() ? "" : ":") + real.string();
  }
  const char* before = std::getenv(kVariable);
  if (before != nullptr && *before != '\0') all += (all.empty() ? "" : ":") + std::string(before);
  if (!all.empty()) setenv(kVariable, all.c_str(), 1);
}

fs::path find_file(FileKind kind, const std::string& name_or_path) {
  const Layout layout = layout_of(kind);
  if (is_path(name_or_path) || name_or_path.ends_with(layout.extension)) {
    if (is_there(name_or_path)) return name_or_path;
    if (name_or_path.starts_with('/') || name_or_path.starts_with('.'))
      throw MissingError("no " + std::string(layout.word) + " description " +
                         printable(name_or_path, kMaxName));
  }
  if (!name_or_path.empty() && name_or_path.size() <= kMaxName)
    for (const fs::path& folder : search_folders())
      for (const fs::path& file : candidates(kind, folder, name_or_path)) {
        if (!is_file(file)) continue;
        const bool in_its_folder =
            file.string().starts_with((kind_folder(folder, layout) / "").string());
        if (in_its_folder || !is_of_another_kind(kind, file)) return file;
      }
  refuse(kind, name_or_path);
}

std::vector<fs::path> all_files(FileKind kind) {
  const Layout layout = layout_of(kind);
  std::vector<fs::path> out;
  std::set<std::string> known;
  for (const fs::path& folder : search_folders()) {
    std::vector<fs::path> here, loose;
    add_files(layout, kind_folder(folder, layout), here);
    if (folder != resource_root()) add_files(layout, folder, loose);
    std::erase_if(loose, [&](const fs::path& file) { return is_of_another_kind(kind, file); });
    here.insert(here.end(), loose.begin(), loose.end());
    for (const fs::path& file : here)
      if (known.insert(file.stem()).second) out.push_back(file);
  }
  return out;
}

std::vector<fs::path> files_of_user(const std::string& folder) {
  std::vector<fs::path> folders = search_folders(), out;
  std::reverse(folders.begin(), folders.end());
  for (const fs::path& each : folders)
    if (each != resource_root()) add_files({"", "", kText, false}, each / folder, out);
  return out;
}

}  // namespace handsel
