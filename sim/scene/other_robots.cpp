// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/other_robots.hpp"

#include <set>
#include <string>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "sim/scene/scene_setup.hpp"

namespace handsel::sim {
namespace {

using Positions = google::protobuf::Map<std::string, double>;

/// Returns the axis of this joint; -1: there is none.
int axis_of(const RobotModel& model, const std::string& joint) {
  for (int axis = 0; axis < model.dof(); ++axis)
    if (model.axes()[static_cast<std::size_t>(axis)].name == joint) return axis;
  return -1;
}

/// Returns the rest configuration with these positions of joints.
Vector configuration(const RobotModel& model, const Positions& positions, const std::string& id) {
  Vector q = model.rest_configuration();
  for (const auto& [name, position] : positions) {
    const int axis = axis_of(model, name);
    if (axis < 0)
      throw ConfigError("other robot " + id + ": " + name + " is no axis of " + model.name());
    const Axis& bounds = model.axes()[static_cast<std::size_t>(axis)];
    if (!(position >= bounds.lower && position <= bounds.upper))
      throw ConfigError("other robot " + id + ": " + name + " must be in [" +
                        std::to_string(bounds.lower) + ", " + std::to_string(bounds.upper) +
                        "], not " + std::to_string(position));
    q[axis] = position;
  }
  return q;
}

}  // namespace

std::vector<OtherRobotMotion> read_other_robots(const config::Scenario& scenario) {
  std::vector<OtherRobotMotion> robots;
  std::set<std::string> names;
  for (const auto& given : scenario.other_robots()) {
    OtherRobotMotion motion;
    motion.id = given.id();
    if (given.id().empty()) throw ConfigError("an other robot has no id: it needs a name");
    if (!names.insert(given.id()).second)
      throw ConfigError("two other robots have the id " + given.id());
    if (given.robot().empty())
      throw ConfigError("other robot " + given.id() + ": robot names no robot description");
    motion.model =
        std::make_shared<const RobotModel>(RobotModel::load(robot_description(given.robot())));
    motion.T_world_base = pose_of(given.base());
    motion.from = configuration(*motion.model, given.from(), given.id());
    motion.to = configuration(*motion.model, given.to(), given.id());
    motion.begins_at = given.begins_at();
    motion.duration = given.duration();
    motion.pause = given.pause();
    motion.silent = given.silent();
    robots.push_back(std::move(motion));
  }
  return robots;
}

}  // namespace handsel::sim
