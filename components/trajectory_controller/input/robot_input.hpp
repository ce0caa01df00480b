// SPDX-License-Identifier: Apache-2.0
// The robot as its side reports it: newest state, whether it follows set-points, and when
// set-points have to begin anew at its configuration. Pure.
#pragma once

#include "common/messages/robot.hpp"
#include "components/trajectory_controller/input/sample_time.hpp"

namespace handsel::trajectory_controller {

class RobotInput {
 public:
  /// Silence after which another robot side, somewhere else, may be what reports next [s].
  static constexpr double kGone = 0.5;

  /// Replaces the state. `age`: of the sample when it arrived; `new_writer`: another process writes
  /// it than the one before. Returns whether set-points have to begin at the reported
  /// configuration: it is the first one, or that of another robot side.
  bool set(const RobotState& state, TimePoint sampled, Duration age, bool new_writer);
  /// Notes the beginning of a cycle; after a gap of more than 0.1 s this process has slept.
  void begin_cycle(TimePoint now) noexcept;
  /// Returns whether set-points may be sent. They may not while this process has slept and has not
  /// received a state of the robot since, nor at rest when nobody is known to follow them: they
  /// would be the first ones of a robot side that comes up elsewhere.
  bool may_send(TimePoint now, bool at_rest) noexcept;
  /// Notes that the newest state was used.
  void mark_used() noexcept { new_state_ = false; }

  /// Newest state.
  const RobotState& state() const noexcept { return state_; }
  /// Returns whether a state has come since mark_used().
  bool has_new_state() const noexcept { return new_state_; }
  /// Returns whether the robot's configuration is known.
  bool ready() const noexcept { return ready_; }
  /// Returns the age of the newest state; -1 before any [s].
  double age(TimePoint now) const noexcept { return time_.age(now); }
  /// Returns how long after the newest state `sampled` is, in [0, 0.1]; 0 before any [s].
  double since(TimePoint sampled) const noexcept {
    return std::clamp(time_.since(sampled), 0.0, 0.1);
  }
  /// Returns whether the robot side follows set-points: it may stand although its drives are
  /// enabled.
  bool follows() const noexcept {
    return state_.mode == DriveMode::enabled && state_.refusal.empty();
  }

 private:
  RobotState state_;
  SampleTime time_;
  TimePoint last_cycle_{TimePoint::max()};
  bool new_state_{};
  bool ready_{};
  bool asleep_{};
};

}  // namespace handsel::trajectory_controller
