// What every driver does between the wire and its maker's controller: watches the set-points, refuses those the arm cannot follow, carries
// them over from the wire's clock to the maker's, stops softly when they fail, takes them up again without a jump, waits for a person after
// a stop of the maker's own, reports the robot's state. Pure: the maker's side is called by the driver. Ours.
#pragma once

#include <string>
#include <vector>

#include "common/messages/robot.hpp"
#include "common/model/robot_model.hpp"
#include "common/robot_side/robot_side.hpp"
#include "common/trajectory/setpoint_filter.hpp"

namespace handsel::drivers {

struct DriverSettings {
  bool dry_run{false};                  ///< everything but the output: nothing is sent to the arm, the posture it would have is reported
  double fade_share{0.1};               ///< share of the guard limits with which a jump between set-points and reference fades
  Pose T_world_base{Pose::Identity()};  ///< where the robot stands
  RobotSideSettings watch;
};

/// What the maker's controller measured in a cycle; all axes of the robot description.
struct Measured {
  Vector position, velocity, effort, external_torque;
  Wrench wrist_wrench;
  double payload{};                ///< [kg]
  DriveMode mode{DriveMode::off};  ///< enabled: it would follow references
  std::string why;                 ///< one sentence, when it would not
  bool by_person{};                ///< what stopped it ends with a person's acknowledgement only, once the arm has been commanded
};

class DriverCore {
 public:
  /// `arm_axes`: robot axes that the maker's references move. The rest (gripper, head) are the driver's own business: here they are
  /// reported where they are told to be.
  DriverCore(const RobotModel& model, std::vector<int> arm_axes, const DriverSettings& settings);

  /// A set-point from the wire. False when it is not followed. `now`: monotonic [s].
  bool command(const JointCommand& command, double now);
  /// Once a maker's cycle of `dt` [s], before reference(). Any mode but enabled holds where the robot stands.
  void update(const Measured& measured, double now, double dt);
  /// The maker's controller follows no references though it says nothing of a stop: holds until set-points stand at the posture again.
  void hold(const std::string& why);
  /// The maker's controller begins to follow, from `position` (all axes): the references start there, and what they are off fades.
  void start_from(const Vector& position) noexcept;
  /// A stop of the driver's own, soft.
  void stop(const std::string& why);
  /// A person has looked and lets the robot go on. Counts only once the cause is gone.
  void acknowledge();

  const Vector& reference() const { return reference_; }  ///< all axes, for this cycle
  bool following() const { return side_known_ && side_.mode() == DriveMode::enabled && side_.follows(); }
  bool waits_for_person() const { return waits_for_person_; }
  /// For the wire. `commanding`: the maker's controller follows references right now.
  RobotState state(bool commanding) const;
  /// Why the robot does not follow, one sentence; empty while it does.
  std::string trouble() const;
  std::uint64_t refused() const { return side_.refused(); }  ///< set-points not followed though the robot could move
  const DriverSettings& settings() const { return settings_; }
  const RobotModel& model() const { return model_; }
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
  MotionState3 told_;                   // set-points as they were a cycle ago
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
  /// A set-point from the wire. False when it is not followed. What the hand holds is told on to the arm's controller.
  bool command(const JointCommand& command, double now);
  virtual void cycle(double now) = 0;  ///< once a maker's cycle, or once the time for one has passed without it
  virtual void acknowledge() = 0;      ///< a person has looked
  virtual RobotState state() const = 0;
  virtual std::string trouble() const = 0;  ///< why the robot does not follow, one sentence; empty while it does
  virtual const DriverCore& core() const = 0;

 protected:
  virtual bool follow(const JointCommand& command, double now) = 0;
  virtual void set_load(double mass) = 0;  ///< in the arm's controller [kg]

 private:
  double load_{};
};

/// `values` of the arm's own order into the robot's, and back.
void scatter(const Vector& values, const std::vector<int>& axes, Vector& robot);
Vector gather(const Vector& robot, const std::vector<int>& axes);

}  // namespace handsel::drivers
