// SPDX-License-Identifier: Apache-2.0
#include "common/config/resources.hpp"

#include <dlfcn.h>
#include <google/protobuf/text_format.h>

#include <cstdlib>
#include <fstream>

#include "common/config/defaults.hpp"
#include "common/config/described.hpp"
#include "common/config/located.hpp"
#include "common/config/overlay.hpp"
#include "common/config/parse_error.hpp"
#include "common/config/search_path.hpp"
#include "common/config/text_check.hpp"
#include "common/config/text_file.hpp"

namespace handsel {
namespace fs = std::filesystem;
namespace {

/// Returns the absolute path of the program or shared library that holds this code: in a Python
/// process the library; empty when it is not known.
fs::path code_file() {
  Dl_info info{};
  static const char inside{};
  if (dladdr(&inside, &info) == 0 || info.dli_fname == nullptr) return {};
  std::error_code error;
  const fs::path file = fs::canonical(info.dli_fname, error);
  return error ? fs::path() : file;
}

fs::path find_root() {
  if (const char* home = std::getenv("HANDSEL_HOME"); home != nullptr && *home != '\0') {
    if (fs::is_directory(fs::path(home) / "robots")) return fs::canonical(home);
    throw MissingError("HANDSEL_HOME is " + std::string(home) + ", which has no folder robots/");
  }
  std::error_code error;
  const fs::path executable = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& file : {executable, code_file()}) {
    for (fs::path folder = file.parent_path(); !folder.empty(); folder = folder.parent_path()) {
      for (const char* below : {"deploy", "share/handsel"})
        if (fs::is_directory(folder / below / "robots")) return folder / below;
      if (folder == folder.parent_path()) break;
    }
  }
  throw MissingError("no folder deploy/ or share/handsel beside or above " + executable.string() +
                     "; set HANDSEL_HOME to it");
}

}  // namespace

bool is_path(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".txtpb");
}

fs::path resource_root() {
  static const fs::path root = find_root();
  return root;
}

fs::path resource(const std::string& relative) {
  fs::path file = resource_root() / relative;
  if (!fs::exists(file)) throw MissingError("file " + file.string() + " does not exist");
  return file;
}

void parse_strict(const std::string& text, const std::string& name, google::protobuf::Message& out,
                  google::protobuf::TextFormat::ParseInfoTree& places) {
  if (const std::size_t first = text.find_first_not_of(" \t\r\n");
      first != std::string::npos && text[first] == '<')
    throw ConfigError(name +
                      " is XML, e.g. a URDF; a description in Protobuf text is needed here, which "
                      "may name it (docs/own_robot.md)");
  constexpr int kMaxDepth = 32;
  FirstError error;
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&error);
  parser.SetRecursionLimit(kMaxDepth);
  parser.WriteLocationsTo(&places);
  if (!parser.ParseFromString(text, &out))
    throw ConfigError(name + ":" + error.explain(text, *out.GetDescriptor()));
  check_text(out, places, name);
}

void load_text_proto(const fs::path& file, google::protobuf::Message& out) {
  google::protobuf::TextFormat::ParseInfoTree places;
  load_text_proto(file, out, places);
}

void load_text_proto(const fs::path& file, google::protobuf::Message& out,
                     google::protobuf::TextFormat::ParseInfoTree& places) {
  parse_text_proto(read_text_file(file), file.string(), out, places);
  put_overlays_over(out);
}

void parse_text_proto(const std::string& text, const std::string& name,
                      google::protobuf::Message& out,
                      google::protobuf::TextFormat::ParseInfoTree& places) {
  parse_strict(text, name, out, places);
  take_defaults(out, places, name);
}

TextPlace::TextPlace(std::string file, const google::protobuf::TextFormat::ParseInfoTree* tree,
                     const google::protobuf::Descriptor* type)
    : file_(std::move(file)), tree_(tree), type_(type), overlaid_(overlay_sources(type)) {}

TextPlace TextPlace::inside(const std::string& field, int index) const {
  TextPlace out;
  out.file_ = file_;
  const auto* descriptor = type_ != nullptr ? type_->FindFieldByName(field) : nullptr;
  if (descriptor == nullptr) return out;
  const int at = descriptor->is_repeated() ? index : -1;
  out.tree_ = tree_ != nullptr ? tree_->GetTreeForNested(descriptor, at) : nullptr;
  out.type_ = descriptor->message_type();
  out.overlaid_ = overlaid_;
  out.path_ = setting_path(path_, *descriptor, at);
  return out;
}

std::string TextPlace::of(const std::string& field, int index) const {
  const auto* descriptor = type_ != nullptr ? type_->FindFieldByName(field) : nullptr;
  int line = -1;
  if (overlaid_ != nullptr && descriptor != nullptr) {
    auto source =
        overlaid_->find(setting_path(path_, *descriptor, descriptor->is_repeated() ? index : -1));
    if (source == overlaid_->end()) source = overlaid_->find(path_);
    if (source != overlaid_->end()) return source->second + ":" + field;
  }
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
  return find_file(FileKind::robot, name_or_path);
}
fs::path hand_description(const std::string& name_or_path) {
  return find_file(FileKind::hand, name_or_path);
}
fs::path object_description(const std::string& name_or_path) {
  return find_file(FileKind::object, name_or_path);
}
fs::path scenario_file(const std::string& name_or_path) {
  return find_file(FileKind::scenario, name_or_path);
}

}  // namespace handsel
