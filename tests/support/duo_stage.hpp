// SPDX-License-Identifier: Apache-2.0
// The robot with two arms before a table, and the grasp lists of both hands on an object.
#pragma once

#include "components/grasp_planner/regrasp/regrasp.hpp"
#include "tests/support/grasp_lists.hpp"

namespace handsel::grasp_planner {

struct DuoStage {
  std::filesystem::path file = deploy_folder() / "robots/duo/duo.txtpb";
  RobotModel robot = RobotModel::load(file);

  /// The table is 1.6 m wide; the object's place on it, turned by `yaw`.
  static Pose standing(const std::string& object, double x, double y, double yaw = 0) {
    Pose T = make_pose({x, y, 0.75 + object_model(object)->height_above_support});
    T.linear() = Eigen::AngleAxisd(yaw, Vector3::UnitZ()).toRotationMatrix();
    return T;
  }

  Scene scene() const {
    Scene s;
    s.robot_known = true;
    s.robot_position = robot.rest_configuration();
    s.boxes.push_back({"table", make_pose({0.65, 0, 0.375}), {0.6, 1.6, 0.75}, true});
    return s;
  }

  std::vector<RegraspArm> arms(const std::string& object, std::size_t count = 2) const {
    std::vector<RegraspArm> out;
    for (const Manipulator& m : manipulators(file, robot)) {
      const HandOnObject& h = hand_on_object(m.hand, object, 60, 144);
      out.push_back({m, h.hand_geometry.get(), &h.list});
    }
    out.resize(count);
    return out;
  }

  RegraspPlanner planner(const std::string& object, std::size_t count = 2) const {
    return RegraspPlanner(
        robot, arms(object, count), *hand_on_object("sah", object, 60, 144).object,
        [](const std::string& name) { return object_model(name); }, scene(), "thing");
  }
};

}  // namespace handsel::grasp_planner
