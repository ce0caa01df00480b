// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>

#include "common/config/resources.hpp"
#include "components/trajectory_planner/trajectory_planner.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/offline/scene_lines.hpp"
#include "deploy/handsel/offline/trajectory_lines.hpp"
#include "deploy/handsel/pictures/speed_picture.hpp"

namespace handsel {
namespace {

using namespace command;
using namespace trajectory_planner;
using nlohmann::json;

struct TimedOptions {
  std::string robot, group{"arm"}, svg;
};

TrajectoryRequest request_of(const json& line, const RobotModel& robot, const Group& group) {
  TrajectoryRequest request;
  request.group = group.name;
  request.start = configuration_in(robot, line.value("start", json::object()), "start");
  const json& nodes = field(line, "nodes");
  if (!nodes.is_array()) throw LineError("\"nodes\" must be a list");
  for (const json& node : nodes) {
    if (!node.is_object())
      throw LineError(
          "a node must be an object of joint names and positions, as {\"shoulder\": 0.5}");
    Vector q = RobotModel::part(request.start, group);
    for (const auto& [name, value] : node.items()) {
      const auto at = std::find(group.axes.begin(), group.axes.end(), axis_of(robot, name));
      if (at == group.axes.end())
        throw LineError("axis \"" + name + "\" is none of the group \"" + group.name + "\"");
      q[at - group.axes.begin()] = number(node, name.c_str());
    }
    if (request.nodes.empty()) request.start = RobotModel::with(request.start, group, q);
    request.nodes.push_back(q);
  }
  if (line.contains("speed_scale")) request.speed_scale = positive(line, "speed_scale");
  return request;
}

Surroundings around_in(const json& line) {
  Surroundings around;
  around.people = people_in(line);
  if (const auto human = line.find("human"); human != line.end() && human->contains("velocity"))
    for (Person& person : around.people.people)
      for (BodyJoint& joint : person.joints) joint.velocity = vector3(*human, "velocity");
  return around;
}

int run_timed(const TimedOptions& options) {
  const RobotModel robot = options.robot.ends_with(".urdf")
                               ? RobotModel::load_urdf(options.robot)
                               : RobotModel::load(robot_description(options.robot));
  const Group& group = robot.require_group(options.group);
  CollisionWorld world(robot, nullptr);
  std::vector<SpeedCurve> curves;
  bool all = true;
  const int code = for_each_line(std::cin, std::cout, [&](const json& line) -> json {
    const TrajectoryRequest request = request_of(line, robot, group);
    const Surroundings around = around_in(line);
    HumanCost cost(robot, weights_in(line));
    cost.set_people(around.people);
    world.set_obstacles(obstacles_in(line));
    const Result result = plan(robot, world, cost, around, request, {});
    all = all && result.reply.solved;
    if (!options.svg.empty() && result.reply.solved) {
      const SpeedAlong people(robot, cost, around, {});
      const Vector limits = RobotModel::part(robot.comfort_limits().velocity, group);
      curves.push_back(
          speed_curve(result.reply.trajectory, group.axes, limits, request.start, people));
      curves.back().title = line.value("title", "");
    }
    json corners = json::array(), speeds = json::array();
    for (const Refusal& corner : result.reply.corners)
      corners.push_back({{"what", corner.what}, {"reason", corner.reason}});
    for (const LimitZones& zones : result.speeds) {
      speeds.push_back(json::array());
      for (const LimitZone& zone : zones)
        speeds.back().push_back(
            {zone.end, zone.scale.velocity, zone.scale.acceleration, zone.scale.jerk});
    }
    std::vector<std::string> names;
    for (const int axis : group.axes)
      names.push_back(robot.axes()[static_cast<std::size_t>(axis)].name);
    return {{"solved", result.reply.solved},
            {"reason", result.reply.reason},
            {"duration", result.reply.trajectory.duration()},
            {"duration_ptp", result.reply.duration_ptp},
            {"cost", result.cost},
            {"speeds", speeds},
            {"stops", corners},
            {"joint_names", names},
            {"axes", axes_of(result.reply.trajectory)}};
  });
  if (!options.svg.empty()) {
    std::ofstream file(options.svg);
    file << speed_picture(curves);
    if (!file.flush()) throw ConfigError(options.svg + ": cannot be written");
    std::fprintf(stderr, "wrote %s\n", options.svg.c_str());
  }
  return code != 0 ? code : all ? 0 : 1;
}

}  // namespace

void add_timed_command(CLI::App& trajectory, int& exit_code) {
  auto options = std::make_shared<TimedOptions>();
  CLI::App* command =
      trajectory.add_subcommand("timed",
                                "computes the jerk-limited motion along a path of joints, slower "
                                "where the human-aware costs are high");
  command->footer(
      R"(Input line: {"nodes": [{joint: rad}, ...], "start"?: {joint: rad} of other joints,
"obstacles"?, "human"?: {"joints": {name: [x, y, z]}, "gaze"?: [x, y, z], "velocity"?: [x, y, z]}
in the root frame, "weights"?, "speed_scale"?, "title"?: title of the panel in the picture}; ? marks
fields that may be missing.
Output line: "speeds" of each path segment: [[end of a part as fraction of the segment, scale of the
velocity limits, of the acceleration limits, of the jerk limits], ...]; empty without a human.)");
  command->add_option("--robot", options->robot, "a .urdf, or a robot description by name or file")
      ->required();
  command->add_option("--group", options->group, "group whose joints move")->capture_default_str();
  command->add_option(
      "--svg", options->svg,
      "file for a picture of speed and cost along the path, one panel for each line");
  command->add_flag("--json")->description("has no effect: the output is always JSON Lines");
  command->callback([options, &exit_code] { exit_code = run_timed(*options); });
}

}  // namespace handsel
