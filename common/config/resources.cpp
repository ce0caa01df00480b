#include "common/config/resources.hpp"

#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "common/config/defaults.hpp"
#include "common/config/described.hpp"
#include "common/config/located.hpp"
#include "common/config/parse_error.hpp"
#include "common/config/text_check.hpp"
#include "common/config/text_file.hpp"

namespace handsel {
namespace fs = std::filesystem;
namespace {

fs::path find_root() {
  if (const char* home = std::getenv("HANDSEL_HOME"); home != nullptr && *home != '\0') {
    if (fs::is_directory(fs::path(home) / "robots")) return fs::canonical(home);
    throw MissingError("HANDSEL_HOME is " + std::string(home) + ", which has no folder robots/");
  }
  std::error_code error;
  const fs::path executable = fs::read_symlink("/proc/self/exe", error);
  for (fs::path folder = executable.parent_path(); !error; folder = folder.parent_path()) {
    for (const char* below : {"deploy", "share/handsel"})
      if (fs::is_directory(folder / below / "robots")) return folder / below;
    if (folder == folder.parent_path()) break;
  }
  throw MissingError("no folder deploy/ or share/handsel beside or above " + executable.string() +
                     "; set HANDSEL_HOME to it");
}

bool is_path(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".txtpb");
}

std::string alternatives(const fs::path& folder, bool nested) {
  std::vector<std::string> names;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string stem = entry.path().stem().string();
      if (nested ? fs::exists(entry.path() / (stem + ".txtpb"))
                 : entry.path().extension() == ".txtpb")
        names.push_back(stem);
    }
  std::sort(names.begin(), names.end());
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "none" : list;
}

constexpr std::size_t kMaxName = 200;  // [bytes] shown of a name that somebody gave

/// A path as it is; a name as <folder>/<name>/<name>.txtpb (nested) or <folder>/<name>.txtpb.
fs::path description(const std::string& kind, const fs::path& folder, bool nested,
                     const std::string& name_or_path) {
  if (is_path(name_or_path)) {
    if (!is_there(name_or_path))
      throw MissingError("no " + kind + " description " + printable(name_or_path, kMaxName));
    return name_or_path;
  }
  fs::path file = nested ? folder / name_or_path / (name_or_path + ".txtpb")
                         : folder / (name_or_path + ".txtpb");
  if (name_or_path.empty() || !is_there(file))
    throw MissingError("no " + kind + " \"" + printable(name_or_path, kMaxName) +
                       "\"; there is: " + alternatives(folder, nested));
  return file;
}

}  // namespace

fs::path resource_root() {
  static const fs::path root = find_root();
  return root;
}

fs::path resource(const std::string& relative) {
  fs::path file = resource_root() / relative;
  if (!fs::exists(file)) throw MissingError("no file " + file.string());
  return file;
}

namespace {

void parse(const std::string& text, const std::string& name, google::protobuf::Message& out,
           google::protobuf::TextFormat::ParseInfoTree* places) {
  if (const std::size_t first = text.find_first_not_of(" \t\r\n");
      first != std::string::npos && text[first] == '<')
    throw ConfigError(name +
                      " is XML, e.g. a URDF; a description in Protobuf text is needed here, which "
                      "may name it (docs/own_robot.md)");
  constexpr int kMaxDepth = 32;
  FirstError error;
  google::protobuf::TextFormat::Parser parser;
  google::protobuf::TextFormat::ParseInfoTree own;
  parser.RecordErrorsTo(&error);
  parser.SetRecursionLimit(kMaxDepth);
  if (places == nullptr) places = &own;
  parser.WriteLocationsTo(places);
  if (!parser.ParseFromString(text, &out))
    throw ConfigError(name + ":" + error.explain(text, *out.GetDescriptor()));
  check_text(out, *places, name);
  take_defaults(out, *places, name);
}

}  // namespace

void load_text_proto(const fs::path& file, google::protobuf::Message& out) {
  parse(read_text_file(file), file.string(), out, nullptr);
}

void load_text_proto(const fs::path& file, google::protobuf::Message& out,
                     google::protobuf::TextFormat::ParseInfoTree& places) {
  parse(read_text_file(file), file.string(), out, &places);
}

void parse_text_proto(const std::string& text, const std::string& name,
                      google::protobuf::Message& out,
                      google::protobuf::TextFormat::ParseInfoTree& places) {
  parse(text, name, out, &places);
}

TextPlace TextPlace::inside(const std::string& field, int index) const {
  const auto* descriptor = type_ != nullptr ? type_->FindFieldByName(field) : nullptr;
  if (descriptor == nullptr) return {file_, nullptr, nullptr};
  return {file_,
          tree_ != nullptr
              ? tree_->GetTreeForNested(descriptor, descriptor->is_repeated() ? index : -1)
              : nullptr,
          descriptor->message_type()};
}

std::string TextPlace::of(const std::string& field, int index) const {
  const auto* descriptor = type_ != nullptr ? type_->FindFieldByName(field) : nullptr;
  int line = -1;
  if (tree_ != nullptr && descriptor != nullptr) {
    line = tree_->GetLocation(descriptor, descriptor->is_repeated() ? index : -1).line;
    if (line < 0 && descriptor->is_repeated())
      line =
          tree_->GetLocation(descriptor, 0).line;  // of a list in brackets only the first is known
  }
  return file_ + (line < 0 ? "" : ":" + std::to_string(line + 1)) + ":" + field;
}

std::string locate(const fs::path& file, const std::string& text) {
  std::ifstream in(file);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number)
    if (line.find(text) != std::string::npos) return file.string() + ":" + std::to_string(number);
  return file.string();
}

fs::path described_path(const fs::path& description, const std::string& path) {
  if (!path.starts_with('$')) return description.parent_path() / path;
  const std::size_t end = path.find('/');
  std::string name = path.substr(1, end == std::string::npos ? end : end - 1);
  if (name.starts_with('{') && name.ends_with('}')) name = name.substr(1, name.size() - 2);
  const char* value = std::getenv(name.c_str());
  if (value == nullptr || *value == '\0')
    throw MissingError(locate(description, path) + ": " + path +
                       " needs the environment variable " + name + ", which is not set");
  return fs::path(value) / (end == std::string::npos ? "" : path.substr(end + 1));
}

std::string described_name(const fs::path& description, const std::string& name_or_path) {
  return is_path(name_or_path) ? described_path(description, name_or_path).string() : name_or_path;
}

fs::path robot_description(const std::string& name_or_path) {
  return description("robot", resource_root() / "robots", true, name_or_path);
}
fs::path hand_description(const std::string& name_or_path) {
  return description("hand", resource_root() / "hands", true, name_or_path);
}
fs::path object_description(const std::string& name_or_path) {
  return description("object", resource_root() / "objects", true, name_or_path);
}

fs::path scenario_file(const std::string& name_or_path) {
  if (is_path(name_or_path)) return description("scenario", {}, false, name_or_path);
  fs::path folder = resource_root() / "scenarios";
  if (!fs::is_directory(folder)) folder = resource_root().parent_path() / "sim" / "scenarios";
  return description("scenario", folder, false, name_or_path);
}

}  // namespace handsel
