// SPDX-License-Identifier: Apache-2.0
// What the hand does: move, grasp until contact holds, release, release as a person takes the load.
// Own method. Pure; no heap in step().
#pragma once

#include <cstdint>
#include <vector>

#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "components/trajectory_controller/hand/fingers.hpp"
#include "components/trajectory_controller/hand/release_watch.hpp"

namespace handsel::trajectory_controller {

/// Angles, speeds and efforts are those of turning axes; of a sliding one they count at the lever
/// of a finger.
struct HandSettings {
  double grasp_speed{0.5};      ///< fraction of the comfort velocity while closing
  double min_closing{0.05};     ///< smallest travel of an axis that closes [rad]
  double touch_effort{0.08};    ///< effort on the world from which an axis is in contact [Nm]
  double touch_time{0.02};      ///< for this long, while it closes [s]
  double seek_speed{0.2};       ///< of the search for contact beyond the command [rad/s]
  double seek_travel{0.25};     ///< largest travel of that search [rad]
  double seek_min_effort{0.2};  ///< fraction of the max effort; axes with less only hold
  /// Fraction of the grip force on axes in contact from which on the force grows although others
  /// still search.
  double grip_fraction{0.8};
  double grip_effort{0.5};     ///< grip force of a command without one, longest axis [Nm]
  double grip_rise_time{0.4};  ///< rise of the grip force, and decay when the hand opens [s]
  double settle_time{0.15};    ///< at rest for this long before the outcome is reported [s]
  /// An object that a person holds too is grasped when every axis with more than grip_effort
  /// pushes with at least this fraction of its effort.
  double min_push{0.7};
  int min_contacts{2};          ///< axes in contact that make a grasp; all if there are fewer
  double lost_payload{0.02};    ///< payload once felt, now below this: lost [kg]
  double lost_time{0.3};        ///< for this long [s]
  double person_range{0.6};     ///< a pull counts only with a person's hand this near [m]
  double loosen_fraction{0.8};  ///< fraction of the grip force left while loosened
  double yield_effort{0.15};    ///< after a release, an axis complies with more than this [Nm]
  double yield_speed{1.0};      ///< speed of complying [rad/s]; 0: never
  double lever{0.05};           ///< finger length that stands for a sliding axis [m]
  PullSettings pull;            ///< detection of the pull at a handover
};

/// Inputs of one step.
struct HandInputs {
  const RobotState* robot{};        ///< latest, never null
  bool new_state{};                 ///< robot has come since the last step
  double payload{};                 ///< that this hand feels [kg]
  Vector3 force{Vector3::Zero()};   ///< on the hand, world axes [N]
  Vector3 toward{Vector3::Zero()};  ///< unit vector to the partner of the handover, or zero
  double person_distance{};         ///< to the nearest hand of a person [m]; +inf: none
  bool may_move{};                  ///< mode below Hold
  bool stop{};                      ///< mode Stop or Fault: use the stop limits
  bool too_near{};  ///< a person approaches the hand: fingers that move or close stop
  /// An armed watch for a pull begins anew: the load's own force is measured again.
  bool restarts_watch{};
  bool clamped{};  ///< the partner of the handover is clamped: open in any mode
};

class HandExecutor {
 public:
  /// `comfort`, `stop`: limits of all axes of the robot.
  HandExecutor(const HandSettings& settings, HandAxes hand, const KinematicLimits& comfort,
               const KinematicLimits& stop);

  /// Number of axes of the hand.
  int size() const { return static_cast<int>(fingers_.size()); }
  /// Begins at rest at these positions, pressing with these efforts (all axes of the robot; or
  /// empty).
  void reset(const Vector& robot_position, const Vector& robot_effort = {}) noexcept;
  /// Returns whether the fingers rest and neither press on what is held nor execute a command.
  bool is_free() const noexcept;
  /// Empty when accepted, else why not, one sentence.
  std::string accept(const HandCommand& command);
  /// Writes the hand axes of the set-point, one period later.
  void step(const HandInputs& in, double dt, TimePoint now, MotionState3& out) noexcept;

  /// Motions use at most this fraction in (0, 1] of the comfort velocity; one that is under way
  /// adapts, but a grasp gets no faster while it closes. Stops, and closing again on a load that
  /// comes back, are not limited.
  void limit_speed(double fraction) noexcept;

  /// Only moves on along what is under way.
  void advance(double dt, MotionState3& out) noexcept;

  /// What hand axis `i` gives besides following its set-point [Nm].
  double effort(int i) const { return level_ * fingers_[static_cast<std::size_t>(i)].effort; }
  /// Robot axes of the hand, in the order of effort().
  const std::vector<int>& axes() const { return fingers_.axes(); }
  /// State for the status: idle, moving, or the outcome of the last command.
  HandState state() const { return state_; }
  /// Force on the hand beyond the load's own [N]; 0 unless a release by pull is armed.
  double pull() const { return release_.armed() ? release_.pull() : 0.0; }
  /// Number of times the load came back and the hand closed again.
  std::uint64_t regrips() const { return release_.regrips(); }
  /// Returns whether the set-points of all axes are at rest.
  bool at_rest() const { return fingers_.at_rest(); }
  /// The set-points before the last step were `from`: every axis stops from there as fast as it
  /// can.
  void stop_from(const MotionState3& from) noexcept;
  /// Moves the set-points to the measured positions where they are farther off than `dead_band`
  /// [rad].
  void follow(const Vector& robot_position, double dead_band) noexcept;

 private:
  enum class Phase {
    hold,
    moving,
    closing,
    seeking,
    gripping,
    loosened,
    unloading,
    releasing,
    regripping
  };

  void start(Phase phase);
  void retarget(std::size_t i, double target) noexcept;
  void watch_contacts(const RobotState& robot, double dt) noexcept;
  bool seek(const RobotState& robot, double dt) noexcept;
  void grip(const RobotState& robot, double dt) noexcept;
  void change_level(double dt) noexcept;
  void comply(const RobotState& robot, double dt) noexcept;
  void check_outcome(const RobotState& robot, double payload, double dt) noexcept;
  void watch_release(const HandInputs& in, TimePoint now) noexcept;

  HandSettings settings_;
  Fingers fingers_;
  Phase phase_{Phase::hold};
  HandState state_{HandState::idle};
  bool paused_{}, payload_felt_{}, person_near_{};
  bool closed_{};            // since it was reset or opened last
  bool unsure_{};            // the last grasp ended with fingers that do not push as planned
  bool freeing_{};           // it opens for a person who is clamped
  double speed_limit_{1.0};  // fraction of the comfort velocity
  double settled_for_{}, lost_for_{};
  double level_{}, max_effort_{};  // fraction of the grip force in effect; largest effort
  Vector release_to_;
  ReleaseWatch release_;
};

}  // namespace handsel::trajectory_controller
