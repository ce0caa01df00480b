// A controller in virtual time with a robot that follows perfectly (or not), people, and everybody else who speaks to it.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"
#include "components/trajectory_controller/controller.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::test {

class ControllerBench {
 public:
  explicit ControllerBench(const trajectory_controller::ControllerSettings& with = {})
      : settings(with), robot(small_robot()), core(with, robot) {
    measured = Vector::Zero(robot->dof());
    people.covered = true;
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
      s.velocity = s.effort = Vector::Zero(robot->dof());
      s.mode = drive;
      core.on(s, now);
    }
    if (human_speaks && ticks % 33 == 1) core.on(people, now);
    if (go_speaks && ticks % 100 == 1) core.on(go, now);
    if (forecast_speaks && ticks % 20 == 1) core.on(forecast, now);
    if (attention_speaks && ticks % 20 == 1) core.on(advice, now);
    const MotionState3 before = core.set_point();
    const bool was_ready = ready;
    ready = core.step(now, late);
    if (ready && drive == DriveMode::enabled && follows) measured = core.set_point().position;
    if (ready && was_ready) check(before, core.set_point());
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
    const MotionState3 from = rest_state(core.set_point().position.head(3)), to = rest_state(arm_goal);
    const KinematicLimits& l = robot->comfort_limits();
    c.trajectory = solve(from, to, {l.velocity.head(3), l.acceleration.head(3), l.jerk.head(3)}).trajectory;
    return c;
  }
  std::string send(const TrajectoryCommand& c, double age = 0.0) { return core.accept(c, from_seconds(age), now); }
  std::string go_to(const Vector& arm_goal, std::uint64_t id) { return send(command(arm_goal, id)); }
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
  bool at_rest() const { return core.set_point().velocity.isZero(0.0) && core.set_point().acceleration.isZero(0.0); }

  trajectory_controller::ControllerSettings settings;
  std::shared_ptr<const RobotModel> robot;
  trajectory_controller::Controller core;
  TimePoint now{from_seconds(50.0)};
  long ticks{};
  bool ready{}, late{};
  Vector measured;
  bool follows{true};
  DriveMode drive{DriveMode::enabled};
  bool robot_speaks{true}, human_speaks{true}, go_speaks{true}, forecast_speaks{true}, attention_speaks{true};
  HumanState people;
  Go go;
  TrajectoryForecast forecast;
  AttentionAdvice advice;

  // Oracle over every set-point sent, written apart from the controller's own check.
  double worst_velocity{}, worst_acceleration{}, worst_jerk{}, worst_jump{};

 private:
  void check(const MotionState3& a, const MotionState3& b) {
    const KinematicLimits& g = robot->guard_limits();
    const double dt = settings.period;
    for (Eigen::Index i = 0; i < b.position.size(); ++i) {
      worst_velocity = std::max(worst_velocity, std::abs(b.velocity[i]) / g.velocity[i]);
      worst_acceleration = std::max(worst_acceleration, std::abs(b.acceleration[i]) / g.acceleration[i]);
      worst_jerk = std::max(worst_jerk, std::abs(b.acceleration[i] - a.acceleration[i]) / dt / g.jerk[i]);
      worst_jerk =
          std::max(worst_jerk, (std::abs(b.velocity[i] - a.velocity[i] - dt * a.acceleration[i]) - 1e-12) / (g.jerk[i] * dt * dt / 2.0));
      const double moved = b.position[i] - a.position[i] - dt * a.velocity[i] - 0.5 * dt * dt * a.acceleration[i];
      worst_jump = std::max(worst_jump, (std::abs(moved) - 1e-12) / (g.jerk[i] * dt * dt * dt / 6.0));
    }
  }
};

}  // namespace handsel::test
