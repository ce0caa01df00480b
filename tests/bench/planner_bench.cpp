// SPDX-License-Identifier: Apache-2.0
// Paths beside a person: bidirectional T-RRT against OMPL's BiT-RRT with FCL on the same costs;
// both searches alone, then the own search with smoothing and the final check. One run, the
// planners alternate per query. Usage: bench_planner [queries]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "components/path_planner/path_planner.hpp"
#include "components/path_planner/search/search.hpp"
#include "tests/support/beside_the_table.hpp"
#include "tests/support/oracles/quantile.hpp"
#include "tests/support/processes/thread_time.hpp"

namespace handsel::path_planner {
namespace {

constexpr unsigned kSeed = 4;
constexpr double kPeerTimeLimit = 2.0;  // max time of a search of the peer [s]

void compare(int queries) {
  test::BesideTheTable table(kSeed);
  CollisionWorld exact(table.robot, nullptr);
  exact.set_scene(table.scene);
  const Settings settings;
  std::vector<double> search_times, all_times, peer_times;
  int solved = 0, peer_solved = 0;
  for (int i = 0; i < queries; ++i) {
    table.next_query();
    table.problem.seed = kSeed + static_cast<unsigned>(i);
    double ours = std::numeric_limits<double>::infinity(), whole = ours;
    bool found = false;
    for (int repeat = 0; repeat < 3; ++repeat) {
      const double begin = test::thread_time();
      double smoothing = begin;
      Hooks hooks;
      hooks.entered = [&](Stage stage) {
        if (stage == Stage::smooth) smoothing = test::thread_time();
      };
      found = plan(table.robot, table.world, table.cost, table.problem, settings, hooks).solved;
      whole = std::min(whole, test::thread_time() - begin);
      ours = std::min(ours, smoothing - begin);
    }
    solved += found;
    search_times.push_back(ours);
    all_times.push_back(whole);

    exact.set_people(table.people);
    HumanCost one_by_one(table.robot, {});
    one_by_one.set_people(table.people);
    one_by_one.set_layers(table.layers);
    Problem problem = table.problem;
    problem.stock = true;
    problem.budget = UINT64_MAX / 2;
    const double begin = test::thread_time();
    Hooks hooks;
    hooks.cancelled = [&] { return test::thread_time() - begin > kPeerTimeLimit; };
    SearchSpace space(table.robot, exact, one_by_one, problem, settings, hooks);
    peer_solved +=
        !search(space, problem.goals, PlannerKind::bitrrt, true, problem.seed).path.empty();
    peer_times.push_back(test::thread_time() - begin);
  }
  std::printf("%d queries, seed %u; times of the thread, ours the least of 3\n", queries, kSeed);
  std::printf("ours, search              p50 %8.2f ms  p95 %8.2f ms  solved %d\n",
              test::quantile_ms(search_times, 0.5), test::quantile_ms(search_times, 0.95), solved);
  std::printf("ours, smoothed and judged p50 %8.2f ms  p95 %8.2f ms\n",
              test::quantile_ms(all_times, 0.5), test::quantile_ms(all_times, 0.95));
  std::printf("OMPL BiTRRT and FCL       p50 %8.2f ms  p95 %8.2f ms  solved %d\n",
              test::quantile_ms(peer_times, 0.5), test::quantile_ms(peer_times, 0.95), peer_solved);
  std::printf("ratio of searches         p50 %8.1f x   p95 %8.1f x\n",
              test::quantile_ms(peer_times, 0.5) / test::quantile_ms(search_times, 0.5),
              test::quantile_ms(peer_times, 0.95) / test::quantile_ms(search_times, 0.95));
}

}  // namespace
}  // namespace handsel::path_planner

int main(int argc, char** argv) {
  handsel::path_planner::compare(argc > 1 ? std::max(1, std::atoi(argv[1])) : 40);
  return 0;
}
