// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <set>

#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "components/grasp_planner/load.hpp"
#include "deploy/handsel/commands/grasp/grasp_pair_command.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"

namespace handsel {
namespace {

using namespace grasp_planner;

struct PrepareOptions {
  std::vector<std::string> scenarios{"give_mug"};
  std::string robot;
};

/// Throws ConfigError if lists cannot be kept on disk.
void require_store(const settings::GraspPlannerSettings& settings) {
  if (!settings.store)
    throw ConfigError("grasp_planner.store is false; lists are kept only if it is true");
  const std::filesystem::path folder = default_store();
  if (folder.empty())
    throw ConfigError("neither XDG_CACHE_HOME nor HOME is set; one must name a folder for lists");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || access(folder.c_str(), W_OK) != 0)
    throw ConfigError(folder.string() +
                      " cannot be written to; XDG_CACHE_HOME must name a folder for lists");
}

void print_list(const std::function<std::shared_ptr<const CachedGrasps>()>& make) {
  const auto begin = std::chrono::steady_clock::now();
  const GraspList& list = make()->list;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("%-14s %-14s %8zu %9.1f\n", list.hand.c_str(), list.object.c_str(),
              list.grasps.size(), seconds);
  std::fflush(stdout);
}

void prepare_object(const std::vector<ArmGrasps>& arms, const ObjectModel& object) {
  for (const ArmGrasps& arm : arms) {
    print_list([&] { return arm.cache->page(object, {}); });
    for (const auto& transfers : {arm.transfers, arm.left_transfers})
      if (transfers) print_list([&] { return transfers->taker_entry(object); });
  }
}

int prepare(const PrepareOptions& o) {
  bool headed = false;
  for (const std::string& scenario : o.scenarios) {
    const NodeContext context =
        system_context(scenario_file(scenario).string(), o.robot, 1, resource("config"));
    const auto settings = load_settings(context.settings);
    require_store(settings);
    const config::Scenario drawn = read_scenario(context.scenario, 1);
    if (drawn.objects().empty())
      throw ConfigError(context.scenario.string() +
                        ": objects: none is given; lists need at least one");
    const auto arms = load_arms(*context.robot, context.description, settings);
    if (!headed) std::printf("%-14s %-14s %8s %9s\n", "hand", "object", "grasps", "seconds");
    headed = true;
    std::set<std::string> prepared;
    for (const config::ObjectPlacement& placed : drawn.objects())
      if (prepared.insert(placed.model()).second)
        prepare_object(arms, *context.objects(placed.model()));
  }
  return 0;
}

}  // namespace

void add_grasp_prepare(CLI::App& grasp, int& exit_code) {
  CLI::App* preparing = grasp.add_subcommand(
      "prepare",
      "computes the grasp lists of a scenario's robot and person on its objects and keeps them on "
      "disk, so that the first task with an object does not wait for them; prints the number of "
      "grasps and the time, which is short for a list that is on disk already");
  auto o = std::make_shared<PrepareOptions>();
  preparing->add_option("scenario", o->scenarios, "scenario: name or file; may be repeated")
      ->capture_default_str();
  preparing->add_option("--robot", o->robot,
                        "robot description: name or file (default: the scenario's)");
  preparing->callback([o, &exit_code] { exit_code = prepare(*o); });
}

}  // namespace handsel
