// Executes jerk-limited trajectories, hand commands and gaze; slows, holds and stops by the guard.
// Every set-point obeys the guard limits. Chapter section 2 (react at the right level),
// architecture section 6. Pure: no clock, no I/O; step() uses no heap and never throws.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/task.hpp"
#include "common/model/manipulator.hpp"
#include "components/trajectory_controller/arm/axis_mover.hpp"
#include "components/trajectory_controller/arm/path_runner.hpp"
#include "components/trajectory_controller/hand/hand_executor.hpp"
#include "components/trajectory_controller/head/gaze.hpp"
#include "components/trajectory_controller/input/contact_watch.hpp"
#include "components/trajectory_controller/input/robot_reference.hpp"
#include "components/trajectory_controller/output/setpoint_check.hpp"
#include "components/trajectory_controller/supervise/finger_limit.hpp"
#include "components/trajectory_controller/supervise/go_gate.hpp"
#include "components/trajectory_controller/supervise/guard.hpp"
#include "components/trajectory_controller/supervise/mode_machine.hpp"
#include "components/trajectory_controller/supervise/reach_limit.hpp"
#include "components/trajectory_controller/supervise/stop/stop_proof.hpp"
#include "components/trajectory_controller/supervise/stop/stop_space.hpp"

namespace handsel::trajectory_controller {

/// Settings of the controller and of its parts.
struct ControllerSettings {
  double period{0.001};               ///< control period [s]
  double attention_lost_factor{0.2};  ///< speed factor while attention is silent
  double recoil_limit{0.2};           ///< largest speed factor back along the path, [0, 1]
  double max_command_age{0.5};        ///< older commands are refused [s]
  /// A trajectory may start this far from the set-point; a short motion bridges the distance [rad].
  double start_tolerance{0.05};
  /// In motion, a trajectory is joined at most this far from the switch point [rad].
  double switch_reach{0.3};
  double yield_speed{0.2};  ///< largest speed of complying with a push at rest [rad/s]
  double yield_reach{0.3};  ///< largest travel of each axis while complying [rad]
  /// Largest travel of each axis in a retreat from a person at rest, when attention asks for
  /// recoil; 0: never [rad].
  double retreat_reach{0.15};
  bool dry_run{};  ///< no set-point is sent; everything else runs
  /// A robot side that stands moves its fingers to set-points this near [rad; of a sliding one at
  /// its lever].
  double hand_rejoin{0.25};
  double tracking_tolerance{0.3};  ///< Fault: the arm is farther from its set-point [rad]
  double tracking_time{0.1};       ///< for this long [s]
  double forecast_hold{0.6};       ///< collision forecast within this time: Hold [s]
  double forecast_slow{2.0};       ///< within this time: slower in proportion [s]
  double cost_from{0.5};           ///< human-aware cost ahead from which the arm is slower, [0, 1)
  double cost_factor{0.4};         ///< speed factor at a cost of 1, (0, 1]
  double head_dead_band{0.03};     ///< the head turns only for more than this [rad]
  double look_ahead{0.15};         ///< the guard also checks the path this much later [s]
  double look_far_ahead{0.45};     ///< and this much later: about the time of a stop [s]
  int late_limit{5};               ///< late cycles in a row: Hold
  std::vector<Wall> walls;         ///< never passed: virtual walls and the sides of the workspace
  TimeoutSettings timeouts;        ///< of the inputs
  GuardSettings guard;             ///< speed and separation
  StopProofSettings proof;         ///< proof of a harmless stop
  ViewSettings view;               ///< observation of the space of a stop
  HandSettings hand;               ///< of every hand
  ContactSettings contact;         ///< detection of contact of the arm
};

/// The part of the status that must be reported at once when it changes.
struct StatusKey {
  Mode mode{};                                          ///< of the mode machine
  std::uint64_t epoch{}, trajectory{}, hand_command{};  ///< of the Go; ids of the last commands
  MotionState motion{};                                 ///< of the last trajectory command
  std::uint64_t hands{};                                ///< HandState of each hand, a byte each
  bool operator==(const StatusKey&) const = default;
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

  const MotionState3& set_point() const { return set_point_; }  ///< all axes
  /// Efforts of the motors of all axes beside those of following the set-point [Nm].
  const Vector& effort() const { return effort_; }
  /// Mass of what the first hand holds; 0: nothing or unknown [kg].
  double payload() const { return hands_.empty() ? 0.0 : hands_.front().payload; }
  /// Mass of what each other hand holds, in the order of hands_of() [kg].
  const Vector& other_payloads() const { return other_payloads_; }
  /// Mode after the last step.
  Mode mode() const { return verdict_.mode; }
  /// Result of the guard: distances now, and the strictest limits of now and of the times ahead.
  const GuardVerdict& guard_verdict() const { return guard_verdict_; }
  /// Number of set-points that had no checked stop behind them, and were replaced by the next one
  /// of the checked stop.
  std::uint64_t unproven_set_points() const { return unproven_; }
  /// Speed factor on the path, in [-1, 1]; 0 when no path runs.
  double speed_factor() const { return arm_ == Arm::running ? runner_.factor() : 0.0; }
  /// Returns the key of the current status.
  StatusKey status_key() const;
  ExecutionStatus status() const;   ///< stamp left to the publisher
  ActiveTrajectory active() const;  ///< stamp left to the publisher

