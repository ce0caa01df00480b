// SPDX-License-Identifier: Apache-2.0
// What the guard, the reach of people and the observed space allow: where the arm is on its path, a
// little later and about the time of a stop later. One of the three is evaluated in each cycle.
// Pure, no heap after construction, noexcept.
#pragma once

#include <cstdint>
#include <vector>

#include "common/model/robot_capsules.hpp"
#include "components/trajectory_controller/arm/arm_motion.hpp"
#include "components/trajectory_controller/axis_groups.hpp"
#include "components/trajectory_controller/supervise/guard.hpp"
#include "components/trajectory_controller/supervise/reach_limit.hpp"
#include "components/trajectory_controller/supervise/speed_rise.hpp"
#include "components/trajectory_controller/supervise/stop/stop_space.hpp"

namespace handsel::trajectory_controller {

/// Limits of the evaluation, and how far ahead it is made.
struct LookaheadSettings {
  GuardSettings guard;               ///< speed and separation
  std::vector<Wall> walls;           ///< never passed
  double look_ahead{0.15};           ///< the path is also evaluated this much later [s]
  double look_far_ahead{0.45};       ///< and this much later: about the time of a stop [s]
  SpeedRiseSettings rise;            ///< of the speed factor
  double min_factor{0.6};            ///< min speed factor assumed until then
  double back_min_factor{0.02};      ///< min backward speed factor at which the path runs back
  std::uint32_t rest_cycles{50};     ///< between two evaluations at rest
  std::uint32_t retreat_cycles{10};  ///< between two evaluations in a retreat
  double too_fast_ratio{1.1};        ///< of an arm that is too fast to what is allowed
  double too_fast_margin{0.02};      ///< and the speed factor above that
};

/// Inputs of one evaluation.
struct LookaheadInputs {
  ArmMotion& arm;                 ///< whose path is evaluated
  const MotionState3& set_point;  ///< sent last
  const Pose& T_world_base;       ///< base of the robot in the world
  const PersonCapsules& people;   ///< newest
  bool uncovered{};               ///< people are reported, but not all of the reach is observed
  double age{};                   ///< of the human data [s]
  double ease{};                  ///< time to remove the arm's acceleration [s]
  double payload{};               ///< mass held [kg]
  bool may_run_back{};            ///< the path may run back
  const Vector* retreat{};        ///< velocity of a retreat at rest [rad/s]; nullptr: none
};

class Lookahead {
 public:
  /// Keeps references to all but the settings. `finger_delay`: from a set-point to the stop of the
  /// fingers [s].
  Lookahead(const LookaheadSettings& settings, const RobotModel& robot, const StopProof& proof,
            StopSpace& stop_space, const std::vector<int>& finger_axes);

  /// Notes that people have just been seen: the next evaluation is of where the arm is.
  void set_new_people() noexcept { new_people_ = true; }
  /// Evaluates one of the three, at rest now and then only. Returns whether the evaluation was of
  /// where the arm is, so that nearest() is new.
  bool step(const LookaheadInputs& in, std::uint64_t cycle) noexcept;
  /// Evaluates all three: of a new path before its first step. `from_rest`: no path runs.
  void evaluate_all(const LookaheadInputs& in, bool from_rest) noexcept;
  /// Nothing is allowed until the next evaluations have shown what is: all at once would make a
  /// late cycle.
  void forbid_all() noexcept;
  /// Lowers what is allowed: at the speed factor `factor` a set-point had no checked stop.
  void lower(double factor) noexcept { rise_.lower(factor); }
  /// Computes where the links are at `position`, all axes.
  void place_links(const Vector& position) noexcept { robot_.forward(position, links_); }

  /// Distances now, and the strictest limits of the three.
  const GuardVerdict& verdict() const noexcept { return verdict_; }
  /// Last verdict of where the arm is.
  const GuardVerdict& nearest() const noexcept { return nearest_; }
  /// Speed factor of a retreat that was allowed last, [0, 1].
  double retreat_factor() const noexcept { return retreat_.factor; }
  /// Returns whether the arm at a speed factor is faster than allowed here and shortly ahead, by
  /// more than time scaling lags behind a verdict that changes slowly. What is allowed farther
  /// ahead lowers the speed along the path in time.
  bool is_too_fast(double factor) const noexcept;
  /// Poses of the links evaluated last, root frame.
  const std::vector<Pose>& links() const noexcept { return links_; }

 private:
  void evaluate(double ahead, const LookaheadInputs& in, GuardVerdict& verdict) noexcept;
  void set_motion(double ahead, const LookaheadInputs& in) noexcept;
  void set_finger_speeds(const MotionState3& set_point) noexcept;
  void merge() noexcept;
  void limit_rise() noexcept;
  void keep_retreat() noexcept;

  LookaheadSettings settings_;
  const RobotModel& robot_;
  const StopProof& proof_;
  StopSpace& stop_space_;
  const std::vector<int>& finger_axes_;
  std::vector<LinkCapsule> capsules_;
  ReachLimit reach_limit_;
  GuardVerdict verdict_, now_, near_, far_, nearest_;
  SpeedRise rise_;
  SpeedLimit retreat_{.factor = 0.0};  // of a retreat, evaluated last
  int turn_{};                         // of the evaluations
  bool new_people_{};
  MotionState3 motion_;  // that is evaluated: all axes, at full speed
  // Of the fingers until a stop begins, all axes, >= 0; 0 of others [rad/s, m/s].
  Vector finger_speeds_;
  std::vector<Pose> links_;
  std::vector<LinkTwist> twists_;
};

}  // namespace handsel::trajectory_controller
