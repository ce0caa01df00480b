// SPDX-License-Identifier: Apache-2.0
// Time of the human-aware cost of a robot state, against its distance term computed with FCL, and
// of an update of the cost map. One run; medians and minima of alternating rounds. Usage:
// bench_cost [rounds]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <random>

#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include "components/costmap/layers.hpp"
#include "tests/support/panda_problems.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel {
namespace {

using Clock = std::chrono::steady_clock;
constexpr unsigned kSeed = 11;
constexpr int kLines = 200, kStates = 16;

double seconds(const std::function<void()>& work) {
  const Clock::time_point begin = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct Times {
  std::vector<double> all;
  void add(double t) { all.push_back(t); }
  double median() {
    std::sort(all.begin(), all.end());
    return all[all.size() / 2];
  }
  double minimum() const { return *std::min_element(all.begin(), all.end()); }
};

/// The robot's capsules against body cylinder and head, as the safety cost needs them.
class FclDistance {
 public:
  FclDistance(const RobotModel& robot, const std::vector<LinkCapsule>& capsules,
              const SimplifiedBody& body)
      : robot_(robot),
        cylinder_(body.radius, body.height),
        head_(body.head_radius),
        T_cylinder_(make_pose(body.axis_bottom + Vector3(0, 0, 0.5 * body.height))),
        T_head_(make_pose(body.head)) {
    for (const LinkCapsule& c : capsules) {
      const Vector3 along = c.b - c.a;
      links_.push_back({c.link, fcl::Capsuled(c.radius, along.norm()),
                        make_pose(0.5 * (c.a + c.b),
                                  Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), along))});
    }
  }
  double operator()(const Vector& q) {
    robot_.forward(q, T_root_link_);
    double minimum = 1e9;
    fcl::DistanceRequestd request;
    for (const LinkShape& link : links_) {
      const Pose T = T_root_link_[static_cast<std::size_t>(link.link)] * link.T_link_capsule;
      fcl::DistanceResultd a, b;
      minimum =
          std::min({minimum, fcl::distance(&link.capsule, T, &cylinder_, T_cylinder_, request, a),
                    fcl::distance(&link.capsule, T, &head_, T_head_, request, b)});
    }
    return minimum;
  }

 private:
  struct LinkShape {
    int link;
    fcl::Capsuled capsule;
    Pose T_link_capsule;
  };
  const RobotModel& robot_;
  std::vector<LinkShape> links_;
  fcl::Cylinderd cylinder_;
  fcl::Sphered head_;
  Pose T_cylinder_, T_head_;
  std::vector<Pose> T_root_link_;
};

void cost_of_states(const char* name, const RobotModel& robot, const std::vector<int>& axes,
                    int rounds) {
  const HumanState people = test::person_at({1.2, 0, 0});
  HumanCost one_by_one(robot, {}), together(robot, {});
  costmap::MapMaker maker({});
  LayersNow layers;
  layers.comfort = std::make_shared<const CostGrid>(maker.make(people.people[0], {})[2]);
  together.set_moving_axes(axes);
  for (HumanCost* cost : {&one_by_one, &together}) {
    cost->set_people(people);
    cost->set_layers(layers);
  }
  FclDistance fcl(robot, robot_capsules(robot), simplified_body(people.people[0]));
  std::mt19937 random(kSeed);
  std::vector<std::pair<Vector, Vector>> lines;
  for (int k = 0; k < kLines; ++k) {
    Vector from = robot.rest_configuration(), to = from;
    for (int i : axes) {
      const Axis& axis = robot.axes()[static_cast<std::size_t>(i)];
      std::uniform_real_distribution<double> inside(std::max(axis.lower, -3.0),
                                                    std::min(axis.upper, 3.0));
      from[i] = inside(random);
      to[i] = from[i] + 0.1 * (inside(random) - from[i]);
    }
    lines.emplace_back(from, to);
  }
  std::vector<double> at(kStates), costs(kStates);
  for (int i = 0; i < kStates; ++i)
    at[static_cast<std::size_t>(i)] = static_cast<double>(i) / (kStates - 1);
  Times wide, scalar, peer;
  double sink = 0;
  for (int round = 0; round < rounds; ++round) {
    wide.add(seconds([&] {
               for (const auto& [from, to] : lines) {
                 together.on_line(from, to, at.data(), kStates, costs.data());
                 sink += costs[3];
               }
             }) /
             (kLines * kStates));
    scalar.add(seconds([&] {
                 for (const auto& [from, to] : lines) sink += one_by_one(from);
               }) /
               kLines);
    peer.add(seconds([&] {
               for (const auto& [from, to] : lines) sink += fcl(from);
             }) /
             kLines);
  }
  std::printf(
      "%s, %zu capsules: cost of a state, 16 at once %.0f ns (least %.0f), one by one %.0f ns; "
      "FCL, distance alone %.1f us; ratio %.0f%s\n",
      name, robot_capsules(robot).size(), 1e9 * wide.median(), 1e9 * wide.minimum(),
      1e9 * scalar.median(), 1e6 * peer.median(), peer.median() / wide.median(),
      sink == 0.5 ? " " : "");
}

void refresh(int rounds) {
  costmap::MapMaker maker({});
  const std::vector<SceneBox> boxes = {
      {"table", make_pose({0.8, 0.2, 0.7}), {0.8, 1.2, 0.04}, true},
      {"floor", make_pose({0, 0, -0.05}), {8, 8, 0.1}, true},
      {"shelf", make_pose({2.5, 0, 1}), {0.4, 2, 2}, true}};
  Times first, again;
  first.add(seconds([&] { maker.make(test::person_at({1.4, 0, 0}).people[0], boxes); }));
  for (int round = 0; round < 6 * rounds; ++round)
    again.add(seconds([&] {
      maker.make(test::person_at({1.4 + 0.01 * round, 0, 0}).people[0], boxes);
    }));
  std::printf(
      "cost map, four layers of 81^3 points: refreshed in %.1f ms (least %.1f); with new volumes "
      "of the arms %.0f ms\n",
      1e3 * again.median(), 1e3 * again.minimum(), 1e3 * first.median());
}

}  // namespace
}  // namespace handsel

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 15;
  using namespace handsel;
  refresh(rounds);
  const RobotModel jido =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  cost_of_states("jido", jido, jido.require_group("arm").axes, rounds);
  if (!test::reference_data("robots/franka_panda")) {
    std::printf("HANDSEL_DATA names no folder with robots/franka_panda: jido only\n");
    return 0;
  }
  const RobotModel panda = test::load_panda();
  cost_of_states("panda", panda, test::panda_arm(panda), rounds);
  return 0;
}
