// SPDX-License-Identifier: Apache-2.0
// Jerk-limited trajectories: time of a solution, evaluation, smoothing, control tick, switch. The
// 7-axis problems are those of Ruckig's own benchmark: its generator, seeds and validity test.
// With -DHANDSEL_RUCKIG=<path> Ruckig solves the same problems in alternation: counters ours_ns and
// peer_ns are medians of interleaved passes [CPU ns], and every duration is compared.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <ctime>
#include <random>
#include <vector>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/min_time.hpp"
#include "common/trajectory/path/segment_table.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/stop.hpp"
#include "common/trajectory/switch.hpp"
#include "common/trajectory/time_scaling.hpp"
#include "tests/support/oracles/ruckig_peer.hpp"

namespace handsel {
namespace {

constexpr int kAxes = 7, kBatch = 8;
constexpr std::size_t kCases = 4096;
enum class Ends { rest_rest, moving_rest, any };

struct Case {
  MotionState3 from, to;
  KinematicLimits limits;
};

/// A source of random numbers as Ruckig's benchmark has it.
template <typename Distribution>
class Source {
 public:
  Source(Distribution distribution, unsigned seed) : distribution_(distribution), random_(seed) {}
  void fill(Eigen::VectorXd& out) {
    for (double& x : out) x = distribution_(random_);
  }
  void fill_or_zero(Eigen::VectorXd& out, double share) {
    for (double& x : out) x = chance_(random_) < share ? distribution_(random_) : 0.0;
  }
  void fill_beyond(Eigen::VectorXd& out, const Eigen::VectorXd& least) {
    for (Eigen::Index i = 0; i < out.size(); ++i)
      out[i] = distribution_(random_) + std::abs(least[i]);
  }

 private:
  Distribution distribution_;
  std::default_random_engine random_;
  std::uniform_real_distribution<double> chance_{0, 1};
};

bool ends_inside(const Case& c) {
  for (int i = 0; i < kAxes; ++i) {
    const double v = c.to.velocity[i], a = c.to.acceleration[i], V = c.limits.velocity[i];
    if (std::abs(v) > V || std::abs(a) > c.limits.acceleration[i] ||
        std::abs(v - a * std::abs(a) / (2 * c.limits.jerk[i])) > V)
      return false;
  }
  return true;
}

std::vector<Case> cases(Ends ends) {
  Source position(std::normal_distribution<double>(0, 4), 42),
      rate(std::normal_distribution<double>(0, 0.8), 43);
  Source limit(std::uniform_real_distribution<double>(0.1, 12), 44);
  std::vector<Case> out;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(kAxes);
  while (out.size() < kCases) {
    Case c{{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
    position.fill(c.from.position);
    rate.fill_or_zero(c.from.velocity, 0.9);
    rate.fill_or_zero(c.from.acceleration, 0.8);
    position.fill(c.to.position);
    rate.fill_or_zero(c.to.velocity, 0.7);
    rate.fill_or_zero(c.to.acceleration, 0.6);
    if (ends != Ends::any) c.to.velocity = c.to.acceleration = zero;
    if (ends == Ends::rest_rest) c.from.velocity = c.from.acceleration = zero;
    limit.fill_beyond(c.limits.velocity, c.to.velocity);
    limit.fill_beyond(c.limits.acceleration, c.to.acceleration);
    limit.fill(c.limits.jerk);
    if (ends_inside(c)) out.push_back(c);
  }
  return out;
}

std::array<const Eigen::VectorXd*, 9> numbers_of(const Case& c) {
  return {&c.from.position,   &c.from.velocity,       &c.from.acceleration,
          &c.to.position,     &c.to.velocity,         &c.to.acceleration,
          &c.limits.velocity, &c.limits.acceleration, &c.limits.jerk};
}

/// The same numbers, problem after problem, as a batch reads them.
struct Flat {
  explicit Flat(const std::vector<Case>& all) {
    for (const Case& c : all) {
      const auto numbers = numbers_of(c);
      for (std::size_t k = 0; k < 9; ++k)
        parts[k].insert(parts[k].end(), numbers[k]->begin(), numbers[k]->end());
    }
  }
  detail::AxisBatchInput from(std::size_t problem) const {
    const auto at = [&](std::size_t k) { return parts[k].data() + problem * kAxes; };
    return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8)};
  }
  std::array<std::vector<double>, 9> parts;
};

/// Of the inputs, so that figures can be compared: the first 48 bits count.
std::string hash_of(const std::vector<Case>& all) {
  std::uint64_t hash = 1469598103934665603ULL;
  for (const Case& c : all) {
    for (const Eigen::VectorXd* part : numbers_of(c)) {
      for (const double x : *part)
        hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 1099511628211ULL;
    }
  }
  char text[32];
  std::snprintf(text, sizeof text, "inputs %016llx", static_cast<unsigned long long>(hash));
  return text;
}

double cpu_ns() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
}

/// Medians of passes in turn, `count` calls each: counters ours_ns and peer_ns.
template <typename Ours, typename Peer>
void side_by_side(benchmark::State& state, std::size_t count, Ours&& ours, Peer&& peer) {
  constexpr std::size_t kPasses = 7;
  std::array<double, kPasses> a, b;
  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    const double begin = cpu_ns();
    for (std::size_t k = 0; k < count; ++k) ours(k);
    const double middle = cpu_ns();
    for (std::size_t k = 0; k < count; ++k) peer(k);
    a[pass] = (middle - begin) / static_cast<double>(count);
    b[pass] = (cpu_ns() - middle) / static_cast<double>(count);
  }
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  state.counters["ours_ns"] = a[kPasses / 2];
  state.counters["peer_ns"] = b[kPasses / 2];
}

