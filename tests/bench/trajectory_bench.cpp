// Soft motion: time of one solution, evaluation, smoothing, control tick. Inputs are drawn as in the peer's own benchmark: positions
// normal with deviation 4, velocities and accelerations 0.8 within limits uniform in [0.1, 12] above them.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/min_time.hpp"
#include "common/trajectory/segment_table.hpp"
#include "common/trajectory/smooth.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/stop.hpp"
#include "common/trajectory/time_law.hpp"

namespace handsel {
namespace {

constexpr int kAxes = 7;
constexpr int kCases = 4096;
enum class Ends { rest_rest, moving_rest, any };

struct Case {
  MotionState3 from, to;
  KinematicLimits limits;
};

std::vector<Case> cases(Ends ends) {
  std::mt19937_64 random(42);
  std::normal_distribution<double> place(0, 4), rate(0, 0.8);
  std::uniform_real_distribution<double> room(0.1, 12);
  std::vector<Case> out(kCases);
  for (Case& c : out) {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(kAxes);
    c.from = c.to = {zero, zero, zero};
    c.limits = {zero, zero, zero};
    for (int i = 0; i < kAxes; ++i) {
      c.from.position[i] = place(random), c.to.position[i] = place(random);
      if (ends != Ends::rest_rest) c.from.velocity[i] = rate(random), c.from.acceleration[i] = rate(random);
      if (ends == Ends::any) c.to.velocity[i] = rate(random), c.to.acceleration[i] = rate(random);
      c.limits.jerk[i] = room(random) + 0.5;
      c.limits.acceleration[i] = room(random) + std::max(std::abs(c.from.acceleration[i]), std::abs(c.to.acceleration[i]));
      const double v0 = std::abs(c.from.velocity[i]) + c.from.acceleration[i] * c.from.acceleration[i] / (2 * c.limits.jerk[i]);
      const double vf = std::abs(c.to.velocity[i]) + c.to.acceleration[i] * c.to.acceleration[i] / (2 * c.limits.jerk[i]);
      c.limits.velocity[i] = room(random) + std::max(v0, vf);
    }
  }
  return out;
}

void synchronised(benchmark::State& state, Ends ends) {
  const std::vector<Case> inputs = cases(ends);
  SynchronisedAxes solver(kAxes);
  std::size_t k = 0;
  long failures = 0;
  for (auto _ : state) {
    const Case& c = inputs[k++ % kCases];
    failures += !solver.solve(c.from, c.to, c.limits);
    benchmark::DoNotOptimize(solver.duration());
  }
  state.counters["failures"] = static_cast<double>(failures);
}
BENCHMARK_CAPTURE(synchronised, rest_to_rest, Ends::rest_rest);
BENCHMARK_CAPTURE(synchronised, moving_to_rest, Ends::moving_rest);
BENCHMARK_CAPTURE(synchronised, any_to_any, Ends::any);

void one_axis(benchmark::State& state) {
  const std::vector<Case> inputs = cases(Ends::any);
  AxisProfile profile;
  std::size_t k = 0;
  for (auto _ : state) {
    const Case& c = inputs[k++ % kCases];
    benchmark::DoNotOptimize(solve_axis({c.from.position[0], c.from.velocity[0], c.from.acceleration[0]},
                                        {c.to.position[0], c.to.velocity[0], c.to.acceleration[0]}, limits_of(c.limits, 0), profile));
  }
}
BENCHMARK(one_axis);

void evaluate(benchmark::State& state) {
  const Case c = cases(Ends::any)[0];
  const Trajectory trajectory = solve(c.from, c.to, c.limits).trajectory;
  const SegmentTable table(trajectory);
  MotionState3 out = trajectory.at(0);
  int cursor = 0;
  double t = 0;
  for (auto _ : state) {
    table.evaluate(t, cursor, out);
    benchmark::DoNotOptimize(out.position.data());
    benchmark::ClobberMemory();
    t += 0.001;
    if (t > table.duration()) t = 0;
  }
}
BENCHMARK(evaluate);

void smooth_ten_nodes(benchmark::State& state) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-2, 2);
  const KinematicLimits limits{Eigen::VectorXd::Constant(kAxes, 1), Eigen::VectorXd::Constant(kAxes, 2),
                               Eigen::VectorXd::Constant(kAxes, 8)};
  std::vector<std::vector<Eigen::VectorXd>> lines(64, std::vector<Eigen::VectorXd>(10, Eigen::VectorXd(kAxes)));
  for (auto& line : lines) {
    for (Eigen::VectorXd& q : line) {
      for (double& x : q) x = place(random);
    }
  }
  std::size_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(smooth(lines[k++ % lines.size()], limits).trajectory.axes.data());
}
BENCHMARK(smooth_ten_nodes);

void time_law_tick(benchmark::State& state) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(kAxes);
  const KinematicLimits guard{one, 2 * one, 8 * one}, comfort{one / 1.1, 2 * one / 1.1, 8 * one / 1.1};
  const bool changing = state.range(0) != 0;
  TimeLaw law;
  law.init(straight_motion(Eigen::VectorXd::Zero(kAxes), Eigen::VectorXd::LinSpaced(kAxes, 1, 5), comfort), guard);
  long tick = 0;
  double direction = 1;
  for (auto _ : state) {
    if (law.time() > 0.8 * law.duration()) direction = -1;
    if (law.time() < 0.2 * law.duration()) direction = 1;
    law.set_target(changing ? direction * (++tick % 400 < 200 ? 1.0 : 0.2) : direction);
    law.advance(0.001);
  }
}
BENCHMARK(time_law_tick)->Arg(0)->Arg(1)->ArgName("changing");

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
