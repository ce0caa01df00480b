// SPDX-License-Identifier: Apache-2.0
// What every driver does between the wire and its maker's controller: checks the set-points,
// refuses those the arm cannot follow, converts them from the wire's clock to the maker's, makes a
// jerk-limited stop when they fail, resumes following without a jump, waits for a person after a
// stop of the maker's own, reports the robot's state. Pure: the maker's side is called by the
// driver. Own method: built on common/robot_side, as the simulator is.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "common/messages/robot.hpp"
#include "common/model/robot_model.hpp"
#include "common/robot_side/robot_side.hpp"
#include "common/trajectory/setpoint_filter.hpp"

namespace handsel::drivers {

struct DriverSettings {
  /// Everything but the output: nothing is sent to the arm; the configuration it would have is
  /// reported.
  bool dry_run{false};
  /// Fraction of the guard limits with which a jump between set-points and reference fades.
  double fade_fraction{0.1};
  Pose T_world_base{Pose::Identity()};  ///< root link of the robot in the world
  RobotSideSettings watch;              ///< limits of the check of the set-points
  double max_setpoint_age{0.1};         ///< older set-points are left out [s]
};

/// What the maker's controller measured in a cycle; all axes of the robot description.
struct Measured {
  /// [rad, rad/s, Nm, Nm] (sliding axes: m, m/s, N).
  Vector position, velocity, effort, external_torque;
  Wrench wrist_wrench;             ///< on the hand with its load, tool frame [N, Nm]
  double payload{};                ///< mass in the hand [kg]
  DriveMode mode{DriveMode::off};  ///< enabled: it would follow references
  std::string why;                 ///< one sentence, when it would not
  /// The cause of the stop needs a person's acknowledgement once the arm has been commanded.
  bool by_person{};
};

class DriverCore {
 public:
  /// `arm_axes`: robot axes that the maker's references move. The others (gripper, head) are the
  /// driver's own business: here they are reported at their commanded positions.
  DriverCore(const RobotModel& model, std::vector<int> arm_axes, const DriverSettings& settings);

  /// A set-point from the wire. False when it is not followed. `now`: monotonic [s].
  bool command(const JointCommand& command, double now);
  /// Once a maker's cycle of `dt` [s], before reference(). Any mode but enabled holds where the
  /// robot stands.
  void update(const Measured& measured, double now, double dt);
  /// Holds until set-points rest at the measured configuration again: for a maker's controller that
  /// follows no references though it reports no stop. `why`: one sentence.
  void hold(const std::string& why);
  /// Starts the references at `position` (all axes), from which the maker's controller begins to
  /// follow; their difference from the set-points fades.
  void start_from(const Vector& position) noexcept;
  /// Makes a jerk-limited protective stop of the driver's own.
  void stop(const std::string& why);
  /// Records a person's acknowledgement, after which set-points are followed again. Counts only
  /// once the cause of the stop is gone.
  void acknowledge();

  const Vector& reference() const { return reference_; }  ///< all axes, for this cycle
  /// Returns true when the maker's controller has reported and set-points are followed.
  bool following() const {
    return side_known_ && side_.mode() == DriveMode::enabled && side_.follows();
  }
  /// Returns true from a stop that needs a person until acknowledge().
  bool waits_for_person() const { return waits_for_person_; }
  /// For the wire. `commanding`: the maker's controller follows references right now.
  RobotState state(bool commanding) const;
  /// Why the robot does not follow, one sentence; empty while it does.
  std::string trouble() const;
  /// Set-points not followed though the robot could move.
  std::uint64_t refused() const { return side_.refused(); }
  const DriverSettings& settings() const { return settings_; }  ///< as given to the constructor
  /// As given to the constructor; must outlive this object.
  const RobotModel& model() const { return model_; }
  /// Robot axes in the order of the arm's controller.
  const std::vector<int>& arm_axes() const { return arm_axes_; }

 private:
  void settle() noexcept;
  void follow_set_points(double dt) noexcept;

  const RobotModel& model_;
  std::vector<int> arm_axes_;
  DriverSettings settings_;
  RobotSide side_;
  Measured measured_;
  bool side_known_{}, has_followed_{}, waits_for_person_{};
  Vector reference_;
  MotionState3 commanded_;              // set-points of the cycle before
  std::vector<SetpointFilter> fading_;  // reference minus set-points
  mutable std::uint64_t sequence_{};
  std::string why_{"no set-points yet"};
};

/// How many of the maker's cycles have passed, from the count in its messages.
class CycleCount {
 public:
  /// Since the message before, [1, 20].
  int passed(std::uint64_t cycle);

 private:
  std::uint64_t at_{};
  bool known_{};
};

/// What a process needs of any driver.
class Driver {
 public:
  virtual ~Driver() = default;
  /// Processes a set-point from the wire; false when it is not followed. A changed payload is
  /// passed on to the arm's controller. `now`: monotonic [s].
  bool command(const JointCommand& command, double now);
  /// Once a maker's cycle, or once the time for one has passed without it.
  virtual void cycle(double now) = 0;
  virtual void acknowledge() = 0;        ///< a person has acknowledged the stop
  virtual RobotState state() const = 0;  ///< newest state of the robot, for the wire
  /// Why the robot does not follow, one sentence; empty while it does.
  virtual std::string trouble() const = 0;
  virtual const DriverCore& core() const = 0;  ///< the part that all drivers share

 protected:
  virtual bool follow(const JointCommand& command, double now) = 0;
  virtual void set_load(double mass) = 0;  ///< in the arm's controller [kg]

 private:
  double load_{};
};

/// Returns whether each of `vectors` has one value for each axis of the arm.
bool fit(std::initializer_list<const Vector*> vectors, const std::vector<int>& axes);
/// Writes `values`, in the order of `axes`, to these axes of `robot`.
void scatter(const Vector& values, const std::vector<int>& axes, Vector& robot);
/// Returns the values of `axes` from `robot`, in the order of `axes`.
Vector gather(const Vector& robot, const std::vector<int>& axes);

}  // namespace handsel::drivers