#ifdef HANDSEL_RUCKIG
std::vector<test::PeerProblem> for_peer(const std::vector<Case>& all) {
  std::vector<test::PeerProblem> out;
  for (const Case& c : all) {
    test::PeerProblem& p = out.emplace_back();
    const auto numbers = numbers_of(c);
    for (std::size_t k = 0; k < 9; ++k) {
      std::copy(numbers[k]->begin(), numbers[k]->end(),
                k < 3   ? p.from[k]
                : k < 6 ? p.to[k - 3]
                        : p.limits[k - 6]);
    }
  }
  return out;
}
#endif

void synchronised(benchmark::State& state, Ends ends) {
  const std::vector<Case> inputs = cases(ends);
  SynchronisedAxes solver(kAxes);
  std::size_t k = 0;
  long failures = 0;
  const auto ours = [&](std::size_t i) {
    const Case& c = inputs[i];
    failures += !solver.solve(c.from, c.to, c.limits);
    benchmark::DoNotOptimize(solver.duration());
  };
  for (auto _ : state) ours(k++ % kCases);
  state.SetLabel(hash_of(inputs));
#ifdef HANDSEL_RUCKIG
  test::RuckigPeer peer(for_peer(inputs));
  side_by_side(state, kCases, ours, [&](std::size_t i) { peer.solve(i); });
  long longer = 0, unsolved = 0;
  double differ = 0;
  for (std::size_t i = 0; i < kCases; ++i) {
    ours(i);
    if (!peer.solve(i)) {
      ++unsolved;
      continue;
    }
    const double more = solver.duration() / peer.duration() - 1;
    longer += more > 1e-9;
    differ = std::max(differ, std::abs(more));
  }
  state.counters["longer"] = static_cast<double>(longer);
  state.counters["peer_unsolved"] = static_cast<double>(unsolved);
  state.counters["differ"] = differ;
#endif
  state.counters["failures"] = static_cast<double>(failures);
}
BENCHMARK_CAPTURE(synchronised, rest_to_rest, Ends::rest_rest);
BENCHMARK_CAPTURE(synchronised, moving_to_rest, Ends::moving_rest);
BENCHMARK_CAPTURE(synchronised, any_to_any, Ends::any);

/// Eight problems at once; one iteration is one problem.
void eight_at_once(benchmark::State& state, Ends ends) {
  const std::vector<Case> inputs = cases(ends);
  const Flat flat(inputs);
  SynchronisedBatch batch(kAxes, kBatch);
  const auto ours = [&](std::size_t i) {
    if (i % kBatch == 0) benchmark::DoNotOptimize(batch.solve(flat.from(i % kCases), kBatch));
  };
  std::size_t k = 0;
  for (auto _ : state) ours(k++);
#ifdef HANDSEL_RUCKIG
  test::RuckigPeer peer(for_peer(inputs));
  side_by_side(state, kCases, ours, [&](std::size_t i) { peer.solve(i); });
#endif
}
BENCHMARK_CAPTURE(eight_at_once, rest_to_rest, Ends::rest_rest);
BENCHMARK_CAPTURE(eight_at_once, moving_to_rest, Ends::moving_rest);
BENCHMARK_CAPTURE(eight_at_once, any_to_any, Ends::any);

void one_axis(benchmark::State& state) {
  const std::vector<Case> inputs = cases(Ends::any);
  AxisProfile profile;
  std::size_t k = 0;
  for (auto _ : state) {
    const Case& c = inputs[k++ % kCases];
    benchmark::DoNotOptimize(
        solve_axis({c.from.position[0], c.from.velocity[0], c.from.acceleration[0]},
                   {c.to.position[0], c.to.velocity[0], c.to.acceleration[0]},
                   limits_of(c.limits, 0), profile));
  }
}
BENCHMARK(one_axis);

