// SPDX-License-Identifier: Apache-2.0
// Time from ten waypoints of Jido's arm among boxes to a smoothed trajectory, with and without the
// collision checks of blends; and of tool motions approximated as TR_app, per 5 s of motion. The
// peer of the first is MoveIt's TOTG: 2.8 ms for ten waypoints of seven axes on such a machine.
// Usage: bench_trajectory_planner [lines]. Minima of repeated runs; quantiles over the inputs.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "tests/support/broken_lines.hpp"
#include "tests/support/oracles/quantile.hpp"
#include "tests/support/panda_problems.hpp"
#include "tests/support/processes/thread_time.hpp"
#include "tests/support/tool_motions.hpp"

namespace handsel {
namespace {

constexpr double kTotg = 2.8e-3;  // time of MoveIt's TOTG [s]
constexpr int kTimes = 7;

template <class Work>
double least_time(Work&& work) {
  double minimum = 1e9;
  for (int k = 0; k < kTimes; ++k) {
    const double begin = test::thread_time();
    work();
    minimum = std::min(minimum, test::thread_time() - begin);
  }
  return minimum;
}

void lines(int count) {
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  const Group& arm = robot.require_group("arm");
  CollisionWorld world(robot, nullptr), planning(robot, nullptr);
  const HumanCost nobody(robot, {});
  KinematicLimits limits = robot.comfort_limits();
  limits = {RobotModel::part(limits.velocity, arm), RobotModel::part(limits.acceleration, arm),
            RobotModel::part(limits.jerk, arm)};
  std::mt19937 random(10);
  std::vector<double> with, without;
  for (int k = 0; k < count; ++k) {
    const test::BrokenLine line = test::broken_line(robot, world, 10, 10, random);
    planning.set_scene(line.scene);
    with.push_back(least_time(
        [&] { trajectory_planner::plan(robot, planning, nobody, {}, line.request, {}); }));
    without.push_back(least_time([&] { smooth(line.request.nodes, limits); }));
  }
  std::printf(
      "ten nodes, %d lines of Jido among six boxes: without collision tests %.0f us (p95 %.0f), "
      "with them %.0f us (p95 %.0f)\n",
      count, 1e3 * test::quantile_ms(without, 0.5), 1e3 * test::quantile_ms(without, 0.95),
      1e3 * test::quantile_ms(with, 0.5), 1e3 * test::quantile_ms(with, 0.95));
  std::printf("TOTG's 2.8 ms are %.0f and %.0f times that\n",
              1e3 * kTotg / test::quantile_ms(without, 0.5),
              1e3 * kTotg / test::quantile_ms(with, 0.5));
}

/// `still`: hand and head are active, but stay where they are.
void motions(const char* name, const RobotModel& robot, const Group& arm,
             const std::vector<int>& also, const Vector& home, int count, bool still = false) {
  CollisionWorld world(robot, nullptr);
  std::mt19937 random(5);
  std::vector<double> ratio;
  for (int tries = 0; tries < 4 * count && static_cast<int>(ratio.size()) < count; ++tries) {
    auto request = test::tool_motion(robot, arm, also, home, world, random);
    if (still)
      for (auto& node : request.nodes) node.also = home(also);
    if (request.nodes.empty()) continue;
    trajectory_planner::CartesianMotion motion;
    const double lasted = least_time(
        [&] { motion = trajectory_planner::plan_cartesian(robot, arm, world, request); });
    if (motion.solved && motion.path.duration() > 2)
      ratio.push_back(5 * lasted / motion.path.duration());
  }
  std::printf("%s, tool, %zu motions: 5 s of motion to TR_app in %.1f ms (p95 %.1f)\n", name,
              ratio.size(), test::quantile_ms(ratio, 0.5), test::quantile_ms(ratio, 0.95));
}

}  // namespace
}  // namespace handsel

int main(int argc, char** argv) {
  using namespace handsel;
  const int count = argc > 1 ? std::max(1, std::atoi(argv[1])) : 40;
  lines(count);
  const RobotModel jido =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  motions("Jido, 22 axes", jido, jido.require_group("arm"), test::hand_and_head(jido),
          jido.rest_configuration(), count);
  motions("Jido, hand and head still", jido, jido.require_group("arm"), test::hand_and_head(jido),
          jido.rest_configuration(), count, true);
  if (const auto file = test::reference_data("robots/kuka_iiwa14/model.urdf")) {
    const RobotModel iiwa = RobotModel::load_urdf(*file);
    Group arm = iiwa.require_group("all");
    arm.tip = iiwa.link_index("lbr_iiwa_link_7");
    motions("iiwa", iiwa, arm, {}, test::iiwa_home(), count);
  }
}
