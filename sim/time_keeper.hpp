// SPDX-License-Identifier: Apache-2.0
// Paces the system with simulated time: decides when the next step of the world may be made, and up
// to which time the components may advance. Pure: the machine's time ("wall") is an argument.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/bus/paced_clock.hpp"
#include "sim/scene/settings.hpp"

namespace handsel::sim {

/// The time of the system is the wall time less waited(). A step waits for its set-point while
/// set-points arrive, and at each boundary of a clock_period for every component's answer to the
/// previous grant. Both waits end after max_wait and exclude stopped processes. A delay of the
/// steps beyond max_lag is added to waited(), including time for which the simulator has no
/// processor.
class TimeKeeper {
 public:
  explicit TimeKeeper(const SimSettings& settings);

  /// Records a component's answer to a grant. From the first answer on the steps wait for the
  /// component. `process`: incarnation of its process.
  void answered(const std::string& component, std::uint64_t process, std::uint64_t grant);
  /// Once a step has been delayed by 50 ms, calls `runs` for each component's process, and no
  /// longer waits for processes that do not run.
  void leave_out_stopped(const std::function<bool(std::uint64_t process)>& runs);
  /// Sets the wall time before the steps of one tick; the first call starts the time of the system.
  void turn(TimePoint wall);
  /// Returns whether the next step may be made; makes the next grant when a clock period has ended.
  /// `has_setpoint`: its set-point has arrived; used only where takes_setpoint().
  bool may_step(bool has_setpoint);
  /// Returns whether the next step takes a set-point: the controller sends one every few steps.
  bool takes_setpoint() const { return steps_ % per_setpoint_ == 0; }
  void stepped();  ///< Advances time() by one step; to be called after each step.
  /// Returns the number of the newest grant, from 1.
  std::uint64_t grant_number() const { return grant_; }
  /// Returns the newest grant: components may advance their time to the end of the clock period
  /// after the present one. The caller fills in `incarnation`.
  TimeGrant grant() const;
  /// Returns the time of the next step.
  TimePoint time() const { return start_ + period_ * static_cast<std::int64_t>(steps_); }
  /// Returns the delay of the system's time behind the wall clock.
  Duration waited() const { return waited_; }

 private:
  struct Answer {
    std::uint64_t process{}, grant{};
  };
  bool all_answered() const;
  /// Stops waiting for the selected components until they answer again.
  void stop_waiting(const std::function<bool(const Answer&)>& selected);

  Duration period_, clock_period_, max_lag_, max_wait_;
  std::uint64_t per_setpoint_;
  bool started_{false}, setpoints_flow_{false};
  TimePoint start_{}, wall_{};
  // blocked_: delay by the present step while the simulator itself has a processor.
  Duration waited_{}, blocked_{}, checked_{};
  std::uint64_t steps_{0}, grant_{0};
  std::map<std::string, Answer> answers_;
};

}  // namespace handsel::sim
