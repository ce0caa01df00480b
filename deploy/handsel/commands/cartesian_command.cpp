// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>

#include "common/config/resources.hpp"
#include "common/model/platform.hpp"
#include "components/trajectory_planner/cartesian_motion.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/offline/scene_lines.hpp"
#include "deploy/handsel/offline/trajectory_lines.hpp"
#include "deploy/handsel/pictures/canvas.hpp"

namespace handsel {
namespace {

using namespace command;
using namespace trajectory_planner;
using nlohmann::json;

constexpr Colour kObstacle = {205, 190, 160}, kRobot = {170, 178, 190}, kPath = {40, 160, 60},
                 kSmooth = {0, 0, 0}, kStop = {220, 40, 40};

struct Options {
  std::string robot, group{"arm"}, tip, png;
  double period{CartesianSettings().period};
  int size{800};
  bool platform{};
};

RobotModel load_robot(const Options& options) {
  if (options.robot.ends_with(".urdf")) {
    if (options.platform)
      throw ConfigError("--platform needs a robot description; a .urdf tells of no platform");
    return RobotModel::load_urdf(options.robot);
  }
  const std::filesystem::path description = robot_description(options.robot);
  RobotModel robot = RobotModel::load(description);
  if (!options.platform) return robot;
  if (auto mobile = on_platform(robot, description)) return *std::move(mobile);
  throw ConfigError("--platform: " + description.string() + " tells of no platform");
}

CartesianRequest request_of(const json& line, const RobotModel& robot) {
  CartesianRequest request;
  request.start = configuration_in(robot, line.value("start", json::object()), "start");
  const json& nodes = field(line, "nodes");
  if (!nodes.is_array()) throw LineError("\"nodes\" must be a list");
  for (const json& given : nodes) {
    CartesianWaypoint node;
    node.T_root_tool = make_pose(vector3(given, "p"), quaternion(given, "q"));
    if (given.contains("elbow")) node.elbow = number(given, "elbow");
    const json also = given.value("also", json::object());
    if (request.nodes.empty())
      for (const auto& [name, value] : also.items()) request.also.push_back(axis_of(robot, name));
    node.also.resize(static_cast<Eigen::Index>(request.also.size()));
    if (also.size() != request.also.size())
      throw LineError("every node must name the same axes in \"also\"");
    for (std::size_t i = 0; i < request.also.size(); ++i)
      node.also[static_cast<Eigen::Index>(i)] =
          number(also, robot.axes()[static_cast<std::size_t>(request.also[i])].name.c_str());
    request.nodes.push_back(node);
  }
  if (const auto level = line.find("upright"); level != line.end()) {
    request.level.emplace();
    request.level->axis_tool = vector3(*level, "axis");
    request.level->bound = positive(*level, "max_angle");
  }
  return request;
}

/// Draws the robot at start and end, its surroundings, the path and its nodes in green, TR in
/// black; a node that keeps its stop in red (the chapter's Fig. 20).
void draw(const std::string& file, int size, const RobotModel& robot, const json& line,
          const CartesianRequest& request, const CartesianMotion& motion) {
  std::vector<Vector3> smooth;
  Eigen::AlignedBox3d box;
  constexpr double kStep = 0.01;
  const int steps = static_cast<int>(std::ceil(motion.path.duration() / kStep));
  for (int k = 0; k <= steps; ++k) {
    const double t = std::min(k * kStep, motion.path.duration());
    smooth.push_back(motion.path.pose(t).translation());
    box.extend(smooth.back());
  }
  for (const CartesianTrajectory::Node& node : motion.path.nodes())
    box.extend(node.T_root_tool.translation());
  box.min().array() -= 0.25;
  box.max().array() += 0.25;
  const std::vector<Obstacle> obstacles = obstacles_in(line);
  Vector end = request.start;
  if (!motion.samples.empty()) end(motion.axes) = motion.samples.back();
  const Picture picture = from_sides(
      box, {Vector3(1.2, -0.9, 0.5), Vector3(0.3, 0.6, 1.6)}, size,
      [&](Canvas& canvas, std::size_t) {
        for (const Obstacle& o : obstacles)
          canvas.shape(o.placed.shape, o.placed.T_parent_shape, kObstacle);
        std::vector<Pose> T;
        for (const bool begin : {true, false}) {
          robot.forward(begin ? request.start : end, T);
          for (std::size_t i = 0; i < robot.links().size(); ++i)
            for (const PlacedShape& placed : robot.links()[i].collision)
              canvas.shape(placed.shape, T[i] * placed.T_parent_shape, kRobot, begin ? 0.25 : 0.4);
        }
        const std::vector<CartesianTrajectory::Node>& nodes = motion.path.nodes();
        for (std::size_t k = 0; k < nodes.size(); ++k) {
          canvas.ball(nodes[k].T_root_tool.translation(), 0.008, kPath);
          if (k > 0)
            canvas.stick(nodes[k - 1].T_root_tool.translation(), nodes[k].T_root_tool.translation(),
                         0.002, kPath);
        }
        for (std::size_t i = 1; i < smooth.size(); ++i)
          canvas.stick(smooth[i - 1], smooth[i], 0.003, kSmooth);
        for (const BlendReport& corner : motion.corners)
          if (corner.method == BlendMethod::stop)
            canvas.ball(nodes[static_cast<std::size_t>(corner.node)].T_root_tool.translation(),
                        0.011, kStop);
      });
  std::ofstream out(file, std::ios::binary);
  out << picture.png();
  if (!out.flush()) throw ConfigError(file + ": cannot be written");
  std::fprintf(stderr,
               "wrote %s: the path and its nodes green, the smoothed trajectory black, a stop that "
               "is kept red\n",
               file.c_str());
}

int run(const Options& options) {
  const RobotModel robot = load_robot(options);
  Group arm = robot.require_group(options.group);
  if (!options.tip.empty() && (arm.tip = robot.link_index(options.tip)) < 0)
    throw ConfigError("--tip: the robot has no link \"" + options.tip + "\"");
  if (arm.tip < 0)
    throw ConfigError("the group \"" + options.group + "\" has no tip: name its link with --tip");
  CollisionWorld world(robot, nullptr);
  CartesianSettings settings;
  settings.period = options.period;
  bool first = true, all = true;
  const int code = for_each_line(std::cin, std::cout, [&](const json& line) -> json {
    const CartesianRequest request = request_of(line, robot);
    world.set_obstacles(obstacles_in(line));
    const CartesianMotion motion = plan_cartesian(robot, arm, world, request, settings);
    if (first && !options.png.empty())
      draw(options.png, options.size, robot, line, request, motion);
    first = false;
    all = all && motion.solved;
    json corners = json::array();
    double saved = 0;
    for (const BlendReport& corner : motion.corners) {
      corners.push_back({{"node", corner.node},
                         {"method", name(corner.method)},
                         {"excess", corner.excess},
                         {"saved_s", corner.saved},
                         {"reason", corner.reason}});
      saved += corner.saved;
    }
    std::vector<std::string> names;
    for (const int axis : motion.axes)
      names.push_back(robot.axes()[static_cast<std::size_t>(axis)].name);
    return {{"solved", motion.solved},
            {"reason", motion.reason},
            {"reached", motion.reached},
            {"duration", motion.path.duration()},
            {"duration_ptp", motion.duration_ptp},
            {"saved_s", saved},
            {"corners", corners},
            {"active", axes_of(motion.path.active())},
            {"joint_names", names},
            {"axes", axes_of(motion.executable.approximation.trajectory)},
            {"compression", motion.executable.approximation.compression},
            {"slowest", motion.executable.slowest},
            {"stretch", motion.executable.stretch}};
  });
  return code != 0 ? code : all ? 0 : 1;
}

}  // namespace

void add_cartesian_command(CLI::App& trajectory, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = trajectory.add_subcommand(
      "cartesian",
      "computes the jerk-limited motion of an arm with seven axes through poses of its tool");
  command->footer(
      R"(Input line: {"start"?: {joint: rad}, "nodes": [{"p": [x, y, z], "q": [x, y, z, w] of the
tool in the root frame, "elbow"?: rad, "also"?: {joint: rad} of hand and head}], "obstacles"?:
[{"id", "type": "box|cylinder|sphere", "dims", "pos", "quat_xyzw"}], "upright"?: {"axis":
[x, y, z] of the tool frame, "max_angle": rad from up}}; ? marks
fields that may be missing.
Output line: "active": smoothed trajectory of position, rotation vector, elbow and further axes;
"axes": trajectory of the joints; "reached": number of nodes reached. If a node cannot be reached,
the motion ends at the node before, and the exit code is 1.)");
  command->add_option("--robot", options->robot, "a .urdf, or a robot description by name or file")
      ->required();
  command->add_option("--group", options->group, "group of the arm")->capture_default_str();
  command->add_option("--tip", options->tip, "link that carries the tool, if the group names none");
  command->add_option("--period", options->period, "time between two computed configurations [s]")
      ->check(kAboveZero)
      ->capture_default_str();
  command->add_flag(
      "--platform", options->platform,
      "\"also\" may name platform_x, platform_y and platform_heading; poses are in the world");
  command->add_option("--png", options->png, "file for a picture of the first motion");
  command->add_option("--size", options->size, "width and height of the picture [pixels]")
      ->check(CLI::Range(100, 4000))
      ->capture_default_str();
  command->add_flag("--json")->description("has no effect: the output is always JSON Lines");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace handsel
