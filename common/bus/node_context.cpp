#include "common/bus/node_context.hpp"

#include <map>

#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"

namespace handsel {

ObjectLibrary load_object_library() {
  auto library = std::make_shared<std::map<std::string, ObjectModel>>();
  std::map<std::string, std::filesystem::path> files;
  const std::filesystem::path root = resource("objects");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
    if (entry.path().extension() == ".txtpb") files[entry.path().string()] = entry.path();
  for (const auto& [text, file] : files) {
    ObjectModel model = ObjectModel::load(file);
    const std::string name = model.name;
    if (!library->emplace(name, std::move(model)).second)
      throw ConfigError(text + ": another object is called \"" + name + "\" already");
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
  return context;
}

}  // namespace handsel
