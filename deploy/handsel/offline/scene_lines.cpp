// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/offline/scene_lines.hpp"

#include <algorithm>

#include "common/model/human/human_body.hpp"

namespace handsel::command {

using nlohmann::json;

int axis_of(const RobotModel& robot, const std::string& name) {
  for (int i = 0; i < robot.dof(); ++i)
    if (robot.axes()[static_cast<std::size_t>(i)].name == name) return i;
  throw LineError("the robot has no axis \"" + name + "\"");
}

Vector configuration_in(const RobotModel& robot, const json& joints, const char* what) {
  Vector q = robot.rest_configuration().size() == robot.dof() ? robot.rest_configuration()
                                                              : Vector::Zero(robot.dof());
  if (!joints.is_object())
    throw LineError(std::string("\"") + what +
                    "\" must be an object of joint names and positions, as {\"shoulder\": 0.5}");
  const auto fixed = [&](const std::string& name) {
    return std::any_of(robot.joints().begin(), robot.joints().end(), [&](const Joint& j) {
      return j.name == name && j.kind == JointKind::fixed;
    });
  };
  for (const auto& [name, value] : joints.items())
    if (!fixed(name)) q[axis_of(robot, name)] = number(joints, name.c_str());
  return q;
}

namespace {

Obstacle obstacle_of(const json& item) {
  const json& type = field(item, "type");
  const Vector dims = vector_of(item, "dims");
  const auto expect = [&](int n) {
    if (dims.size() != n || !(dims.minCoeff() > 0))
      throw LineError("\"dims\" of a " + type.dump() + " must be " + std::to_string(n) +
                      " numbers > 0");
  };
  Obstacle obstacle;
  obstacle.id = item.value("id", "");
  obstacle.placed.T_parent_shape = make_pose(vector3(item, "pos"), quaternion(item, "quat_xyzw"));
  if (type == "box") {
    expect(3);
    obstacle.placed.shape = Box{dims};
  } else if (type == "cylinder") {
    expect(2);
    obstacle.placed.shape = Cylinder{dims[1], dims[0]};
  } else if (type == "sphere") {
    expect(1);
    obstacle.placed.shape = Sphere{dims[0]};
  } else {
    throw LineError("unknown obstacle type " + type.dump() + "; known are box, cylinder, sphere");
  }
  return obstacle;
}

}  // namespace

std::vector<Obstacle> obstacles_in(const json& line) {
  std::vector<Obstacle> out;
  for (const json& one : line.value("obstacles", json::array())) out.push_back(obstacle_of(one));
  return out;
}

HumanState people_in(const json& problem) {
  HumanState state;
  const auto human = problem.find("human");
  if (human == problem.end()) return state;
  ObservedPerson seen;
  const json& joints = field(*human, "joints");
  if (!joints.is_object())
    throw LineError("\"joints\" of \"human\" must be an object of points by joint name");
  for (const auto& [name, point] : joints.items()) {
    if (body_joint_index(name) < 0) throw LineError("\"" + name + "\" is no joint of a body");
    seen.joints.push_back({name, vector3(joints, name.c_str()), 1.0});
  }
  Person person;
  person.id = "human";
  person.joints = fit_body(seen, nullptr, person.stature);
  if (human->contains("gaze")) {
    const Vector3 gaze = vector3(*human, "gaze");
    if (!(gaze.norm() > 1e-9)) throw LineError("\"gaze\" must not be zero");
    person.gaze_known = true;
    person.gaze_direction = gaze.normalized();
    for (const BodyJoint& joint : person.joints)
      if (joint.name == "head") person.gaze_origin = joint.position;
  }
  state.people.push_back(person);
  return state;
}

CostSettings weights_in(const json& problem) {
  CostSettings settings;
  const auto weights = problem.find("weights");
  if (weights == problem.end()) return settings;
  const auto read = [&](const char* name, double& value) {
    if (weights->contains(name)) value = number(*weights, name);
    if (value < 0) throw LineError(std::string("the weight \"") + name + "\" must not be negative");
  };
  read("safety", settings.w_safety);
  read("visibility", settings.w_visibility);
  read("comfort", settings.w_comfort);
  if (!(settings.w_safety + settings.w_visibility + settings.w_comfort > 0))
    throw LineError("at least one of the \"weights\" must be > 0");
  return settings;
}

}  // namespace handsel::command
