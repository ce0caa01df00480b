// The pace of the system when the simulator gives it: when the next step of the world may be made,
// and how far the components may let their time advance. Pure: the machine's time ("wall") is
// handed in.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/bus/paced_clock.hpp"
#include "sim/scene/settings.hpp"

namespace handsel::sim {

/// Time of the system is wall less waited(). A step waits for its set-point as long as set-points
/// come, and at each boundary of a clock_period for every component's answer to the grant before;
/// both no longer than max_wait, and not for a process that has been stopped. Time that steps come
/// late by more than max_lag is waited: so is the time for which the simulator itself gets no
/// processor.
class TimeKeeper {
 public:
  explicit TimeKeeper(const SimSettings& settings);

  /// A component answered a grant. The first answer makes it one that is waited for.
  void answered(const std::string& component, std::uint64_t process, std::uint64_t grant);
  /// Asks `runs` for each component's process, when a step has been held up for 50 ms, and does not
  /// wait for those that do not run.
  void leave_out_stopped(const std::function<bool(std::uint64_t process)>& runs);
  /// Called before the steps of a turn; the first call starts time.
  void turn(TimePoint wall);
  /// Whether the next step may be made. `has_setpoint`: its set-point has come.
  bool may_step(bool has_setpoint);
  /// Whether the next step takes a set-point: the controller sends one every few steps.
  bool takes_setpoint() const { return steps_ % per_setpoint_ == 0; }
  void stepped();  ///< To be called after each step: advances time() by one step.
  /// Number of the newest grant, from 1 on.
  std::uint64_t grant_number() const { return grant_; }
  /// Returns the newest grant: components may let their time advance to the end of the clock period
  /// after the one under way.
  TimeGrant grant() const;
  /// Time of the next step.
  TimePoint time() const { return start_ + period_ * static_cast<std::int64_t>(steps_); }
  /// Time by which the system is behind the wall clock.
  Duration waited() const { return waited_; }

 private:
  struct Answer {
    std::uint64_t process{}, grant{};
  };
  bool everybody_answered() const;
  /// For those: they are waited for again once they answer.
  void stop_waiting(const std::function<bool(const Answer&)>& selected);

  Duration period_, clock_period_, max_lag_, max_wait_;
  std::uint64_t per_setpoint_;
  bool started_{false}, setpoints_flow_{false};
  TimePoint start_{}, wall_{};
  // blocked_: by the same step, while the simulator itself could continue.
  Duration waited_{}, blocked_{}, checked_{};
  std::uint64_t steps_{0}, grant_{0};
  std::map<std::string, Answer> answers_;
};

}  // namespace handsel::sim
