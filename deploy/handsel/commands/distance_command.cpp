// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/commands/distance_command.hpp"

#include <iostream>

#include "common/collision/collision_world.hpp"
#include "deploy/handsel/cli/json_lines.hpp"

namespace handsel {
namespace {

using nlohmann::json;
using namespace command;

Shape shape_of(const json& description) {
  const json& type = field(description, "type");
  if (type == "sphere") return Sphere{positive(description, "r")};
  if (type == "cylinder") return Cylinder{positive(description, "r"), positive(description, "l")};
  if (type == "capsule") {
    const double length = number(description, "l");
    if (length < 0) throw LineError("\"l\" of a capsule must not be negative");
    return Capsule{positive(description, "r"), length};
  }
  if (type == "box") {
    const Vector3 size = vector3(description, "xyz");
    if (!(size.minCoeff() > 0)) throw LineError("\"xyz\" of a box must be greater than 0");
    return Box{size};
  }
  throw LineError("unknown shape type " + type.dump() +
                  "; known are sphere, box, cylinder, capsule");
}

Pose pose_of(const json& pose) {
  return make_pose(vector3(pose, "xyz"), quaternion(pose, "quat_xyzw"));
}

json measure_pair(const json& pair) {
  const ShapeDistance d = shape_distance(shape_of(field(pair, "a")), pose_of(field(pair, "Ta")),
                                         shape_of(field(pair, "b")), pose_of(field(pair, "Tb")));
  return {{"collide", d.collide}, {"distance", d.distance}};
}

}  // namespace

void add_distance_command(CLI::App& app, int& exit_code) {
  CLI::App* distance = app.add_subcommand("distance",
                                          "computes contact and distance [m] of pairs of shapes; "
                                          "reads one line of JSON for each pair from stdin");
  distance->footer(
      R"(Input line: {"a": {"type": "sphere|box|cylinder|capsule", "r", "l", "xyz"}, "Ta": {"xyz",
"quat_xyzw"}, "b": ..., "Tb": ...})");
  distance->add_flag("--json")->description("has no effect: the output is always JSON Lines");
  distance->callback(
      [&exit_code] { exit_code = for_each_line(std::cin, std::cout, measure_pair); });
}

}  // namespace handsel
