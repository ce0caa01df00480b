// SPDX-License-Identifier: Apache-2.0
// Settings that go over the shipped ones: files on the search path, files of --config, values of
// --set. Later ones win, in this order.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <google/protobuf/message.h>

#include "common/config/located.hpp"

namespace handsel {

/// What a command line gives.
struct Overlays {
  std::vector<std::string> files{};  ///< texts of config::SettingsOverlay
  std::vector<std::string>
      assignments{};  ///< "component.key=value", "attention.behaviours.give.p_min=1"
};

/// Takes overlays for every settings file that this process reads from now on, in place of those
/// taken before. Throws ConfigError naming the source, the key and what would be right,
/// MissingError for a file that is not there. Not to be called while other threads read settings.
void use_overlays(const Overlays& overlays);

/// Returns the overlays in use as arguments of a component's process; paths are absolute.
std::vector<std::string> overlay_arguments();

/// Puts all overlays over the settings of a component; a message of another type stays as it is. A
/// value that an overlay writes replaces, also 0 and false. An entry of a list goes over the entry
/// of the same name, id or source, else it is added; a list whose entries have none of these is
/// replaced. Throws ConfigError, MissingError.
void put_overlays_over(google::protobuf::Message& settings);

/// Returns where the values come from that the last put_overlays_over() of the type put; nullptr:
/// there were none.
std::shared_ptr<const SettingSources> overlay_sources(const google::protobuf::Descriptor* type);

/// Returns the path of a field: "view.ceiling", "behaviours[2].p_min"; `index` -1: not of a list.
std::string setting_path(const std::string& outer, const google::protobuf::FieldDescriptor& field,
                         int index);

/// Returns the components that have settings: the names of the files below deploy/config.
std::vector<std::string> settings_components();

/// Returns an empty message of a component's settings. Throws ConfigError with the nearest names.
std::unique_ptr<google::protobuf::Message> settings_of(const std::string& component);

/// Returns the name of the field that tells the entries of a list of settings apart: "name", "id",
/// "source" or "key"; empty: none does.
std::string entry_key(const google::protobuf::Descriptor& entry);

}  // namespace handsel
