// SPDX-License-Identifier: Apache-2.0
// A running system, real processes over DDS, that is always busy: it picks up a mug and puts the
// mug down again.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/config/resources.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/stop.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel::test {

inline std::string environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

/// A running system with something to do at all times: a mug is picked up and put down again.
class BusySystem {
 public:
  explicit BusySystem(int domain)
      : system_({.domain = domain, .scenario = "give_mug", .seed = 11, .web_port = 0}) {
    const RobotModel robot = RobotModel::load(robot_description(robot_of(system_.options())));
    arm_ = robot.require_group("arm").axes;
    const KinematicLimits &comfort = robot.comfort_limits(), &stop = robot.stop_limits();
    for (const int axis : arm_)
      longest_stop_ =
          std::max(longest_stop_, measure_stop(comfort.velocity[axis], comfort.acceleration[axis],
                                               stop.acceleration[axis], stop.jerk[axis])
                                      .duration);
    Bus& bus = system_.session().bus();
    sim_ = bus.advertise<SimControl>();
    system_.session().observer().on_event([this](const TimelineEvent& event) {
      if (events_.size() < kMaxEvents) events_.push_back(event);
    });
    bus.subscribe<RobotState>([this](const RobotState& state, const Receipt&) { watch(state); });
  }

  /// Waits until the system is ready; false: timeout. Anna then refuses the mug, because taking it
  /// from an arm at rest would move the arm.
  bool ready() {
    if (!system_.wait_ready(kReadyTimeout)) return false;
    disturb(SimAction::person_refuse, 0.0, "anna");
    return true;
  }
  const Snapshot& now() { return system_.session().snapshot(); }
  const SafetyState& safety() { return now().safety.sample; }
  std::uint64_t incarnation(const std::string& process) {
    const auto found = now().health.find(process);
    return found == now().health.end() ? 0 : found->second.sample.incarnation;
  }
  bool is_ok(const std::string& process) {
    const auto found = now().health.find(process);
    return found != now().health.end() && found->second.sample.state == HealthState::ok;
  }
  /// Returns whether the arm is on a long path in free space: closing fingers also count as motion,
  /// and their contact moves the arm.
  bool travels() {
    const ActionPhase phase = now().action.sample.phase;
    const bool approaches = phase == ActionPhase::approach;
    return moves() && (approaches || phase == ActionPhase::carry || phase == ActionPhase::to_rest);
  }
  bool moves() { return now().ground_truth.ever && now().ground_truth.sample.robot_moving; }
  void kill(const std::string& process) {
    const pid_t pid = system_.launcher().pid(process);
    ASSERT_GT(pid, 0) << process;
    ::kill(pid, SIGKILL);
  }
  void say(TaskKind kind, double value = 0.0) {
    TaskGoal goal{.id = system_.session().new_task_id(), .kind = kind};
    goal.value = value;
    said_ = goal.id;
    system_.session().send(goal);
  }
  void stop_robot(const std::string& how) { disturb(SimAction::robot_stop, 0.0, how); }
  void disturb(SimAction action, double value = 0.0, const std::string& subject = "") {
    system_.session().wait(from_seconds(1.0), [&] { return sim_->readers() > 0; });
    sim_->publish({.action = action, .subject = subject, .value = value});
  }
  /// The task given last.
  std::uint64_t task() const { return goal_.id; }
  /// Longest jerk-limited stop of an axis of the arm, from its comfort velocity and acceleration
  /// [s].
  double longest_stop() const { return longest_stop_; }
  bool answered() {
    const auto found = now().tasks.find(said_);
    return found != now().tasks.end() && is_over(found->second.state);
  }

  /// Waits until `done`, giving tasks all the while.
  bool wait(Duration limit, const std::function<bool()>& done) {
    return system_.wait(limit, [&] {
      keep_busy();
      return done();
    });
  }
  void listen(Duration time) {
    wait(time, [] { return false; });
  }
  /// From now on the largest deviation of an axis of the arm counts.
  void mark() {
    events_.clear();
    marked_at_ = monotonic_now();
    marked_.resize(0);
    deviation_ = 0.0;
    fastest_ = 0.0;
  }
  double deviation() const { return deviation_; }
  /// Returns the events since mark().
  std::string timeline() {
    std::string out;
    const GroundTruth& ground_truth = now().ground_truth.sample;
    const Vector3 at = ground_truth.T_world_object.translation();
    char text[160];
    std::snprintf(text, sizeof text, "  %s at %.3f %.3f %.3f, carried by %s\n",
                  ground_truth.object.c_str(), at.x(), at.y(), at.z(),
                  ground_truth.carrier.c_str());
    out += text;
    out += "  execution: " + now().execution.sample.reason + "; external torque [Nm]";
    for (const int axis : arm_)
      if (axis < torque_.size()) out += " " + std::to_string(torque_[axis]);
    out += "\n";
    for (const TimelineEvent& event : events_)
      out += "  " + std::to_string(to_seconds(event.at - marked_at_)) + " s  " + event.text + "\n";
    return out;
  }
  /// Largest speed factor in force since mark().
  double fastest() const { return fastest_; }

 private:
  void watch(const RobotState& state) {
    torque_ = state.external_torque;
    if (marked_.size() == 0) marked_ = state.position, marked_reference_ = state.reference.position;
    for (const int axis : arm_) {
      const double off = state.position[axis] - marked_[axis];
      for (const double step : {5e-4, 5e-3, 2e-2})
        if (deviation_ < step && std::abs(off) >= step) note_motion(state, axis, off);
      deviation_ = std::max(deviation_, std::abs(off));
    }
    if (now().active.ever)
      fastest_ = std::max(fastest_, std::abs(now().active.sample.speed_factor));
  }
  /// Writes into the timeline that an axis has moved though nothing should.
  void note_motion(const RobotState& state, int axis, double off) {
    const auto i = static_cast<Eigen::Index>(axis);
    std::string text = "axis " + std::to_string(axis) + " has moved by " + std::to_string(off);
    const double by = state.reference.position.size() > i
                          ? state.reference.position[i] - marked_reference_[i]
                          : 0.0;
    text += " rad, its reference by " + std::to_string(by) + " rad " + state.refusal;
    events_.push_back({monotonic_now(), text});
  }
  /// Gives the next task when the last one is over; a supervisor that was started anew is asked
  /// again.
  void keep_busy() {
    Session& session = system_.session();
    const TimePoint time = session.bus().now();
    if (time - sent_ < kTaskSilence) return;
    const auto status = now().tasks.find(goal_.id);
    const bool over = status != now().tasks.end() && is_over(status->second.state);
    const bool silent = time - now().task.arrival >= kTaskSilence;
    if (goal_.id != 0 && !over && !silent && status != now().tasks.end()) return;
    if (goal_.id == 0 || over) {
      const bool holds = now().ground_truth.sample.carrier == "robot";
      goal_ = {.id = session.new_task_id(),
               .kind = holds ? TaskKind::place : TaskKind::pick,
               .object = "mug"};
      if (holds) goal_.surface = "table";
    }
    session.publish(goal_);
    sent_ = time;
  }

  System system_;
  std::vector<int> arm_;
  double longest_stop_{};
  std::unique_ptr<Publisher<SimControl>> sim_;
  TaskGoal goal_;
  TimePoint sent_{};
  std::uint64_t said_{};
  static constexpr std::size_t kMaxEvents = 1000;
  std::vector<TimelineEvent> events_;
  TimePoint marked_at_{};
  Vector marked_, marked_reference_, torque_;
  double deviation_{}, fastest_{};
};

}  // namespace handsel::test
