// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/offline/settings_list.hpp"

#include <cstdio>
#include <map>
#include <memory>

#include "common/config/overlay.hpp"
#include "common/config/resources.hpp"
#include "common/config/text_file.hpp"

namespace handsel {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using google::protobuf::TextFormat;
using Places = TextFormat::ParseInfoTree;

/// A place in the settings: by index, as in sources, and by name, for display.
struct Place {
  std::string by_index, by_name;
  const Places* places{};  ///< positions in the shipped text; nullptr: only in an overlay
  std::string source;      ///< source of a list entry that an overlay added; empty: none
};

class Lister {
 public:
  Lister(std::string file, std::shared_ptr<const SettingSources> overlaid)
      : file_(std::move(file)), overlaid_(std::move(overlaid)) {}

  void list(const Message& message, const Place& at) {
    const Reflection& get = *message.GetReflection();
    for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
      const FieldDescriptor& field = *message.GetDescriptor()->field(i);
      const bool is_message = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
      if (field.is_repeated()) {
        for (int k = 0; k < get.FieldSize(message, &field); ++k)
          is_message
              ? list(get.GetRepeatedMessage(message, &field, k), inside(message, field, k, at))
              : add(message, field, k, at);
      } else if (is_message) {
        if (get.HasField(message, &field))
          list(get.GetMessage(message, &field), inside(message, field, -1, at));
      } else if (!field.has_presence() || get.HasField(message, &field)) {
        add(message, field, -1, at);
      }
    }
  }

  std::vector<ListedSetting> take() { return std::move(out_); }

 private:
  Place inside(const Message& message, const FieldDescriptor& field, int index, const Place& at) {
    Place out{setting_path(at.by_index, field, index), at.by_name + "." + field.name(),
              at.places != nullptr ? at.places->GetTreeForNested(&field, index) : nullptr,
              at.source};
    if (overlaid_ != nullptr)
      if (const auto known = overlaid_->find(out.by_index); known != overlaid_->end())
        out.source = known->second;
    if (index < 0) return out;
    const Message& entry = message.GetReflection()->GetRepeatedMessage(message, &field, index);
    const std::string key = entry_key(*field.message_type());
    out.by_name += key.empty() ? "[" + std::to_string(index) + "]"
                               : "." + entry.GetReflection()->GetString(
                                           entry, field.message_type()->FindFieldByName(key));
    return out;
  }

  void add(const Message& message, const FieldDescriptor& field, int index, const Place& at) {
    ListedSetting one;
    one.path =
        at.by_name + "." + field.name() + (index < 0 ? "" : "[" + std::to_string(index) + "]");
    TextFormat::PrintFieldValueToString(message, &field, index, &one.value);
    one.source = source_of(field, index, at);
    out_.push_back(std::move(one));
  }

  std::string source_of(const FieldDescriptor& field, int index, const Place& at) const {
    if (overlaid_ != nullptr) {
      const auto known = overlaid_->find(setting_path(at.by_index, field, index));
      if (known != overlaid_->end()) return known->second;
    }
    if (!at.source.empty()) return at.source;
    const int line = at.places != nullptr ? at.places->GetLocation(&field, index).line : -1;
    return line < 0 ? "default" : file_ + ":" + std::to_string(line + 1);
  }

  std::string file_;
  std::shared_ptr<const SettingSources> overlaid_;
  std::vector<ListedSetting> out_;
};

}  // namespace

std::vector<ListedSetting> list_settings(const std::string& component, bool with_overlays) {
  const std::unique_ptr<Message> settings = settings_of(component);
  const std::string file = resource("config/" + component + ".txtpb").string();
  Places places;
  parse_text_proto(read_text_file(file), file, *settings, places);
  if (with_overlays) put_overlays_over(*settings);
  Lister lister(file, with_overlays ? overlay_sources(settings->GetDescriptor()) : nullptr);
  lister.list(*settings, {"", component, &places, ""});
  return lister.take();
}

std::vector<ChangedSetting> changed_settings(const std::string& component) {
  std::map<std::string, std::string> shipped;
  for (const ListedSetting& one : list_settings(component, false)) shipped[one.path] = one.value;
  std::vector<ChangedSetting> out;
  for (const ListedSetting& one : list_settings(component, true)) {
    const auto known = shipped.find(one.path);
    if (known != shipped.end() && known->second == one.value) continue;
    out.push_back({one, known == shipped.end() ? "" : known->second});
  }
  return out;
}

void report_changed_settings() {
  std::size_t count = 0;
  std::string first;
  for (const std::string& component : settings_components())
    for (const ChangedSetting& one : changed_settings(component))
      if (count++ == 0) first = one.path + ": " + one.value + " (" + one.source + ")";
  if (count > 0)
    std::fprintf(
        stderr, "%zu %s from the shipped settings, as %s; `handsel config diff` lists %s\n", count,
        count == 1 ? "value differs" : "values differ", first.c_str(), count == 1 ? "it" : "them");
}

}  // namespace handsel