/// A motion of 7 axes, time going on by a tick.
void evaluate(benchmark::State& state) {
  const std::vector<Case> inputs = cases(Ends::any);
  const Case& c = inputs[0];
  const Trajectory trajectory = solve(c.from, c.to, c.limits).trajectory;
  const SegmentTable table(trajectory);
  MotionState3 out = trajectory.at(0);
  int cursor = 0;
  double t = 0;
  const auto ours = [&](std::size_t) {
    table.evaluate(t, cursor, out);
    benchmark::DoNotOptimize(out.position.data());
    benchmark::ClobberMemory();
    t += 0.001;
    if (t > table.duration()) t = 0;
  };
  for (auto _ : state) ours(0);
#ifdef HANDSEL_RUCKIG
  test::RuckigPeer peer(for_peer({c}));
  peer.solve(0);
  side_by_side(state, 100000, ours, [&](std::size_t) {
    peer.evaluate(t, out.position.data(), out.velocity.data(), out.acceleration.data());
    benchmark::ClobberMemory();
    t += 0.001;
    if (t > table.duration()) t = 0;
  });
#endif
}
BENCHMARK(evaluate);

void smooth_ten_nodes(benchmark::State& state) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-2, 2);
  const KinematicLimits limits{Eigen::VectorXd::Constant(kAxes, 1),
                               Eigen::VectorXd::Constant(kAxes, 2),
                               Eigen::VectorXd::Constant(kAxes, 8)};
  std::vector<std::vector<Eigen::VectorXd>> lines(
      64, std::vector<Eigen::VectorXd>(10, Eigen::VectorXd(kAxes)));
  for (auto& line : lines) {
    for (Eigen::VectorXd& q : line) {
      for (double& x : q) x = place(random);
    }
  }
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(smooth(lines[k++ % lines.size()], limits).trajectory.axes.data());
}
BENCHMARK(smooth_ten_nodes);

struct Running {
  Eigen::VectorXd one = Eigen::VectorXd::Ones(kAxes);
  KinematicLimits guard{one, 2 * one, 8 * one}, comfort{one / 1.1, 2 * one / 1.1, 8 * one / 1.1};
  Trajectory trajectory = straight_motion(Eigen::VectorXd::Zero(kAxes),
                                          Eigen::VectorXd::LinSpaced(kAxes, 1, 5), comfort);
  TimeScaling law;
  Running() { law.init(trajectory, guard); }
};

/// A control tick while alpha stays as it is. The peer's: its update while its target stays as it
/// is.
void control_tick(benchmark::State& state) {
  Running running;
  TimeScaling fresh = running.law;
  const auto ours = [&](std::size_t) {
    if (running.law.finished()) running.law = fresh;
    running.law.advance(0.001);
    benchmark::DoNotOptimize(running.law.state().position.data());
  };
  for (auto _ : state) ours(0);
#ifdef HANDSEL_RUCKIG
  Case c{rest_state(Eigen::VectorXd::Zero(kAxes)), final_state(running.trajectory),
         running.comfort};
  test::RuckigPeer peer(for_peer({c}));
  side_by_side(state, 100000, ours, [&](std::size_t) { peer.tick(0); });
#endif
}
BENCHMARK(control_tick);

/// A control tick of a motion whose alpha is asked to change every 0.2 s, forth and back.
void control_tick_while_alpha_changes(benchmark::State& state) {
  Running running;
  long tick = 0;
  double direction = 1;
  for (auto _ : state) {
    if (running.law.time() > 0.8 * running.law.duration()) direction = -1;
    if (running.law.time() < 0.2 * running.law.duration()) direction = 1;
    running.law.set_target(direction * (++tick % 400 < 200 ? 1.0 : 0.2));
    running.law.advance(0.001);
  }
}
BENCHMARK(control_tick_while_alpha_changes);

/// In motion onto another trajectory, found and joined in one tick.
void switch_over(benchmark::State& state) {
  Running running;
  for (int k = 0; k < 1500; ++k) running.law.advance(0.001);
  const SegmentTable next(straight_motion(Eigen::VectorXd::LinSpaced(kAxes, 0.2, 0.8),
                                          Eigen::VectorXd::LinSpaced(kAxes, -1, 2),
                                          running.comfort));
  TrajectorySwitch planner(kAxes);
  for (auto _ : state)
    benchmark::DoNotOptimize(planner.plan(running.law.state(), next, running.guard, {}));
}
BENCHMARK(switch_over);

void stop_measure(benchmark::State& state) {
  double v = 0.1;
  for (auto _ : state) {
    v = v < 1 ? v + 1e-4 : 0.1;
    benchmark::DoNotOptimize(measure_stop(v, 0.2, 2, 8));
  }
}
BENCHMARK(stop_measure);

}  // namespace
}  // namespace handsel
