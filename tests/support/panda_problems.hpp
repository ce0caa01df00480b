// SPDX-License-Identifier: Apache-2.0
// The Panda and its planning problems of the reference data (environment HANDSEL_DATA), for tests
// and benchmarks.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/collision/collision_world.hpp"
#include "tests/support/reference_data.hpp"

namespace handsel::test {

struct PandaProblem {
  std::string set;
  std::vector<Obstacle> obstacles;
  Vector start;
  std::vector<Vector> goals;  ///< all axes
};

inline RobotModel load_panda() {
  const std::filesystem::path folder = *reference_data("robots/franka_panda");
  return RobotModel::load_urdf(folder / "panda.urdf", folder / "panda.srdf");
}

inline std::vector<int> panda_arm(const RobotModel& robot) {
  std::vector<int> axes;
  for (int i = 0; i < robot.dof(); ++i)
    if (robot.axes()[static_cast<std::size_t>(i)].name.find("finger") == std::string::npos)
      axes.push_back(i);
  return axes;
}

inline std::vector<PandaProblem> panda_problems(const RobotModel& robot) {
  std::vector<PandaProblem> out;
  std::ifstream file(*reference_data("problems/panda/problems.jsonl"));
  const auto put = [&robot](const nlohmann::json& joints, Vector& q) {
    for (int i = 0; i < robot.dof(); ++i)
      if (const auto found = joints.find(robot.axes()[static_cast<std::size_t>(i)].name);
          found != joints.end())
        q[i] = found->get<double>();
  };
  for (std::string line; std::getline(file, line);) {
    const nlohmann::json j = nlohmann::json::parse(line);
    PandaProblem problem;
    problem.set = j["set"];
    for (const auto& o : j["obstacles"]) {
      const std::vector<double> d = o["dims"], p = o["pos"], q = o["quat_xyzw"];
      Obstacle obstacle;
      obstacle.id = o["id"];
      obstacle.placed.T_parent_shape =
          make_pose(Vector3(p[0], p[1], p[2]), Eigen::Quaterniond(q[3], q[0], q[1], q[2]));
      if (o["type"] == "box")
        obstacle.placed.shape = Box{Vector3(d[0], d[1], d[2])};
      else if (o["type"] == "cylinder")
        obstacle.placed.shape = Cylinder{d[1], d[0]};
      else
        obstacle.placed.shape = Sphere{d[0]};
      problem.obstacles.push_back(std::move(obstacle));
    }
    problem.start = Vector::Zero(robot.dof());
    put(j["start"], problem.start);
    for (const auto& g : j["goals"]) {
      Vector goal = problem.start;
      put(g, goal);
      problem.goals.push_back(std::move(goal));
    }
    out.push_back(std::move(problem));
  }
  return out;
}

}  // namespace handsel::test
