// SPDX-License-Identifier: Apache-2.0
// Executes jerk-limited trajectories, hand commands and gaze; slows, holds and stops by the guard.
// The order of a step: inputs (robot side, people, permission, forecast, advice) -> supervise
// (lookahead, mode, deadline of a stop) -> arm (reference, compliance, path) | hand | head ->
// output (limits, checked stop, observed space). Every set-point obeys the guard limits. Chapter
// section 2 (react at the right level), architecture section 6. Pure: no clock, no I/O; step() uses
// no heap and never throws.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/task.hpp"
#include "components/trajectory_controller/arm/arm_motion.hpp"
#include "components/trajectory_controller/arm/command_check.hpp"
#include "components/trajectory_controller/arm/compliance.hpp"
#include "components/trajectory_controller/arm/reference_follower.hpp"
#include "components/trajectory_controller/axis_groups.hpp"
#include "components/trajectory_controller/hand/hands.hpp"
#include "components/trajectory_controller/head/head_controller.hpp"
#include "components/trajectory_controller/input/contact_watch.hpp"
#include "components/trajectory_controller/input/inputs.hpp"
#include "components/trajectory_controller/output/command_report.hpp"
#include "components/trajectory_controller/output/output_check.hpp"
#include "components/trajectory_controller/output/set_points.hpp"
#include "components/trajectory_controller/output/status_report.hpp"
#include "components/trajectory_controller/supervise/finger_limit.hpp"
#include "components/trajectory_controller/supervise/lookahead.hpp"
#include "components/trajectory_controller/supervise/speed_limit.hpp"
#include "components/trajectory_controller/supervise/stop/stop_proof.hpp"
#include "components/trajectory_controller/supervise/stop/stop_space.hpp"
#include "components/trajectory_controller/supervise/stop_deadline.hpp"
#include "components/trajectory_controller/supervise/supervisor.hpp"

namespace handsel::trajectory_controller {

/// Settings of the controller and of its parts.
struct ControllerSettings {
  double period{0.001};               ///< control period [s]
  double attention_lost_factor{0.2};  ///< speed factor while attention is silent
  double recoil_limit{1.0};           ///< largest speed factor back along the path, [0, 1]
  double max_command_age{0.5};        ///< older commands are refused [s]
  double refusal_time{0.2};           ///< a refusal is shown this long while another path runs [s]
  /// A trajectory may start this far from the set-point; a short motion bridges the distance [rad].
  double start_tolerance{0.05};
  /// In motion, a trajectory is joined at most this far from the switch point [rad].
  double switch_reach{0.3};
  double join_time{0.5};    ///< in motion, one that begins as the arm moves: joined within this [s]
  double rejoin_time{0.4};  ///< a path is rejoined within this after a stop beside it [s]
  int rejoin_tries{10};     ///< max switch points that are tried then, in one cycle
  double alike_distance{0.02};  ///< of a trajectory that begins as the arm moves [rad]
  double alike_ratio{0.1};      ///< max fraction of the limits by which its motion then differs
  double yield_speed{0.2};      ///< largest speed of complying with a push at rest [rad/s]
  double yield_reach{0.3};      ///< largest travel of each axis while complying [rad]
  double yield_lead{0.5};       ///< of motion that the target of an axis lies ahead then [s]
  /// Largest speed of each axis in a retreat from a person at rest, when attention asks for recoil
  /// [rad/s].
  double retreat_speed{1.0};
  double retreat_reach{0.3};               ///< largest travel of each axis then; 0: never [rad]
  double retreat_range{1.2};               ///< links farther from the person do not count then [m]
  double retreat_damping{0.02};            ///< of the axes in the direction of a retreat [m^2]
  double retreat_min_factor{0.1};          ///< speed factor that the guard must allow for a retreat
  std::uint32_t retreat_aim_cycles{10};    ///< between two choices of its direction
  std::uint32_t retreat_check_cycles{10};  ///< between two evaluations of what is allowed then
  bool dry_run{};                          ///< no set-point is sent; everything else runs
  /// A robot side that stands moves its fingers to set-points this near [rad; of a sliding one at
  /// its lever].
  double hand_rejoin{0.25};
  ReferenceSettings reference;     ///< how the reference of the robot side is compared
  BoundNoise bound_noise;          ///< how far outside its bounds an axis may be measured
  double tracking_tolerance{0.3};  ///< Fault: the arm is farther from its set-point [rad]
  double tracking_time{0.1};       ///< for this long [s]
  double forecast_hold{0.6};       ///< collision forecast within this time: Hold [s]
  double forecast_slow{2.0};       ///< within this time: slower in proportion [s]
  /// A stop along the path may take this much longer than the fastest one; then it is ended beside
  /// the path [s].
  double stop_slack{0.05};
  double slow_slack{0.02};       ///< the same where the guard asks for less speed [s]
  double cost_from{0.5};         ///< human-aware cost ahead from which the arm is slower, [0, 1)
  double cost_factor{0.4};       ///< speed factor at a cost of 1, (0, 1]
  double too_fast_ratio{1.1};    ///< of an arm that is too fast to what is allowed
  double too_fast_margin{0.02};  ///< and the speed factor above that
  double head_dead_band{0.03};   ///< the head turns only for more than this [rad]
  double head_min_target_motion{0.02};    ///< min motion of the gaze target for another aim [m]
  double head_clearance{0.02};            ///< distance from other links that the head keeps [m]
  double look_ahead{0.15};                ///< the guard also checks the path this much later [s]
  double look_far_ahead{0.45};            ///< and this much later: about the time of a stop [s]
  double ahead_min_factor{0.6};           ///< min speed factor assumed until then
  double back_min_factor{0.02};           ///< min one backward at which the path behind is checked
  std::uint32_t rest_check_cycles{50};    ///< between two checks of the guard at rest
  std::uint32_t blind_check_cycles{10};   ///< between two checks at rest that the arm is observed
  std::uint32_t finger_check_cycles{10};  ///< between two evaluations of the speed of the fingers
  SpeedRiseSettings rise;                 ///< of the speed factor after people have slowed the arm
  int late_limit{5};                      ///< late cycles in a row: Hold
  std::vector<Wall> walls;   ///< never passed: virtual walls and the sides of the workspace
  TimeoutSettings timeouts;  ///< of the inputs
  GuardSettings guard;       ///< speed and separation
  StopProofSettings proof;   ///< proof of a harmless stop
  ViewSettings view;         ///< observation of the space of a stop
  HandSettings hand;         ///< of every hand
  ContactSettings contact;   ///< detection of contact of the arm
};

class Controller {
 public:
  /// Throws ConfigError naming the field. Robot groups "hand" and "head" may be missing; all other
  /// axes are moved by trajectories.
  Controller(const ControllerSettings& settings, std::shared_ptr<const RobotModel> robot);

