// What the hand does: move, grasp until contact holds, release, release as a person takes the load (ours). Pure; no heap in step().
#pragma once

#include <cstdint>
#include <vector>

#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "components/trajectory_controller/arm/axis_mover.hpp"
#include "components/trajectory_controller/hand/release_watch.hpp"

namespace handsel::trajectory_controller {

/// Angles, speeds and efforts are those of turning axes; of a sliding one they count at the lever of a finger.
struct HandSettings {
  double grasp_speed{0.5};     ///< share of the comfort velocity while closing onto an object
  double closing_least{0.05};  ///< an axis closes when its way is at least this [rad]
  double touch_effort{0.08};   ///< an axis that gives this much to the world touches it [Nm]
  double touch_time{0.02};     ///< for this long, while it closes [s]
  double seek_speed{0.2};      ///< of the search for contact beyond the commanded position, axis with the largest effort [rad/s]
  double seek_travel{0.25};    ///< how far it goes [rad]
  double squeeze_effort{0.5};  ///< of a command that names none, axis with the longest way [Nm]
  double squeeze_time{0.4};    ///< of the squeeze's growth, and of its decay when the hand opens [s]
  double settle_time{0.15};    ///< at rest for this long before the outcome is told [s]
  double least_push{0.7};      ///< what a person holds too is grasped when axes with more than that push with this share of their effort
  int least_contacts{2};       ///< axes in contact that make a grasp; all of a hand that has fewer
  double lost_payload{0.02};   ///< payload once felt, now below this: lost [kg]
  double lost_time{0.3};       ///< for this long [s]
  double person_range{0.6};    ///< a pull counts only with a person's hand this near the tool frame: a mug between, 0.25 m of error [m]
  double loosen_share{0.8};    ///< of the squeeze's efforts that is left then: it must still bear the load
  double yield_effort{0.15};   ///< an axis of the hand that has released gives way to what presses it more than this [Nm] ...
  double yield_speed{1.0};     ///< ... this fast [rad/s]; 0: never
  double lever{0.05};          ///< [m]
  PullSettings pull;
};

/// What it needs to know of the moment.
struct HandInputs {
  const RobotState* robot{};        ///< latest, never null
  bool new_state{};                 ///< robot has come since the last step
  double payload{};                 ///< that this hand feels [kg]
  Vector3 force{Vector3::Zero()};   ///< on the hand, world axes [N]
  Vector3 toward{Vector3::Zero()};  ///< unit vector from the hand to the exchanging person, zero if unknown
  double person_distance{};         ///< from the hand to the nearest hand of a person [m]; +inf if nobody
  bool may_move{};                  ///< mode below Hold
  bool stop{};                      ///< mode Stop or Fault: use the stop limits
  bool clamped{};                   ///< somebody it exchanges with is: it opens, whatever the mode
};

class HandExecutor {
 public:
  /// `axes`: robot axes of the hand; `lower`, `upper` their bounds; `sliding`: which of them are prismatic (none when empty). Limits of all
  /// robot axes.
  HandExecutor(const HandSettings& settings, std::vector<int> axes, std::vector<double> lower, std::vector<double> upper,
               const KinematicLimits& comfort, const KinematicLimits& stop, std::vector<char> sliding = {});

  int size() const { return static_cast<int>(axes_.size()); }
  /// Begins at rest at these positions, pressing with these efforts (all axes of the robot; or empty).
  void reset(const Vector& robot_position, const Vector& robot_effort = {}) noexcept;
  /// Empty when accepted, else why not, one sentence.
  std::string accept(const HandCommand& command);
  /// Writes the hand axes of the set-point, one period later.
  void step(const HandInputs& in, double dt, TimePoint now, MotionState3& out) noexcept;

  /// Motions use at most this fraction in (0, 1] of the comfort velocity; one that is under way adapts, but
  /// a grasp gets no faster while it closes. Stops, and closing again on a load
  /// that comes back, are not limited.
  void limit_speed(double fraction) noexcept;

  /// Only moves on along what is under way.
  void advance(double dt, MotionState3& out) noexcept;

  /// What hand axis `i` gives besides following its set-point [Nm].
  double effort(int i) const { return level_ * fingers_[static_cast<std::size_t>(i)].effort; }
  const std::vector<int>& axes() const { return axes_; }
  HandState state() const { return state_; }
  double pull() const { return release_.armed() ? release_.pull() : 0.0; }
  std::uint64_t regrips() const { return release_.regrips(); }  ///< times the load came back and the hand closed again
  bool at_rest() const;
  /// The set-points before the last step were `from`: every axis stops from there as fast as it can.
  void stop_from(const MotionState3& from) noexcept;
  /// Moves the set-points to the measured positions where they are farther off than `dead_band` [rad].
  void follow(const Vector& robot_position, double dead_band) noexcept;

 private:
  enum class Phase { hold, moving, closing, seeking, squeezing, loosened, releasing, regripping };
  struct Finger {  // one axis of the hand
    AxisMover mover;
    double target{};       // wanted now
    double final{};        // of the command, clamped to the bounds
    double direction{};    // of closing: -1, 0, +1
    double effort{};       // of the squeeze [Nm]
    double held{};         // set-point that holds the object
    double opened{};       // set-point where the last closing began
    double grip{};         // direction it presses in while the object is held
    double share{1.0};     // of the longest way of all axes: speed goes with it, so that a finger keeps its way, (0, 1]
    double pressed_for{};  // [s]
    bool contact{};
    double lever{1.0};  // what an angle of the settings is multiplied with, an effort divided by
  };
  AxisLimits limits(std::size_t i, const KinematicLimits& of, double share) const;
  void start(Phase phase);
  void free_person() noexcept;
  void retarget(std::size_t i, double target) noexcept;
  double pressed(const RobotState& robot, std::size_t i) const noexcept;
  void watch_contacts(const RobotState& robot, double dt) noexcept;
  void seek(const RobotState& robot, double dt) noexcept;
  void squeeze(const RobotState& robot, double dt) noexcept;
  void keep_grip() noexcept;
  void change_level(double dt) noexcept;
  void give_way(const RobotState& robot, double dt) noexcept;
  void judge(const RobotState& robot, double payload, double dt) noexcept;
  int pressing(const RobotState& robot) const noexcept;
  bool pushes(const RobotState& robot) const noexcept;
  void watch_release(const HandInputs& in, TimePoint now) noexcept;

  HandSettings settings_;
  std::vector<int> axes_;
  std::vector<double> lower_, upper_;
  KinematicLimits comfort_, stop_;
  std::vector<Finger> fingers_;
  Phase phase_{Phase::hold};
  HandState state_{HandState::idle};
  bool paused_{}, payload_felt_{}, person_near_{};
  bool closed_{};            // since it was reset or opened last
  bool freeing_{};           // it opens for a person who is clamped
  double speed_limit_{1.0};  // fraction of the comfort velocity
  double settled_for_{}, lost_for_{};
  double level_{}, most_effort_{};  // share of the squeeze in force; its largest effort
  Vector release_to_;
  ReleaseWatch release_;
};

}  // namespace handsel::trajectory_controller
