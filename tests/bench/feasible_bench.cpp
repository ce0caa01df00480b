// SPDX-License-Identifier: Apache-2.0
// Path planning among obstacles without people, against OMPL's RRT-Connect with FCL, on the Panda
// problems of the reference data. One run, the planners alternate per problem. Usage:
// bench_feasible [problems]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "components/path_planner/path_planner.hpp"
#include "components/path_planner/search/search.hpp"
#include "tests/support/oracles/quantile.hpp"
#include "tests/support/panda_problems.hpp"
#include "tests/support/processes/thread_time.hpp"

namespace handsel::path_planner {
namespace {

constexpr int kRepeats = 5;
constexpr double kPeerTimeLimit = 2.0;  // max time of a search of the peer [s]

int compare(std::size_t max_runs) {
  if (!test::reference_data("problems/panda")) {
    std::printf("HANDSEL_DATA names no folder with problems/panda: nothing to compare\n");
    return 3;
  }
  const RobotModel robot = test::load_panda();
  const std::vector<test::PandaProblem> problems = test::panda_problems(robot);
  const std::size_t runs = std::min(max_runs, problems.size()), stride = problems.size() / runs;
  CollisionWorld world(robot, nullptr), exact(robot, nullptr);
  HumanCost nobody(robot, {});
  std::vector<double> ends_times, search_times, smooth_times, verify_times, all_times, peer_times;
  int solved = 0, peer_solved = 0;
  for (std::size_t k = 0; k < runs; ++k) {
    const test::PandaProblem& given = problems[k * stride];
    world.set_obstacles(given.obstacles);
    Problem problem;
    problem.axes = test::panda_arm(robot);
    problem.start = given.start;
    for (const Vector& goal : given.goals) {
      Vector part(problem.axes.size());
      for (std::size_t i = 0; i < problem.axes.size(); ++i)
        part[static_cast<Eigen::Index>(i)] = goal[problem.axes[i]];
      problem.goals.push_back(part);
    }
    problem.budget = UINT64_MAX / 2;
    constexpr double kNever = std::numeric_limits<double>::infinity();
    double ends = kNever, searching = kNever, smoothing = kNever, verifying = kNever, all = kNever;
    bool found = false;
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      double stage[3] = {};
      double last = 0, prior = 0;
      int now = -1;
      Hooks hooks;
      hooks.entered = [&](Stage entered) {
        const double time = test::thread_time();
        if (now < 0)
          prior = time - last;
        else
          stage[now] += time - last;
        now = static_cast<int>(entered);
        last = time;
      };
      const double begin = last = test::thread_time();
      found = plan(robot, world, nobody, problem, {}, hooks).solved;
      const double end = test::thread_time();
      if (now >= 0) stage[now] += end - last;
      ends = std::min(ends, prior);
      searching = std::min(searching, stage[0]);
      smoothing = std::min(smoothing, stage[1]);
      verifying = std::min(verifying, stage[2]);
      all = std::min(all, end - begin);
    }
    solved += found;
    ends_times.push_back(ends);
    search_times.push_back(searching);
    smooth_times.push_back(smoothing);
    verify_times.push_back(verifying);
    all_times.push_back(all);

    exact.set_obstacles(given.obstacles);
    problem.stock = true;
    const double begin = test::thread_time();
    Hooks hooks;
    hooks.cancelled = [&] { return test::thread_time() - begin > kPeerTimeLimit; };
    SearchSpace space(robot, exact, nobody, problem, {}, hooks);
    std::vector<Vector> goals;
    for (const Vector& goal : problem.goals)
      if (space.free(goal)) goals.push_back(goal);
    peer_solved +=
        !goals.empty() && !search(space, goals, PlannerKind::rrt_connect, false, 1).path.empty();
    peer_times.push_back(test::thread_time() - begin);
  }
  std::printf("%zu problems; times of the thread, ours the least of %d\n", runs, kRepeats);
  const auto row = [](const char* name, const std::vector<double>& times) {
    std::printf("%-32s p50 %8.3f ms  p95 %8.3f ms\n", name, test::quantile_ms(times, 0.5),
                test::quantile_ms(times, 0.95));
  };
  row("ours: the ends are free", ends_times);
  row("ours: search", search_times);
  row("ours: smoothing", smooth_times);
  row("ours: the last, fine check", verify_times);
  row("ours: all", all_times);
  row("OMPL RRT-Connect and FCL, search", peer_times);
  std::printf("solved: ours %d, the peer %d; ratio of searches p50 %.1f x, p95 %.1f x\n", solved,
              peer_solved,
              test::quantile_ms(peer_times, 0.5) / test::quantile_ms(search_times, 0.5),
              test::quantile_ms(peer_times, 0.95) / test::quantile_ms(search_times, 0.95));
  return 0;
}

}  // namespace
}  // namespace handsel::path_planner

int main(int argc, char** argv) {
  return handsel::path_planner::compare(
      argc > 1 ? static_cast<std::size_t>(std::max(1, std::atoi(argv[1]))) : 70);
}
