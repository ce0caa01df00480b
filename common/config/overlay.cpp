// SPDX-License-Identifier: Apache-2.0
#include "common/config/overlay.hpp"

#include <algorithm>
#include <map>
#include <mutex>

#include "common/base/errors.hpp"
#include "common/config/assignment.hpp"
#include "common/config/defaults.hpp"
#include "common/config/nearest_name.hpp"
#include "common/config/schema/overlay.pb.h"
#include "common/config/search_path.hpp"
#include "common/config/text_file.hpp"

namespace handsel {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using Places = google::protobuf::TextFormat::ParseInfoTree;

/// One source of settings.
struct Layer {
  std::string name;                  ///< name of the file, or "--set key=value"
  bool has_lines{};                  ///< whether the name refers to a file
  std::unique_ptr<Message> message;  ///< config::SettingsOverlay, or settings of one component
  std::unique_ptr<Places> places;    ///< positions in the text
};

/// Settings in use in this process.
struct State {
  std::mutex mutex;
  std::vector<std::shared_ptr<const Layer>> layers;  ///< from the command line
  std::vector<std::string> arguments;                ///< equivalent arguments of a process
  std::map<const Descriptor*, std::shared_ptr<const SettingSources>> sources;  ///< by type
};

State& state() {
  static State all;
  return all;
}

const FieldDescriptor* component_of(const Descriptor* type) {
  const Descriptor& all = *config::SettingsOverlay::descriptor();
  for (int i = 0; i < all.field_count(); ++i)
    if (all.field(i)->message_type() == type) return all.field(i);
  return nullptr;
}

/// Applies one layer to a component's settings and records the source of each value.
class Put {
 public:
  Put(const Layer& layer, SettingSources& sources) : layer_(layer), sources_(sources) {}

  void put(Message& into, const Message& from, const Places* places, const std::string& path) {
    const Reflection& get = *from.GetReflection();
    for (int i = 0; i < from.GetDescriptor()->field_count(); ++i) {
      const FieldDescriptor& field = *from.GetDescriptor()->field(i);
      const bool is_message = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
      if (field.is_repeated()) {
        if (get.FieldSize(from, &field) > 0) put_list(into, from, field, places, path);
      } else if (is_message) {
        if (get.HasField(from, &field)) put_inside(into, from, field, places, path);
      } else if (places != nullptr && places->GetLocation(&field, -1).line >= 0) {
        copy(into, from, field);
        note(field, -1, places, path);
      }
    }
  }

 private:
  static void copy(Message& into, const Message& from, const FieldDescriptor& field) {
    const std::unique_ptr<Message> all(from.New());
    all->CopyFrom(from);
    from.GetReflection()->SwapFields(&into, all.get(), {&field});
  }

  void put_inside(Message& into, const Message& from, const FieldDescriptor& field,
                  const Places* places, const std::string& path) {
    const Reflection& get = *from.GetReflection();
    const Places* inside = places != nullptr ? places->GetTreeForNested(&field, -1) : nullptr;
    const bool is_new = !get.HasField(into, &field);
    Message& target = *get.MutableMessage(&into, &field);
    put(target, get.GetMessage(from, &field), inside, setting_path(path, field, -1));
    if (is_new && inside != nullptr) take_defaults(target, *inside, layer_.name);
  }

  void put_list(Message& into, const Message& from, const FieldDescriptor& list,
                const Places* places, const std::string& path) {
    const Reflection& get = *from.GetReflection();
    const bool is_message = list.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    const std::string key = is_message ? entry_key(*list.message_type()) : std::string();
    if (key.empty()) get.ClearField(&into, &list);
    if (!is_message) {
      copy(into, from, list);
      for (int i = 0; i < get.FieldSize(from, &list); ++i) note(list, i, places, path);
      return;
    }
    const FieldDescriptor* key_field = list.message_type()->FindFieldByName(key);
    for (int i = 0; i < get.FieldSize(from, &list); ++i) {
      const Message& entry = get.GetRepeatedMessage(from, &list, i);
      const Places* inside = places != nullptr ? places->GetTreeForNested(&list, i) : nullptr;
      int at = key_field != nullptr ? index_of(into, list, *key_field, entry) : -1;
      const bool is_new = at < 0;
      if (is_new) at = get.FieldSize(into, &list), get.AddMessage(&into, &list);
      Message& target = *get.MutableRepeatedMessage(&into, &list, at);
      if (is_new || list.is_map()) note(list, at, places, path, i);
      if (list.is_map())
        target.CopyFrom(entry);
      else
        put(target, entry, inside, setting_path(path, list, at));
      if (is_new && inside != nullptr && !list.is_map())
        take_defaults(target, *inside, layer_.name);
    }
  }

  static int index_of(const Message& into, const FieldDescriptor& list, const FieldDescriptor& key,
                      const Message& entry) {
    const auto name_of = [&](const Message& one) {
      return one.GetReflection()->GetString(one, &key);
    };
    for (int k = 0; k < into.GetReflection()->FieldSize(into, &list); ++k)
      if (name_of(into.GetReflection()->GetRepeatedMessage(into, &list, k)) == name_of(entry))
        return k;
    return -1;
  }

