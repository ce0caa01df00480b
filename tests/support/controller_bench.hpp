// SPDX-License-Identifier: Apache-2.0
// A controller in virtual time with an ideal or faulty robot, people, and all other senders.
#pragma once

#include <algorithm>
#include <deque>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/stop.hpp"
#include "components/trajectory_controller/controller.hpp"
#include "tests/support/processes/live_view.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::test {

class ControllerBench {
 public:
  explicit ControllerBench(const trajectory_controller::ControllerSettings& with = {})
      : settings(with), robot(small_robot()), core(with, robot) {
    measured = measured_velocity = Vector::Zero(robot->dof());
    people.covered = true;
    people.views = {live_view()};
    Go first;  // permits no motion: the controller requires a newer one
    first.state_revision = 1;
    core.on(first, now);
    go.epoch = 1;
    go.allowed = true;
  }

  /// One period: sources speak at their rates unless silenced, then the controller steps.
  bool tick() {
    now += from_seconds(settings.period);
    ++ticks;
    if (robot_speaks && ticks % 2 == 0) {
      RobotState s;
      s.robot = "small";
      s.sequence = static_cast<std::uint64_t>(ticks);
      s.position = measured;
      s.velocity = measured_velocity;
      s.effort = Vector::Zero(robot->dof());
      s.mode = drive;
      s.refusal = refusal;
      s.reference = reference;
      s.external_torque = external_torque;
      core.on(s, now);
      robot_at_ = now;
      drive_told_ = drive;
    }
    if (human_speaks && ticks % 33 == 1) {
      seen_.push_back({now, people});
      while (seen_.size() > 1 && seen_[1].first <= now - from_seconds(human_age)) seen_.pop_front();
      human_at_ = std::max(human_at_, std::min(seen_.front().first, now));
      core.on(seen_.front().second, human_at_);
    }
    if (go_speaks && ticks % 100 == 1) {
      go.state_revision = go.epoch + 1;  // each new epoch follows an act of a person
      core.on(go, now);
      go_told_ = go.allowed;
    }
    if (forecast_speaks && ticks % 20 == 1) {
      core.on(forecast, now);
      forecast_at_ = now;
    }
    if (attention_speaks && ticks % 20 == 1) core.on(advice, now);
    const MotionState3 before = core.set_point();
    const bool was_ready = ready;
    const std::uint64_t heap_before = count_allocations ? count_allocations() : 0;
    ready = core.step(now, late);
    if (count_allocations) allocations += count_allocations() - heap_before;
    if (ready && drive == DriveMode::enabled && follows) measured = core.set_point().position;
    if (ready && was_ready) {
      check(before, core.set_point());
      watch_stops();
    }
    return ready;
  }
  void run(double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / settings.period + 0.5); ++k) tick();
  }
  /// Ready, in mode normal, at rest.
  void start() { run(0.2); }

  TrajectoryCommand command(const Vector& arm_goal, std::uint64_t id) const {
    TrajectoryCommand c;
    c.robot = "small";
    c.id = id;
    c.epoch = go.epoch;
    c.axes = {0, 1, 2};
    const MotionState3 from = rest_state(core.set_point().position.head(3)),
                       to = rest_state(arm_goal);
    const KinematicLimits& l = robot->comfort_limits();
    c.trajectory =
        solve(from, to, {l.velocity.head(3), l.acceleration.head(3), l.jerk.head(3)}).trajectory;
    return c;
  }
  /// The same for all axes of the robot.
  TrajectoryCommand command_all(const Vector& goal, std::uint64_t id) const {
    TrajectoryCommand c = command(goal.head(3), id);
    c.axes.resize(static_cast<std::size_t>(robot->dof()));
    std::iota(c.axes.begin(), c.axes.end(), 0u);
    c.trajectory =
        solve(rest_state(core.set_point().position), rest_state(goal), robot->comfort_limits())
            .trajectory;
    return c;
  }
  std::string send(TrajectoryCommand c, double age = 0.0, double switch_at = 0.0) {
    c.switch_at = switch_at;
    return core.accept(c, from_seconds(age), now);
  }
  std::string go_to(const Vector& arm_goal, std::uint64_t id) {
    return send(command(arm_goal, id));
  }
  static Vector arm(double a, double b, double c) {
    Vector q(3);
    q << a, b, c;
    return q;
  }
  Person standing(double x, double y) const {
    Person p;
    p.id = "anna";
    p.joints = standing_body(Vector3(x, y, 0), M_PI, 1.75);
    return p;
  }
  bool at_rest() const {
    return core.set_point().velocity.isZero(0.0) && core.set_point().acceleration.isZero(0.0);
  }

  trajectory_controller::ControllerSettings settings;
  std::shared_ptr<const RobotModel> robot;
  trajectory_controller::Controller core;
  TimePoint now{from_seconds(50.0)};
  long ticks{};
  bool ready{}, late{};
  Vector measured, measured_velocity;
  bool follows{true};
  DriveMode drive{DriveMode::enabled};
  std::string refusal;       ///< why the robot side is at rest although its drives are enabled
  ServoReference reference;  ///< of the robot side; empty: not known
  Vector external_torque;    ///< empty: not measured
  bool robot_speaks{true}, human_speaks{true}, go_speaks{true}, forecast_speaks{true},
      attention_speaks{true};
  HumanState people;
  double human_age{};  ///< min age of the reported people; max: one sample period more [s]
                       ///< [s]
  Go go;
  TrajectoryForecast forecast;
  AttentionAdvice advice;

  // Oracle over every set-point sent, independent of the controller's own check.
  double worst_velocity{}, worst_acceleration{}, worst_jerk{}, worst_jump{};
  // Oracle over every stop: at rest within detection time + the fastest stop from the state at that
  // moment + 50 ms.
  int stops{}, holds{};                         ///< begun in motion
  double latest_stop{-1.0}, latest_hold{-1.0};  ///< beyond the fastest stop [s]; 0.05 is promised
  std::uint64_t (*count_allocations)(){};       ///< where the heap is watched
  std::uint64_t allocations{};                  ///< of all steps

 private:
  struct StopWatch {
    bool on{}, rested{};
    TimePoint due{};
    double fastest{};
    void look(bool cause, bool rests, TimePoint at, double least, int& count, double& latest) {
      if (!cause || rested) {
        rested = cause;
        on = false;
        return;
      }
      if (!on) {
        on = true;
        due = at + from_seconds(least);
        count += rests ? 0 : 1;
      }
      if (!rests) latest = std::max(latest, to_seconds(at - due));
      rested = rests;
    }
  };
  double fastest_stop() const {
    double longest = 0.0;
    const MotionState3& s = core.set_point();
    const KinematicLimits& l = robot->stop_limits();
    for (Eigen::Index i = 0; i < s.position.size(); ++i)
      longest = std::max(
          longest,
          measure_stop(s.velocity[i], s.acceleration[i], l.acceleration[i], l.jerk[i]).duration);
    return longest;
  }
  void watch_stops() {
    const trajectory_controller::TimeoutSettings& t = settings.timeouts;
    const auto silent = [&](TimePoint at, double limit) { return to_seconds(now - at) > limit; };
    const bool stop = silent(robot_at_, t.robot_state) || silent(human_at_, t.human_state) ||
                      drive_told_ != DriveMode::enabled;
    const bool running = core.status_key().motion == MotionState::running;
    const double since = running ? running_for_ += settings.period : running_for_ = 0.0;
    const bool hold =
        !stop && (!go_told_ || (running && since > t.forecast && silent(forecast_at_, t.forecast)));
    const double least = fastest_stop();
    stop_.look(stop, at_rest(), now, least, stops, latest_stop);
    // A stop that becomes a hold adds no requirement: an arm that was at rest may comply.
    hold_.look(stop || hold, at_rest(), now, least, holds, latest_hold);
  }
  std::deque<std::pair<TimePoint, HumanState>> seen_;
  TimePoint robot_at_{from_seconds(50.0)}, human_at_{robot_at_}, forecast_at_{robot_at_};
  DriveMode drive_told_{DriveMode::enabled};
  bool go_told_{true};
  double running_for_{};
  StopWatch stop_, hold_;

  void check(const MotionState3& a, const MotionState3& b) {
    const KinematicLimits& g = robot->guard_limits();
    const double dt = settings.period;
    for (Eigen::Index i = 0; i < b.position.size(); ++i) {
      worst_velocity = std::max(worst_velocity, std::abs(b.velocity[i]) / g.velocity[i]);
      worst_acceleration =
          std::max(worst_acceleration, std::abs(b.acceleration[i]) / g.acceleration[i]);
      worst_jerk =
          std::max(worst_jerk, std::abs(b.acceleration[i] - a.acceleration[i]) / dt / g.jerk[i]);
      worst_jerk = std::max(
          worst_jerk, (std::abs(b.velocity[i] - a.velocity[i] - dt * a.acceleration[i]) - 1e-12) /
                          (g.jerk[i] * dt * dt / 2.0));
      const double moved =
          b.position[i] - a.position[i] - dt * a.velocity[i] - 0.5 * dt * dt * a.acceleration[i];
      worst_jump =
          std::max(worst_jump, (std::abs(moved) - 1e-12) / (g.jerk[i] * dt * dt * dt / 6.0));
    }
  }
};

}  // namespace handsel::test
