// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/offline/scene_check.hpp"

#include <algorithm>

#include "common/bus/node_context.hpp"
#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "deploy/handsel/system/processes.hpp"
#include "sim/scene/scene_setup.hpp"
#include "sim/scene/settings.hpp"

namespace handsel {

void check_scene(const SystemOptions& options) {
  const auto has = [](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), "sim") != names.end();
  };
  if (has(options.without) || (!options.only.empty() && !has(options.only))) return;
  check_system(options);
  const config::Scenario scenario = read_scenario(scenario_file(options.scenario), options.seed);
  const RobotModel robot = RobotModel::load(robot_description(robot_of(options)));
  const sim::SimSettings settings = sim::load_settings(resource("config"));
  sim::set_up(scenario, robot, load_object_library(), settings.coverage, settings.data_root,
              options.seed);
}

}  // namespace handsel
