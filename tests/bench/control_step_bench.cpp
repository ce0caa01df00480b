// SPDX-License-Identifier: Apache-2.0
// Time of one control step of Jido (22 axes) beside a person: p50, p99, p99.9 and the part of each
// phase of the scenario; time to accept a trajectory, which happens between two steps; and time to
// check the whole remaining path against a newly observed person. Prints times, without limits.
// Usage: bench_control_step [steps] [repeats]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "common/config/resources.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"
#include "components/collision_checker/forecaster.hpp"
#include "components/trajectory_controller/controller.hpp"
#include "tests/support/processes/live_view.hpp"

namespace {

using namespace handsel;
using namespace handsel::trajectory_controller;

struct Run {
  std::vector<double> all, standing, full, changing,
      accepting;  // [us]: at rest, constant factor, factor that changes; accept()
  std::uint64_t trajectories{};
};

double since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
      .count();
}

double at(const std::vector<double>& times, double share) {
  if (times.empty()) return 0.0;
  return times[std::min(times.size() - 1,
                        static_cast<std::size_t>(share * static_cast<double>(times.size())))];
}

void print(const char* what, std::vector<double>& times) {
  std::sort(times.begin(), times.end());
  std::printf("  %-10s %7zu steps  p50 %6.2f  p99 %6.2f  p99.9 %6.2f  max %6.1f us\n", what,
              times.size(), at(times, 0.5), at(times, 0.99), at(times, 0.999),
              times.empty() ? 0.0 : times.back());
}

Run run(const std::shared_ptr<const RobotModel>& robot, int steps) {
  Run out;
  Controller core({}, robot);
  TimePoint now{from_seconds(10)};
  RobotState state;
  state.robot = robot->name();
  state.position = robot->rest_configuration();
  state.velocity = state.effort = Vector::Zero(robot->dof());
  state.mode = DriveMode::enabled;
  HumanState people;
  people.covered = true;
  people.views = {test::live_view()};
  Person person;
  person.id = "anna";
  person.joints = standing_body(Vector3(1.4, 0.2, 0), M_PI, 1.75);
  people.people = {person};
  Go go;
  go.state_revision = 1;
  core.on(go, now);  // the first epoch permits no motion
  go.epoch = 1;
  go.allowed = true;
  AttentionAdvice advice;
  TrajectoryForecast forecast;
  const Group& arm = robot->require_group("arm");
  const auto of_arm = [&](const Vector& v) { return RobotModel::part(v, arm); };
  const KinematicLimits comfort{of_arm(robot->comfort_limits().velocity),
                                of_arm(robot->comfort_limits().acceleration),
                                of_arm(robot->comfort_limits().jerk)};
  for (int k = 0; k < steps; ++k) {
    now += std::chrono::milliseconds(1);
    if (k % 2 == 0) {
      if (k > 0) state.position = core.set_point().position;
      ++state.sequence;
      core.on(state, now);
    }
    if (k % 33 == 0) core.on(people, now);
    if (k % 100 == 0) core.on(go, now);
    if (k % 20 == 0) {
      advice.speed_factor = (k / 700) % 3 == 2 ? 0.3 : (k / 2100) % 4 == 3 ? -0.5 : 1.0;
      core.on(advice, now);
      core.on(forecast, now);
    }
    if (k > 100 && core.status_key().motion != MotionState::running) {
      TrajectoryCommand c;
      c.robot = robot->name();
      c.id = ++out.trajectories;
      c.epoch = 1;
      Vector goal = of_arm(robot->rest_configuration());
      for (Eigen::Index i = 0; i < goal.size(); ++i)
        goal[i] += (c.id % 2 ? 0.4 : -0.2) * (i % 2 ? 1 : -1);
      for (int axis : arm.axes) c.axes.push_back(static_cast<std::uint32_t>(axis));
      c.trajectory = solve(rest_state(of_arm(core.set_point().position)), rest_state(goal), comfort)
                         .trajectory;
      const auto begin = std::chrono::steady_clock::now();
      if (const std::string why = core.accept(c, Duration(0), now); !why.empty())
        std::printf("refused: %s\n", why.c_str());
      out.accepting.push_back(since(begin));
    }
    const double before = core.speed_factor();
    const auto begin = std::chrono::steady_clock::now();
    core.step(now, false);
    const double us = since(begin);
    out.all.push_back(us);
    const bool moving = core.status_key().motion == MotionState::running;
    (!moving                         ? out.standing
     : core.speed_factor() == before ? out.full
                                     : out.changing)
        .push_back(us);
  }
  return out;
}

/// A person walks past while the arm sweeps: each sample checks the whole path within the horizon.
std::vector<double> judge_paths(const RobotModel& robot, int times) {
  collision_checker::Forecaster forecaster(robot, {}, {}, {});
  const Group& arm = robot.require_group("arm");
  const auto of_arm = [&](const Vector& v) { return RobotModel::part(v, arm); };
  ActiveTrajectory active;
  active.robot = robot.name();
  active.trajectory = 1;
  active.speed_factor = 1.0;
  active.position = robot.rest_configuration();
  active.velocity = active.acceleration = Vector::Zero(robot.dof());
  active.axes.assign(arm.axes.begin(), arm.axes.end());
  const Vector from = of_arm(robot.rest_configuration());
  active.rest =
      solve(rest_state(from), rest_state(from + Vector::Constant(from.size(), 0.4)),
            {of_arm(robot.comfort_limits().velocity), of_arm(robot.comfort_limits().acceleration),
             of_arm(robot.comfort_limits().jerk)})
          .trajectory;
  HumanState people;
  people.covered = true;
  Person person;
  person.id = "anna";
  std::vector<double> out;
  for (int k = 0; k < times; ++k) {
    person.joints = standing_body(Vector3(1.6, -1.0 + 2.0 * k / times, 0), M_PI, 1.75);
    people.people = {person};
    const auto begin = std::chrono::steady_clock::now();
    forecaster.set_people(people);
    forecaster.forecast(active);
    out.push_back(since(begin));
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const int steps = argc > 1 ? std::atoi(argv[1]) : 60000,
            repeats = argc > 2 ? std::atoi(argv[2]) : 5;
  const auto robot =
      std::make_shared<const RobotModel>(RobotModel::load(robot_description("jido")));
  std::printf("%d axes, %zu robot capsules, %d capsules of a person\n", robot->dof(),
              robot_capsules(*robot).size(), kBodyCapsules);
  std::vector<double> fastest;
  for (int k = 0; k < repeats; ++k) {
    Run r = run(robot, steps);
    if (fastest.empty()) fastest = r.all;
    for (std::size_t i = 0; i < fastest.size(); ++i) fastest[i] = std::min(fastest[i], r.all[i]);
    if (k + 1 < repeats) continue;
    std::printf("last of %d runs, %llu trajectories:\n", repeats,
                static_cast<unsigned long long>(r.trajectories));
    print("all", r.all);
    print("standing", r.standing);
    print("constant", r.full);
    print("changing", r.changing);
    print("accepting", r.accepting);
  }
  std::printf("least of %d runs, step by step (the algorithm without the machine):\n", repeats);
  print("all", fastest);
  std::vector<double> path_times = judge_paths(*robot, 2000);
  std::printf("all of the path within 1.5 s against a person just seen:\n");
  print("judging", path_times);
}
