// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "common/config/overlay.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/offline/settings_list.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {
namespace {

std::vector<std::string> chosen(const std::vector<std::string>& components) {
  return components.empty() ? settings_components() : components;
}

int show(const std::vector<std::string>& components) {
  for (const std::string& component : chosen(components))
    for (const ListedSetting& one : list_settings(component, true))
      std::printf("%s: %s  # %s\n", one.path.c_str(), one.value.c_str(), one.source.c_str());
  return 0;
}

int diff(const std::vector<std::string>& components) {
  bool any = false;
  for (const std::string& component : chosen(components))
    for (const ChangedSetting& one : changed_settings(component)) {
      any = true;
      std::printf("%s: %s -> %s  # %s\n", one.path.c_str(),
                  one.shipped.empty() ? "none" : one.shipped.c_str(), one.value.c_str(),
                  one.source.c_str());
    }
  return any ? 1 : 0;
}

}  // namespace

void add_config_commands(CLI::App& app, int& exit_code) {
  CLI::App* config =
      app.add_subcommand("config", "prints settings of the components and their sources");
  config->require_subcommand(1);
  const auto add = [&](const char* name, const char* text,
                       int (*run)(const std::vector<std::string>&)) {
    auto components = std::make_shared<std::vector<std::string>>();
    CLI::App* command = config->add_subcommand(name, text);
    command->add_option("components", *components,
                        "names of components, e.g. spark (default: all)");
    add_overlay_options(*command);
    command->callback([components, run, &exit_code] { exit_code = run(*components); });
  };
  add("show", "prints each setting with its value and the source of the value", show);
  add("diff", "prints settings that differ from the shipped ones; exit code 1: there are some",
      diff);
}

}  // namespace handsel
