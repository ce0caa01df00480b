// SPDX-License-Identifier: Apache-2.0
#include "common/bus/node_context.hpp"

#include <map>
#include <set>

#include "common/bus/dds/dds_defaults.hpp"
#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "common/config/search_path.hpp"

namespace handsel {

namespace {

using Models = std::map<std::string, ObjectModel>;

/// Adds the objects of the search path outside resource_root(). Invalid ones are skipped, so that
/// unrelated files prevent nothing; a scenario that names such an object is refused.
void add_objects_of_user(Models& models) {
  const std::string root = (resource_root() / "").string();
  for (const std::filesystem::path& file : all_files(FileKind::object)) {
    if (file.string().starts_with(root)) continue;
    try {
      ObjectModel model = ObjectModel::load(file);
      const std::string name = model.name;
      models.emplace(name, std::move(model));
    } catch (const ConfigError&) {
    } catch (const MissingError&) {
    }
  }
}

}  // namespace

ObjectLibrary load_object_library() {
  auto library = std::make_shared<Models>();
  add_objects_of_user(*library);
  std::set<std::string> of_user, known;
  for (const auto& [name, model] : *library) of_user.insert(name);
  std::map<std::string, std::filesystem::path> files;
  const std::filesystem::path root = resource("objects");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
    if (entry.path().extension() == ".txtpb") files[entry.path().string()] = entry.path();
  for (const auto& [text, file] : files) {
    ObjectModel model = ObjectModel::load(file);
    const std::string name = model.name;
    if (!known.insert(name).second)
      throw ConfigError(text + ": another object is called \"" + name + "\" already");
    if (!of_user.contains(name)) library->emplace(name, std::move(model));
  }
  return [library](const std::string& name) -> const ObjectModel* {
    const auto at = library->find(name);
    return at == library->end() ? nullptr : &at->second;
  };
}

NodeContext load_context(const std::string& robot, const std::string& scenario,
                         const std::filesystem::path& settings, std::uint64_t seed) {
  NodeContext context;
  context.description = robot_description(robot.empty() ? scenario_robot(scenario, seed) : robot);
  context.robot = std::make_shared<const RobotModel>(RobotModel::load(context.description));
  context.objects = load_object_library();
  if (!scenario.empty()) context.scenario = scenario_file(scenario);
  context.settings = settings.empty() ? resource("config") : settings;
  if (!std::filesystem::is_directory(context.settings))
    throw MissingError(context.settings.string() +
                       ": no such folder; it should hold the components' settings");
  context.seed = seed;
  context.name = system_name().empty() ? context.robot->name() : system_name();
  return context;
}

}  // namespace handsel
