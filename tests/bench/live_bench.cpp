// SPDX-License-Identifier: Apache-2.0
// Online replanning after a person has moved, against new planning from the present configuration:
// time until the running path avoids the person, or until its cost falls. Jido beside its table;
// the person blocks part of the path (repair) or raises its cost (improve). One process,
// alternating; thread time. Usage: bench_live [cases]
#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "common/trajectory/path/broken_line.hpp"
#include "components/path_planner/live_path.hpp"
#include "tests/support/processes/thread_times.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::path_planner {
namespace {

using test::seconds;
using test::Times;

constexpr unsigned kSeed = 20;
constexpr std::uint64_t kBudget = 10000;  // max checks of a replanning request, as shipped

int run(int cases) {
  const RobotModel robot =
      RobotModel::load(std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy/robots/jido/jido.txtpb");
  const Group& arm = robot.require_group("arm");
  CollisionWorld world(robot, nullptr);
  HumanCost cost(robot, {});
  Scene scene;
  scene.robot_known = true;
  scene.robot_position = robot.rest_configuration();
  scene.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
  world.set_scene(scene);
  std::mt19937 engine(kSeed);
  std::uniform_real_distribution<double> unit(0, 1);
  Times repair, repair_anew, improve, improve_anew;
  std::array<int, 5> outcomes{}, outcomes_dear{};
  int anew_solved = 0, blocked_cases = 0;
  const auto random_posture = [&] {
    Vector q = robot.rest_configuration();
    do {
      for (int axis : arm.axes)
        q[axis] = robot.axes()[axis].lower +
                  unit(engine) * (robot.axes()[axis].upper - robot.axes()[axis].lower);
    } while (!world.check(q).free);
    return q;
  };
  const auto put = [&](const HumanState& people) {
    world.set_people(people);
    cost.set_people(people);
  };
  for (int k = 0; k < cases; ++k) {
    put({});
    Problem problem;
    problem.axes = arm.axes;
    problem.seed = kSeed + static_cast<unsigned>(k);
    problem.start = random_posture();
    problem.goals = {RobotModel::part(random_posture(), arm)};
    const Result first = plan(robot, world, cost, problem, {});
    if (!first.solved || first.length < 1.0) continue;
    // The arm has passed a tenth of the first segment when the person stands at its end.
    const Vector on_way = first.path[0] + 0.1 * (first.path[1] - first.path[0]);
    const std::size_t edge = first.path.size() / 2;
    const Vector middle = 0.5 * (first.path[edge - 1] + first.path[edge]);
    const Vector3 tool =
        robot.link_pose(RobotModel::with(problem.start, arm, middle), robot.tool_link())
            .translation();
    problem.start = RobotModel::with(problem.start, arm, on_way);
    problem.budget = kBudget;
    const double heading = 6.283185307179586 * unit(engine), off = 0.1 + 0.5 * unit(engine);
    const HumanState people = test::person_at(
        {tool.x() + off * std::cos(heading), tool.y() + off * std::sin(heading), 0});
    put(people);
    if (!world.check(problem.start).free ||
        !world.check(RobotModel::with(problem.start, arm, problem.goals[0])).free)
      continue;
    bool blocked = false;
    const std::vector<Vector> rest = remainder(first.path, on_way, 0.5);
    for (std::size_t i = 1; i < rest.size() && !blocked; ++i)
      blocked = !world
                     .check_motion(RobotModel::with(problem.start, arm, rest[i - 1]),
                                   RobotModel::with(problem.start, arm, rest[i]))
                     .free;
    ReplanResult live;
    Result anew;
    const double t_live = seconds([&] {
      put(people);
      live = continue_path({robot, world, cost}, problem, first.path, {}, {});
    });
    const double t_anew = seconds([&] {
      put(people);
      anew = plan(robot, world, cost, problem, {});
    });
    if (blocked) {
      ++blocked_cases;
      anew_solved += anew.solved;
      repair.add(t_live);
      repair_anew.add(t_anew);
      ++outcomes[static_cast<std::size_t>(live.outcome)];
    } else {
      improve.add(t_live);
      improve_anew.add(t_anew);
      ++outcomes_dear[static_cast<std::size_t>(live.outcome)];
    }
  }
  std::printf("seed %u, budget %llu checks\n", kSeed, static_cast<unsigned long long>(kBudget));
  repair.print("blocked: live");
  repair_anew.print("blocked: planned anew");
  improve.print("dear: live");
  improve_anew.print("dear: planned anew");
  std::printf("blocked: repaired %d, replanned %d, no way %d; planned anew solves %d of %d\n",
              outcomes[2], outcomes[3], outcomes[4], anew_solved, blocked_cases);
  std::printf("dear: kept %d, improved %d, replanned %d, no way %d\n", outcomes_dear[0],
              outcomes_dear[1], outcomes_dear[3], outcomes_dear[4]);
  std::printf("ratio of medians, planned anew / live: blocked %.1f, dear %.1f\n",
              repair_anew.at(0.5) / repair.at(0.5), improve_anew.at(0.5) / improve.at(0.5));
  return 0;
}

}  // namespace
}  // namespace handsel::path_planner

int main(int argc, char** argv) {
  return handsel::path_planner::run(argc > 1 ? std::atoi(argv[1]) : 400);
}
