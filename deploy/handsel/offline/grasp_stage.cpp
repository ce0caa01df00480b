// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/offline/grasp_stage.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "common/config/resources.hpp"
#include "common/geometry/placement.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel {

using namespace grasp_planner;

void add_stage_options(CLI::App& command, StageOptions& o) {
  add_list_options(command, o);
  command.remove_option(command.get_option("--hand"));
  command.remove_option(command.get_option("--seed"));
  command.add_option("--robot", o.robot, "robot description: name or file")->capture_default_str();
  command
      .add_option("--table", o.table,
                  "middle x,y, size x,y and height [m], seen from the robot's base")
      ->delimiter(',')
      ->expected(5)
      ->capture_default_str();
  command.add_option("--png", o.png, "draws it into this file");
  command.add_option("--size", o.size, "of one of its pictures")
      ->check(CLI::Range(64, 2000))
      ->capture_default_str();
}

Stage::Stage(const StageOptions& o)
    : file(robot_description(o.robot)),
      robot(std::make_shared<const RobotModel>(RobotModel::load(file))) {
  object = object_of(o);
  for (const Manipulator& m : manipulators(file, *robot)) {
    lists.push_back(list_with(m.hand, o));
    arms.push_back({m, lists.back().hand_geometry.get(), nullptr});
  }
  if (arms.empty()) throw ConfigError("robot " + robot->name() + " has no arm with a hand");
  for (std::size_t i = 0; i < arms.size(); ++i) arms[i].list = &lists[i].list;
  scene.robot_known = true;
  scene.robot_position = robot->rest_configuration();
  scene.boxes.push_back({"table",
                         make_pose({o.table[0], o.table[1], 0.5 * o.table[4]}),
                         {o.table[2], o.table[3], o.table[4]},
                         true});
  top = o.table[4];
}

ObjectLibrary Stage::library() const {
  return [this](const std::string&) { return &object; };
}

Pose Stage::standing(double x, double y, double yaw) const {
  double low = 0;
  for (const Vector3& v : object.mesh.vertices) low = std::min(low, v.z());
  Pose T = make_pose({x, y, top - low});
  T.linear() = Eigen::AngleAxisd(yaw, Vector3::UnitZ()).toRotationMatrix();
  return T;
}

std::vector<Pose> Stage::resting(double x, double y) const {
  constexpr int kTurns = 8;
  std::vector<Pose> out;
  out.reserve(kTurns);
  for (int k = 0; k < kTurns; ++k) out.push_back(standing(x, y, 2 * std::numbers::pi * k / kTurns));
  for (const Placement& placement : stable_placements(object.mesh, object.com)) {
    if ((placement.T_support_object.linear() * Vector3::UnitZ()).z() > 0.999) continue;
    for (int k = 0; k < kTurns; ++k)
      out.push_back(
          make_pose({x, y, top}, Eigen::Quaterniond(Eigen::AngleAxisd(
                                     2 * std::numbers::pi * k / kTurns, Vector3::UnitZ()))) *
          placement.T_support_object);
  }
  return out;
}

Person somebody(double x, double y, double stature) {
  Person person;
  person.id = "person";
  person.stature = stature;
  person.joints = standing_body({x, y, 0}, std::atan2(-y, -x), stature);
  return person;
}

void write(const Picture& picture, const std::string& file) {
  std::ofstream out(file, std::ios::binary);
  out << picture.png();
  if (!out.flush()) throw ConfigError(file + " cannot be written");
  std::fprintf(stderr, "%s: %d x %d\n", file.c_str(), picture.width(), picture.height());
}

void print_refusals(const Refusals& refusals) {
  for (const Refusal& r : refusals)
    std::fprintf(stderr, "  %s: %s\n", r.what.c_str(), r.reason.c_str());
}

nlohmann::json pose_line(const Pose& T) {
  const Eigen::Quaterniond q(T.linear());
  return {{"p", {T.translation().x(), T.translation().y(), T.translation().z()}},
          {"q", {q.x(), q.y(), q.z(), q.w()}}};
}

nlohmann::json numbers(const Vector& v) {
  return std::vector<double>(v.data(), v.data() + v.size());
}

}  // namespace handsel