 private:
  static constexpr int kYieldEvery = 10;  // cycles between choices of how to comply
  enum class Part : char { arm, hand, head };
  enum class Arm { standing, running, stopping };
  struct Seen {
    TimePoint at{};
    bool ever{};
    void mark(TimePoint t) {
      at = ever ? std::max(at, t) : t;
      ever = true;
    }
    double age(TimePoint now) const { return ever ? std::max(0.0, to_seconds(now - at)) : -1.0; }
  };
  /// The path of the arm is one motion made of the commands accepted: where each begins on it.
  struct Piece {
    std::uint64_t id{};
    double begin{}, offset{};  // where the path turns to it; where its own time is 0 [s]
    Attachment attachment;
    std::vector<std::string> allowed_contacts;
  };
  struct PersonPoints {
    std::string id;
    Vector3 torso, left_hand, right_hand;  // world
  };

  struct Hand {
    std::string group;  // of its axes
    int palm{-1};       // link
    HandExecutor executor;
    bool refused{};  // the last command to it
    double grasped_payload{}, payload{};
  };

  std::string why_not(const TrajectoryCommand& command, Duration age) const;
  std::string why_not_now(const std::string& robot, std::uint64_t epoch, Duration age) const;
  std::string why_not_from_rest(const TrajectoryCommand& command) const;
  std::string start(const TrajectoryCommand& command, TimePoint now);
  std::string go_over(const TrajectoryCommand& command);
  std::string refuse(const TrajectoryCommand& command, const std::string& reason);
  void take(const TrajectoryCommand& command, double begin, double offset);
  const Piece& piece() const noexcept { return pieces_[current_]; }
  void find_piece() noexcept;
  MotionState told_motion() const noexcept;
  std::string why_no_go() const;
  KinematicLimits of_axes(const KinematicLimits& limits, const std::vector<std::uint32_t>& axes) const;
  PathLimits path_limits(const std::vector<std::uint32_t>& axes) const;
  double inside(int axis, double position) const noexcept;
  void stop_arm() noexcept;
  bool too_fast() const noexcept;
  bool must_leave_path(TimePoint now) const noexcept;
  double fastest_stop() const noexcept;
  double fastest_stop(int axis, double velocity, double acceleration) const noexcept;
  double fastest_stop_after_a_cycle() const noexcept;
  double onward_ease() const noexcept;
  void give_up_path() noexcept;
  void go_back_to_path() noexcept;
  void stand_arm() noexcept;
  void run_guard(TimePoint now) noexcept;
  void judge_path(double ahead, GuardVerdict& verdict, TimePoint now) noexcept;
  void judge_new_path(TimePoint now) noexcept;
  void merge_verdicts() noexcept;
  double wanted_factor(TimePoint now) const noexcept;
  double cost_share() const noexcept;
  ModeInputs mode_inputs(TimePoint now, bool late) noexcept;
  void step_arm(TimePoint now) noexcept;
  void step_hands(TimePoint now) noexcept;
  void step_hand(Hand& hand, TimePoint now) noexcept;
  void limit_fingers(TimePoint now) noexcept;
  double felt_payload(std::size_t hand) const noexcept;
  static double held_payload(const ServoReference& reference, std::size_t hand) noexcept;
  const Wrench* felt_wrench(std::size_t hand) const noexcept;
  HandState told_hand(const Hand& hand) const noexcept { return hand.refused ? HandState::refused : hand.executor.state(); }
  Hand* find_hand(const std::string& group);
  void step_head() noexcept;
  void step_yield(TimePoint now) noexcept;
  void aim_away() noexcept;
  Vector where_path_ends();
  bool attention_silent(TimePoint now) const noexcept;
  /// Whether the robot side follows set-points: it may stand although its drives are enabled.
  bool follows() const noexcept { return state_.mode == DriveMode::enabled && state_.refusal.empty(); }
  /// Returns whether set-points and robot may be at different places: under a fault, or stopped.
  bool apart() const noexcept { return verdict_.mode == Mode::fault || !follows(); }
  /// Returns whether the robot side rests elsewhere, so that set-points do not move the robot.
  bool moves_nothing() const noexcept;
  void check_last() noexcept;
  void prove_stop(TimePoint now) noexcept;
  void keep_observed(TimePoint now) noexcept;
  std::string why_blind() const;
  void follow_checked_stop(bool arm, bool hand, bool head) noexcept;
  double held_payload() const noexcept;
  AxisState sent(int axis) const noexcept;
  bool at_rest() const noexcept { return set_point_.velocity.isZero(0.0) && set_point_.acceleration.isZero(0.0); }
  void write(int axis, const AxisState& s) noexcept;
  void resync(TimePoint now) noexcept;
  void refresh_capsules();
  Exception exception() const;

  ControllerSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  std::vector<LinkCapsule> capsules_;
  HeadRoom head_room_;
  std::vector<int> arm_axes_, head_axes_;
  std::vector<Part> part_;  // of each axis

  // Latest samples.
  RobotState state_;
  HumanState people_;
  Go go_;
  GoGate gate_;
  std::string safety_reason_;  // why the safety state does not permit motion
  TrajectoryForecast forecast_;
  AttentionAdvice advice_;
  ActionStatus action_;
  Seen robot_seen_, human_seen_, go_seen_, forecast_seen_, advice_seen_;
  bool new_state_{};
  PersonCapsules person_capsules_;
  std::vector<PersonPoints> points_;
  std::string exchanging_;  // person exempt from separation (forearms, hands), until clear
  Vector3 gaze_aimed_{Vector3::Constant(1e9)};

  // What is sent.
  // Measured configuration that set-points were taken to since the robot side last followed;
  // the measured one at the last evaluation of the reference. All axes [rad, m].
  Vector adopted_, measured_before_;
  bool has_adopted_{};
  bool ready_{}, asleep_{};
  TimePoint last_step_{TimePoint::max()};
  MotionState3 set_point_, next_;
  Vector effort_;
  LimitShares shares_;

  // Arm.
  Arm arm_{Arm::standing};
  PathRunner runner_;
  std::vector<std::uint32_t> axes_;  // of the path
  std::vector<Piece> pieces_{Piece{}};
  std::size_t current_{};
  bool cancelled_{};
  bool rejoin_{};  // the arm left the path to stop in time, and goes back to it
  TimePoint rest_due_{};
  TimePoint started_{};
  std::vector<AxisMover> movers_;  // one a robot axis; those of the hand unused
  std::uint64_t accepted_trajectory_{}, refused_trajectory_{};
  MotionState motion_{MotionState::idle};  // of what was accepted last
  bool refused_{};                         // is reported instead
  int refused_for_{};                      // cycles still; 0: until something is accepted

  // Hands and head.
  std::vector<Hand> hands_;
  Vector other_payloads_;
  std::uint64_t last_hand_{}, accepted_hand_{};
  std::vector<double> head_target_;
  bool head_wanted_{}, head_paused_{};

  // Supervision.
  ContactWatch contact_;
  Contact touch_{Contact::none};
  bool yielding_{}, yield_waits_{}, retreating_{};
  std::uint32_t rest_demands_{};  // of the last cycle, to be answered by rest before complying
  double retreat_share_{};        // of its speed that the guard allows
  Vector yield_from_, away_;      // away_: motion away from the nearest person, largest 1
  RobotReference reference_;
  ModeMachine modes_;
  ModeVerdict verdict_;
  GuardVerdict guard_verdict_, verdict_now_, verdict_near_, verdict_far_, nearest_;
  int turn_{};  // of checking these
  MotionState3 path_;
  Vector full_velocity_, full_acceleration_, posture_;
  std::vector<Pose> links_;
  std::vector<LinkTwist> twists_;

  StopProof proof_;
  ReachLimit reach_limit_;
  FingerLimit finger_limit_;
  // Of the fingers until a stop begins, all axes, >= 0; 0 of those that are no fingers [rad/s,
  // m/s].
  Vector finger_speeds_;
  StopSpace stop_space_;
  // No live source observes where the arm can be within the stop of the last set-point.
  bool blind_{};
  std::uint64_t unproven_{};  // set-points replaced by those of a checked stop so far
  int unproven_shown_{};      // cycles for which the cause is still shown
  int rejoins_in_vain_{};     // how often, lately, the path was left again for want of a proof
  double too_near_for_{}, tracking_for_{};
  int off_axis_{-1};  // of the last tracking error: the axis farthest from its set-point
  double off_by_{};   // by how much [rad, m]
  bool limit_violation_{}, new_people_{};
  int late_in_a_row_{};
  std::uint64_t cycles_{}, late_cycles_{};
  std::string refusal_;
  Cause latched_cause_{Cause::none};
};

}  // namespace handsel::trajectory_controller
