// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/eval/lockstep_system.hpp"

#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "components/attention/node.hpp"
#include "components/collision_checker/node.hpp"
#include "components/costmap/node.hpp"
#include "components/grasp_planner/node.hpp"
#include "components/manipulation_planner/node.hpp"
#include "components/path_planner/node.hpp"
#include "components/spark/node.hpp"
#include "components/supervisor/node.hpp"
#include "components/trajectory_controller/node.hpp"
#include "components/trajectory_planner/node.hpp"
#include "deploy/handsel/system/processes.hpp"
#include "sim/node.hpp"

namespace handsel {

NodeContext system_context(const std::string& scenario, const std::string& robot,
                           std::uint64_t seed, const std::filesystem::path& settings) {
  NodeContext context = load_context(robot_of({.robot = robot, .scenario = scenario, .seed = seed}),
                                     scenario, settings, seed);
  const config::Scenario drawn = read_scenario(context.scenario, seed);
  for (const config::ObjectPlacement& object : drawn.objects())
    if (context.objects(object.model()) == nullptr)
      ObjectModel::load(object_description(object.model()));  // reports errors of the description
  return context;
}

template <class Node>
void LockstepSystem::add(const std::string& component, const NodeContext& context) {
  nodes_.push_back(std::make_shared<Node>(network_.add(component), context));
}

LockstepSystem::LockstepSystem(const NodeContext& context, MotionSource source)
    : network_(context.seed), bus_(network_.add("handsel")), observer_(bus_) {
  add<sim::Node>("sim", context);
  add<spark::Node>("spark", context);
  add<costmap::Node>("costmap", context);
  add<collision_checker::Node>("collision_checker", context);
  add<trajectory_controller::Node>("trajectory_controller", context);
  add<attention::Node>("attention", context);
  add<path_planner::Node>("path_planner", context);
  add<grasp_planner::Node>("grasp_planner", context);
  add<trajectory_planner::Node>("trajectory_planner", context);
  if (source == MotionSource::planner)
    add<manipulation_planner::Node>("manipulation_planner", context);
  add<supervisor::Node>("supervisor", context);
}

LockstepSystem::LockstepSystem(const std::string& scenario, const std::string& robot,
                               std::uint64_t seed)
    : LockstepSystem(system_context(scenario, robot, seed)) {}

}  // namespace handsel
