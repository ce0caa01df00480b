// SPDX-License-Identifier: Apache-2.0
// The mode of the controller in each cycle, and its cause: what the parts report, as inputs of the
// mode machine. Pure, no heap in update().
#pragma once

#include <vector>

#include "components/trajectory_controller/input/contact_watch.hpp"
#include "components/trajectory_controller/input/inputs.hpp"
#include "components/trajectory_controller/output/set_points.hpp"
#include "components/trajectory_controller/supervise/guard.hpp"
#include "components/trajectory_controller/supervise/mode_machine.hpp"
#include "components/trajectory_controller/supervise/tracking_monitor.hpp"

namespace handsel::trajectory_controller {

/// Thresholds of the causes.
struct SupervisorSettings {
  double period{0.001};            ///< of control [s]
  bool dry_run{};                  ///< the robot does not follow set-points
  double tracking_tolerance{0.3};  ///< Fault: the arm is farther from its set-point [rad]
  double tracking_time{0.1};       ///< for this long [s]
  double forecast_hold{0.6};       ///< collision forecast within this time: Hold [s]
  double forecast_slow{2.0};       ///< within this time: Slow [s]
  double stop_persistence{0.15};   ///< too near and still closing in for this long: Stop [s]
  int late_limit{5};               ///< late cycles in a row: Hold
  TimeoutSettings timeouts;        ///< of the inputs
};

/// What the parts report in one cycle.
struct SupervisorInputs {
  const Inputs& inputs;              ///< newest samples
  const SetPoints& set_points;       ///< of the last cycle
  const std::vector<int>& arm_axes;  ///< axes whose tracking is checked
  const GuardVerdict& guard;         ///< of this cycle
  bool running{};                    ///< a trajectory is not finished
  std::uint64_t trajectory{};        ///< its id
  double cost_factor{1.0};           ///< speed factor for the cost ahead
  Contact contact{Contact::none};    ///< of the arm
  bool complying{};                  ///< the arm gives in to contact, or retreats
  bool limit_violation{};            ///< a set-point broke a limit
  bool stop_unproven{};              ///< lately a set-point had no checked stop
  bool blind{};                      ///< the space of a stop is not observed
  bool late{};                       ///< the cycle began late
};

class Supervisor {
 public:
  explicit Supervisor(const SupervisorSettings& settings);

  /// Advances by one cycle.
  void update(const SupervisorInputs& in, TimePoint now) noexcept;
  /// Notes that a motion began from rest: no person has been too near yet.
  void begin_motion(TimePoint now) noexcept {
    started_ = now;
    too_near_for_ = 0.0;
  }

  /// Mode and causes of the last cycle.
  const ModeVerdict& verdict() const noexcept { return verdict_; }
  /// Mode of the last cycle.
  Mode mode() const noexcept { return verdict_.mode; }
  /// Returns whether a cause held in the last cycle.
  bool has(Cause cause) const noexcept { return (verdict_.causes & bit(cause)) != 0; }
  /// Most severe cause of Hold, Stop or Fault, kept until motion is possible; none below Hold.
  Cause latched_cause() const noexcept { return latched_cause_; }
  /// Number of cycles that began late.
  std::uint64_t late_cycles() const noexcept { return late_cycles_; }
  /// Last tracking error.
  const TrackingMonitor& tracking() const noexcept { return tracking_; }

 private:
  ModeInputs mode_inputs(const SupervisorInputs& in, TimePoint now) noexcept;
  void add_forecast(const SupervisorInputs& in, ModeInputs& out) const noexcept;

  SupervisorSettings settings_;
  ModeMachine modes_;
  TrackingMonitor tracking_;
  ModeVerdict verdict_;
  Cause latched_cause_{Cause::none};
  TimePoint started_{};    // of the last motion from rest
  double too_near_for_{};  // [s]
  int late_in_a_row_{};
  std::uint64_t late_cycles_{};
};

}  // namespace handsel::trajectory_controller