  /// Records a source. `written` is the index in the layer, if it differs from that in the
  /// settings.
  void note(const FieldDescriptor& field, int index, const Places* places, const std::string& path,
            int written = -1) {
    int line = -1;
    if (places != nullptr) {
      line = places->GetLocation(&field, written >= 0 ? written : index).line;
      if (line < 0 && index > 0) line = places->GetLocation(&field, 0).line;  // list in brackets
    }
    sources_[setting_path(path, field, index)] =
        layer_.name +
        (layer_.has_lines && line >= 0 ? ":" + std::to_string(line + 1) : std::string());
  }

  const Layer& layer_;
  SettingSources& sources_;
};

std::shared_ptr<const Layer> read_layer(const std::string& name, const std::string& text,
                                        std::unique_ptr<Message> message, bool has_lines) {
  auto layer = std::make_shared<Layer>();
  layer->name = name;
  layer->has_lines = has_lines;
  layer->message = std::move(message);
  layer->places = std::make_unique<Places>();
  parse_strict(text, name, *layer->message, *layer->places);
  return layer;
}

void put_layer(const Layer& layer, const FieldDescriptor& component, Message& settings,
               SettingSources& sources) {
  const Message* from = layer.message.get();
  const Places* places = layer.places.get();
  if (from->GetDescriptor() == component.containing_type()) {
    if (!from->GetReflection()->HasField(*from, &component)) return;
    from = &from->GetReflection()->GetMessage(*from, &component);
    places = places->GetTreeForNested(&component, -1);
  }
  Put(layer, sources).put(settings, *from, places, "");
}

/// Returns the files of the search path with settings of a component.
std::vector<std::filesystem::path> files_of(const std::string& component) {
  std::vector<std::filesystem::path> out = files_of_user("config");
  std::erase_if(out, [&](const std::filesystem::path& file) { return file.stem() != component; });
  const char* folder = component == "attention" ? "behaviours"
                       : component == "tasks"   ? "tasks"
                                                : nullptr;
  if (folder == nullptr) return out;
  for (const std::filesystem::path& file : files_of_user(folder)) out.push_back(file);
  return out;
}

}  // namespace

void use_overlays(const Overlays& overlays) {
  std::vector<std::shared_ptr<const Layer>> layers;
  std::vector<std::string> arguments;
  for (const std::string& file : overlays.files) {
    const std::string path = std::filesystem::absolute(file).string();
    layers.push_back(
        read_layer(file, read_text_file(path), std::make_unique<config::SettingsOverlay>(), true));
    arguments.insert(arguments.end(), {"--config", path});
  }
  for (const std::string& assignment : overlays.assignments) {
    layers.push_back(read_layer("--set " + assignment, assignment_text(assignment),
                                std::make_unique<config::SettingsOverlay>(), false));
    arguments.insert(arguments.end(), {"--set", assignment});
  }
  const std::lock_guard lock(state().mutex);
  state().layers = std::move(layers);
  state().arguments = std::move(arguments);
  state().sources.clear();
}

std::vector<std::string> overlay_arguments() {
  const std::lock_guard lock(state().mutex);
  return state().arguments;
}

void put_overlays_over(Message& settings) {
  const FieldDescriptor* component = component_of(settings.GetDescriptor());
  if (component == nullptr) return;
  std::vector<std::shared_ptr<const Layer>> layers;
  for (const std::filesystem::path& file : files_of(component->name()))
    layers.push_back(read_layer(file.string(), read_text_file(file),
                                std::unique_ptr<Message>(settings.New()), true));
  const std::lock_guard lock(state().mutex);
  layers.insert(layers.end(), state().layers.begin(), state().layers.end());
  auto sources = std::make_shared<SettingSources>();
  for (const auto& layer : layers) put_layer(*layer, *component, settings, *sources);
  if (sources->empty())
    state().sources.erase(settings.GetDescriptor());
  else
    state().sources[settings.GetDescriptor()] = std::move(sources);
}

std::shared_ptr<const SettingSources> overlay_sources(const Descriptor* type) {
  const std::lock_guard lock(state().mutex);
  const auto at = state().sources.find(type);
  return at == state().sources.end() ? nullptr : at->second;
}

std::string setting_path(const std::string& outer, const FieldDescriptor& field, int index) {
  return outer + (outer.empty() ? "" : ".") + field.name() +
         (index < 0 ? "" : "[" + std::to_string(index) + "]");
}

std::vector<std::string> settings_components() {
  const Descriptor& all = *config::SettingsOverlay::descriptor();
  std::vector<std::string> out;
  out.reserve(static_cast<std::size_t>(all.field_count()));
  for (int i = 0; i < all.field_count(); ++i) out.push_back(all.field(i)->name());
  return out;
}

std::unique_ptr<Message> settings_of(const std::string& component) {
  config::SettingsOverlay all;
  const FieldDescriptor* field = all.GetDescriptor()->FindFieldByName(component);
  if (field == nullptr) {
    const std::vector<std::string> nearest = nearest_names(component, settings_components());
    throw ConfigError("no component \"" + component + "\" has settings; " +
                      (nearest.empty() ? "there is: " + joined(settings_components())
                                       : "the nearest: " + joined(nearest)));
  }
  return std::unique_ptr<Message>(all.GetReflection()->MutableMessage(&all, field)->New());
}

std::string entry_key(const Descriptor& entry) {
  for (const char* name : {"name", "id", "source", "key"}) {
    const FieldDescriptor* field = entry.FindFieldByName(name);
    if (field != nullptr && field->cpp_type() == FieldDescriptor::CPPTYPE_STRING) return name;
  }
  return {};
}

}  // namespace handsel