  /// Empty when accepted, else why not, one sentence; then the running motion continues. While the
  /// arm moves, the switch point is now or, with switch_at, that time of the command accepted
  /// before; commands wait in line. A command without axes stops the running trajectory
  /// jerk-limited, and ends those that wait. `age`: of the command at arrival.
  std::string accept(const TrajectoryCommand& command, Duration age, TimePoint now);
  /// Empty when accepted or accepted before, else why not, one sentence. `age`: of the command at
  /// arrival.
  std::string accept(const HandCommand& command, Duration age, TimePoint now);

  // Samples: `sampled` is the arrival minus the age at arrival.
  /// `age`: of the sample when it arrived. `new_writer`: another process writes it than the one
  /// before; set-points begin at the configuration reported by that process. Samples of another
  /// robot or with invalid positions are ignored.
  void on(const RobotState& state, TimePoint sampled, Duration age = {}, bool new_writer = false);
  /// Replaces people and views.
  void on(const HumanState& people, TimePoint sampled);
  /// Takes a Go if GoGate lets it pass; an older epoch does not count as a sign of life.
  void on(const Go& go, TimePoint sampled);
  /// Notes whether motion waits for a person, and why.
  void on(const SafetyState& safety);
  /// Replaces the forecast, which counts only for the trajectory that runs.
  void on(const TrajectoryForecast& forecast, TimePoint sampled);
  /// Replaces the advice; a new gaze target turns the head where that is free of collisions.
  void on(const AttentionAdvice& advice, TimePoint sampled);
  /// Replaces the status of the action; an engaged handover exempts its partner from separation.
  void on(const ActionStatus& action, TimePoint sampled);

  /// Advances by one period, whatever time has passed. `late`: the cycle began more than a period
  /// after it was due. Returns false until the robot's configuration is known: nothing may be sent.
  /// So it is after a sleep of a tenth of a second: the robot side has stopped by itself in the
  /// meantime, and what was sent last counts no longer.
  bool step(TimePoint now, bool late) noexcept;

  /// Set-point sent last, all axes.
  const MotionState3& set_point() const { return set_points_.sent(); }
  /// The hands, with the efforts of the motors and the masses held.
  const Hands& hands() const { return hands_; }
  /// Mode after the last step.
  Mode mode() const { return supervisor_.mode(); }
  /// Number of set-points that had no checked stop behind them, and were replaced by the next one
  /// of the checked stop.
  std::uint64_t unproven_set_points() const { return output_check_.unproven(); }
  /// Speed factor on the path, in [-1, 1]; 0 when no path runs.
  double speed_factor() const { return arm_.speed_factor(); }
  /// Returns the key of the current status.
  StatusKey status_key() const { return trajectory_controller::status_key(sources()); }
  /// Returns the status; stamp left to the publisher.
  ExecutionStatus status() const { return make_status(sources()); }
  /// Returns the motion that is executed; stamp left to the publisher.
  ActiveTrajectory active() const { return make_active(sources()); }

 private:
  CommandConditions conditions() const;
  LookaheadInputs lookahead_inputs(TimePoint now) noexcept;
  double wanted_factor(TimePoint now) const noexcept;
  void supervise(TimePoint now, bool late) noexcept;
  void step_arm(TimePoint now) noexcept;
  StatusSources sources() const;

  ControllerSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  AxisGroups groups_;
  Inputs inputs_;
  ContactWatch contact_;
  SetPoints set_points_;
  StopProof proof_;
  StopSpace stop_space_;
  FingerLimit finger_limit_;
  ArmMotion arm_;
  Compliance compliance_;
  ReferenceFollower follower_;
  Hands hands_;
  HeadController head_;
  Lookahead lookahead_;
  StopDeadline deadline_;
  Supervisor supervisor_;
  OutputCheck output_check_;
  CommandReport commands_;
  std::uint64_t cycles_{};
};

}  // namespace handsel::trajectory_controller
