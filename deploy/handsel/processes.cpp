#include "deploy/handsel/processes.hpp"

#include <charconv>
#include <cstdlib>

#include "common/base/errors.hpp"
#include "common/config/described.hpp"
#include "common/config/resources.hpp"
#include "common/config/scenario.pb.h"
#include "common/model/object_model.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

int default_domain() {
  const char* text = std::getenv("HANDSEL_DOMAIN");
  if (!text || !*text) return 0;
  int domain = -1;
  const std::string value = text;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), domain);
  if (error != std::errc() || end != value.data() + value.size() || domain < 0 || domain > 230) {
    throw ConfigError("HANDSEL_DOMAIN is \"" + value + "\"; it must be a number from 0 to 230");
  }
  return domain;
}

// The safety lane: observation, occupied volume, guard, set-points, robot side.
bool is_realtime(std::string_view process) { return process == "sim" || process == "spark" || process == "trajectory_controller"; }

std::vector<ProcessSpec> system_processes(const SystemOptions& options) {
  const std::filesystem::path folder = std::filesystem::canonical("/proc/self/exe").parent_path();
  const std::string robot = robot_of(options);
  std::vector<ProcessSpec> specs;
  std::vector<std::string> processes(kProcesses.begin(), kProcesses.end());
  if (options.ros2) processes.emplace_back("ros2_lane");
  for (const std::string& process : processes) {
    const std::filesystem::path binary = folder / ("handsel_" + process);
    if (!std::filesystem::exists(binary))
      throw MissingError("the process " + binary.string() + " is not there; build it with ./run --build-only");
    ProcessSpec spec{process,
                     binary,
                     {"--domain", std::to_string(options.domain), "--scenario", options.scenario, "--seed", std::to_string(options.seed)}};
    spec.arguments.insert(spec.arguments.end(), {"--robot", robot});
    if (is_realtime(process)) spec.arguments.emplace_back("--realtime");
    specs.push_back(std::move(spec));
  }
  return specs;
}

std::string robot_of(const SystemOptions& options) {
  if (!options.robot.empty()) return options.robot;
  config::Scenario scenario;
  const std::filesystem::path file = scenario_file(options.scenario);
  load_text_proto(file, scenario);
  return scenario.robot().empty() ? "jido" : described_name(file, scenario.robot());
}

void check_system(const SystemOptions& options) {
  config::Scenario scenario;
  const std::filesystem::path file = scenario_file(options.scenario);
  load_text_proto(file, scenario);
  const RobotModel model = RobotModel::load(robot_description(robot_of(options)));
  for (const auto& [joint, position] : scenario.start()) {
    bool known = false;
    for (const Axis& axis : model.axes()) known = known || axis.name == joint;
    if (!known) throw ConfigError(file.string() + ": start names the joint \"" + joint + "\", which " + model.name() + " does not have");
  }
  for (const config::ObjectPlacement& object : scenario.objects()) ObjectModel::load(object_description(object.model()));
}

}  // namespace handsel
