// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/processes.hpp"

#include <algorithm>
#include <cstdlib>
#include <set>

#include "common/base/errors.hpp"
#include "common/bus/state_directory.hpp"
#include "common/config/overlay.hpp"
#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "common/model/object_model.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

// Returns whether a process belongs to the safety path: observation, occupied volume, guard,
// set-points, robot side.
bool is_realtime(std::string_view process) {
  return process == "sim" || process == "spark" || process == "trajectory_controller";
}

namespace {

bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void require_processes(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (std::find(kProcesses.begin(), kProcesses.end(), name) != kProcesses.end()) continue;
    std::string all;
    for (const char* process : kProcesses) all += (all.empty() ? "" : ", ") + std::string(process);
    throw ConfigError("there is no process \"" + name + "\"; there are: " + all);
  }
}

/// Returns whether the simulator grants time unless the environment defines it: not if an external
/// source is read, whose time does not wait.
bool is_paced_by_simulator(const SystemOptions& options) {
  if (std::getenv("HANDSEL_SIM_TIME") != nullptr) return false;  // the processes read the variable
  if (!options.whole() || options.ros2) return false;
  const config::Scenario scenario = read_scenario(scenario_file(options.scenario), options.seed);
  return std::none_of(scenario.people().begin(), scenario.people().end(),
                      [](const config::PersonDescription& person) {
                        return person.behaviour() == config::EXTERNAL;
                      });
}

}  // namespace

std::vector<ProcessSpec> system_processes(const SystemOptions& options) {
  require_processes(options.only);
  require_processes(options.without);
  const std::filesystem::path folder = std::filesystem::canonical("/proc/self/exe").parent_path();
  const std::string robot = robot_of(options);
  const bool sim_time = is_paced_by_simulator(options);
  std::vector<ProcessSpec> specs;
  std::vector<std::string> processes(kProcesses.begin(), kProcesses.end());
  std::erase_if(processes, [&](const std::string& process) {
    return has(options.without, process) || (!options.only.empty() && !has(options.only, process));
  });
  if (options.ros2) processes.emplace_back("ros2_lane");
  for (const std::string& process : processes) {
    const std::filesystem::path binary = folder / ("handsel_" + process);
    if (!std::filesystem::exists(binary))
      throw MissingError("the process " + binary.string() +
                         " is not there; build it with ./run --build-only");
    ProcessSpec spec{process,
                     binary,
                     {"--domain", std::to_string(options.domain), "--scenario", options.scenario,
                      "--seed", std::to_string(options.seed)}};
    spec.arguments.insert(spec.arguments.end(), {"--robot", robot});
    if (process == "supervisor")
      spec.arguments.insert(spec.arguments.end(), {"--state", state_folder(options)});
    if (is_realtime(process)) spec.arguments.emplace_back("--realtime");
    if (process == "bridge" && !options.web_token.empty())
      spec.environment.push_back("HANDSEL_WEB_TOKEN=" + options.web_token);
    if (sim_time) spec.arguments.emplace_back("--sim-time");
    const std::vector<std::string> overlays = overlay_arguments();
    spec.arguments.insert(spec.arguments.end(), overlays.begin(), overlays.end());
    specs.push_back(std::move(spec));
  }
  if (specs.empty()) throw ConfigError("no process is left to be started");
  return specs;
}

std::filesystem::path state_folder(const SystemOptions& options) {
  const bool here = !has(options.without, "supervisor") &&
                    (options.only.empty() || has(options.only, "supervisor"));
  return here ? domain_state_directory(options.domain) : std::filesystem::path{};
}

std::string robot_of(const SystemOptions& options) {
  return options.robot.empty() ? scenario_robot(options.scenario, options.seed) : options.robot;
}

void check_system(const SystemOptions& options) {
  const std::filesystem::path file = scenario_file(options.scenario);
  const config::Scenario scenario = read_scenario(file, options.seed);
  const RobotModel model = RobotModel::load(robot_description(robot_of(options)));
  for (const auto& [joint, position] : scenario.start()) {
    bool known = false;
    for (const Axis& axis : model.axes()) known = known || axis.name == joint;
    if (!known)
      throw ConfigError(file.string() + ": start names the joint \"" + joint + "\", which " +
                        model.name() + " does not have");
  }
  std::set<std::string> models;
  for (const config::ObjectPlacement& object : scenario.objects()) models.insert(object.model());
  for (const std::string& model_name : models) ObjectModel::load(object_description(model_name));
}

}  // namespace handsel
