// SPDX-License-Identifier: Apache-2.0
// Benefit of the transition test: with a person beside the table, bidirectional T-RRT against
// RRT-Connect, all smoothed for the same time. In each random query the straight line comes nearer
// to the person than its ends. HANDSEL_RUNS: number of queries (60).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include <gtest/gtest.h>

#include "components/path_planner/path_planner.hpp"
#include "tests/support/beside_the_table.hpp"
#include "tests/support/processes/thread_time.hpp"

namespace handsel::path_planner::path_cost_test {
namespace {

using test::thread_time;

constexpr unsigned kSeed = 2026;
constexpr double kSmoothing = 0.004;  // thread time of the smoothing of a path [s]
constexpr double kSame = 0.001;       // max difference of equal distances [m]

/// Two-sided, normal approximation, of pairs that differ.
double wilcoxon_p(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::abs(a[i] - b[i]) > 1e-9) d.push_back(a[i] - b[i]);
  std::sort(d.begin(), d.end(), [](double x, double y) { return std::abs(x) < std::abs(y); });
  double plus = 0;
  for (std::size_t i = 0; i < d.size(); ++i)
    if (d[i] > 0) plus += static_cast<double>(i + 1);
  const double n = static_cast<double>(d.size()), mean = n * (n + 1) / 4,
               deviation = std::sqrt(n * (n + 1) * (2 * n + 1) / 24);
  return d.empty() ? 1.0 : std::erfc(std::abs(plus - mean) / deviation / std::sqrt(2.0));
}

double sum(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v.empty() ? 0.0 : v[v.size() / 2];
}

/// Results of one planner, by query.
struct Record {
  std::vector<double> integral, excess, min_distance, search, smoothing;
};

class PathCost : public ::testing::Test, protected test::BesideTheTable {
 protected:
  PathCost() : BesideTheTable(kSeed) {}

  /// Plans with the cost or, if `blind`, without it; people are obstacles in both cases.
  bool run(PlannerKind kind, bool blind, Record& record) {
    problem.planner = kind;
    double begin = thread_time(), smoothing = begin;
    Hooks hooks;
    hooks.entered = [&](Stage stage) {
      if (stage == Stage::smooth) smoothing = thread_time();
    };
    hooks.smooth_on = [&] { return thread_time() - smoothing < kSmoothing; };
    const Result result = plan(robot, world, blind ? nobody_ : cost, problem, {}, hooks);
    const double end = thread_time();
    EXPECT_TRUE(result.solved) << result.reason;
    if (!result.solved) return false;
    const CostSettings weights;
    const double ends = std::max(weighted_cost(cost.parts(problem.start), weights),
                                 weighted_cost(cost.parts(whole(problem.goals[0])), weights));
    double integral = 0, excess = 0, min_distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < result.path.size(); ++i) {
      const Vector along = result.path[i] - result.path[i - 1];
      const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / 0.02)));
      for (int k = 0; k < pieces; ++k) {
        const CostParts parts = cost.parts(whole(result.path[i - 1] + (k + 0.5) / pieces * along));
        integral += weighted_cost(parts, weights) * along.norm() / pieces;
        excess += std::max(0.0, weighted_cost(parts, weights) - ends) * along.norm() / pieces;
        min_distance = std::min(min_distance, parts.distance);
      }
    }
    record.integral.push_back(integral);
    record.excess.push_back(excess);
    record.min_distance.push_back(min_distance);
    record.search.push_back(smoothing - begin);
    record.smoothing.push_back(end - smoothing);
    return true;
  }

  struct Comparison {
    double ratio{}, p{}, larger{};
  };
  Comparison compare(const Record& careful, const Record& other, const char* name) {
    int larger = 0, smaller = 0;
    for (std::size_t i = 0; i < careful.min_distance.size(); ++i) {
      larger += careful.min_distance[i] > other.min_distance[i] + kSame;
      smaller += careful.min_distance[i] < other.min_distance[i] - kSame;
    }
    Comparison c{sum(careful.excess) / sum(other.excess), wilcoxon_p(careful.excess, other.excess),
                 static_cast<double>(larger) / std::max(1, larger + smaller)};
    std::printf(
        "T-RRT to %s: cost above the ends' %.3f (Wilcoxon p %.1e), whole integral %.3f; least "
        "distance larger in %d, smaller in %d of %zu; "
        "search %.2f and %.2f ms, smoothing %.2f and %.2f ms (medians)\n",
        name, c.ratio, c.p, sum(careful.integral) / sum(other.integral), larger, smaller,
        careful.min_distance.size(), 1e3 * median(careful.search), 1e3 * median(other.search),
        1e3 * median(careful.smoothing), 1e3 * median(other.smoothing));
    return c;
  }

  HumanCost nobody_{robot, {}};
};

TEST_F(PathCost, paths_of_t_rrt_cost_less_and_keep_farther_off_than_those_of_rrt_connect) {
  const char* asked = std::getenv("HANDSEL_RUNS");
  const int runs = asked != nullptr ? std::atoi(asked) : 60;
  RecordProperty("seed", kSeed);
  Record careful, blind, smoothed;
  for (int i = 0; i < runs; ++i) {
    next_query();
    problem.seed = kSeed + static_cast<unsigned>(i);
    ASSERT_TRUE(run(PlannerKind::bitrrt, false, careful) &&
                run(PlannerKind::rrt_connect, true, blind) &&
                run(PlannerKind::rrt_connect, false, smoothed))
        << "query " << i;
  }
  std::printf("seed %u, %d queries\n", kSeed, runs);
  const Comparison to_blind = compare(careful, blind, "RRT-Connect with shortcuts");
  const Comparison to_smoothed =
      compare(careful, smoothed, "RRT-Connect smoothed for the same cost");
  EXPECT_LE(to_blind.ratio, 0.7);
  EXPECT_LT(to_blind.p, 0.001);
  EXPECT_GE(to_blind.larger, 0.8);
  EXPECT_LT(to_smoothed.ratio, 1.0);
}

}  // namespace
}  // namespace handsel::path_planner::path_cost_test
