// SPDX-License-Identifier: Apache-2.0
// All hands of the robot: commands to them, their motion, and the mass they hold. Pure; no heap in
// step().
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/messages/execution.hpp"
#include "common/model/robot_model.hpp"
#include "components/trajectory_controller/hand/hand_executor.hpp"
#include "components/trajectory_controller/input/observed_people.hpp"
#include "components/trajectory_controller/supervise/finger_limit.hpp"

namespace handsel::trajectory_controller {

/// Inputs of one step of all hands.
struct HandsInputs {
  const RobotState& robot;               ///< newest
  const ObservedPeople& people;          ///< newest
  const std::vector<Pose>& T_root_link;  ///< where the hands are
  bool new_state{};                      ///< robot has come since the last step
  const std::vector<char>& on_path;      ///< of each axis of the robot: a trajectory moves it
  Mode mode{Mode::hold};                 ///< of this cycle
  bool clamped{};                        ///< the arm is clamped
};

class Hands {
 public:
  /// One for each hand of the robot, with or without fingers. `period`: of control [s].
  Hands(const HandSettings& settings, const RobotModel& robot, double period);

  /// Returns whether a command with this id was accepted last.
  bool accepted(std::uint64_t id) const noexcept { return id != 0 && id == accepted_; }
  /// Gives a command to its hand. `refusal`: why no command counts now; empty: it does. `on_path`:
  /// of each axis of the robot, whether a trajectory moves it; then the hand takes no command.
  /// Returns why it is refused, one sentence; empty when accepted.
  std::string accept(const HandCommand& command, std::string refusal,
                     const std::vector<char>& on_path);
  /// Returns why a trajectory cannot move these axes of the robot, one sentence; empty: it can. A
  /// hand that executes a command or holds something moves its fingers by itself.
  std::string why_not_on_path(const std::vector<std::uint32_t>& axes) const;
  /// Begins at rest at `position` (all axes) with nothing held or, with `reference`, with the
  /// efforts and masses that the robot side holds: what is held stays held.
  void reset(const Vector& position, const ServoReference* reference) noexcept;
  /// Writes the axes of the hands of the next set-point. Returns whether the outcome of a command
  /// changed.
  bool step(const HandsInputs& in, TimePoint now, MotionState3& next) noexcept;
  /// Motions keep these bounds from now on, see HandExecutor.
  void limit(const FingerBounds& bounds) noexcept;
  /// Every axis stops from `sent` as fast as it can; writes the next set-point.
  void stop_from(const MotionState3& sent, MotionState3& next) noexcept;
  /// Moves the set-points to the measured positions, see HandExecutor.
  void follow(const Vector& position, double dead_band) noexcept;

  /// Axes of all fingers.
  const std::vector<int>& axes() const noexcept { return axes_; }
  /// Efforts of the motors beside those of following the set-point, all axes of the robot [Nm].
  const Vector& effort() const noexcept { return effort_; }
  /// Mass of what the first hand holds; 0: nothing or unknown [kg].
  double payload() const noexcept { return hands_.empty() ? 0.0 : hands_.front().payload; }
  /// Mass of what each other hand holds [kg].
  const Vector& other_payloads() const noexcept { return other_payloads_; }
  /// Mass of what all hands hold [kg].
  double held_payload() const noexcept;
  /// Returns whether a hand is executing a command.
  bool any_moving() const noexcept;
  /// Returns whether the hand of this group, or else the first one, has released what it held.
  bool has_released(const std::string& group) const noexcept;

  /// State of each hand as reported, a byte each.
  std::uint64_t key() const noexcept;
  /// Writes the commands and their outcomes into the status.
  void report(ExecutionStatus& status) const;
  /// Id of the last command, accepted or not.
  std::uint64_t last_command() const noexcept { return last_command_; }

 private:
  struct Hand {
    std::string group;  // of its axes
    int palm{-1};       // link
    HandExecutor executor;
    bool refused{};   // the last command to it
    bool together{};  // it holds one object together with the other hands for which this is true
    bool restarts_watch{};  // another of these hands begins to wait for a pull
    double grasped_payload{}, payload{};
    HandState reported() const noexcept { return refused ? HandState::refused : executor.state(); }
  };

  Hand* find(const std::string& group);
  void step(std::size_t index, const HandsInputs& in, TimePoint now, MotionState3& next) noexcept;
  /// Writes force and people at a hand; the force of hands that hold one object together is summed.
  void feel(std::size_t index, const HandsInputs& all, HandInputs& in) const noexcept;

  double period_;
  std::vector<Hand> hands_;
  std::vector<int> axes_;
  Vector other_payloads_;
  Vector effort_;
  bool too_near_{};  // a person is too near for fingers that move or close
  std::uint64_t last_command_{}, accepted_{};
};

}  // namespace handsel::trajectory_controller
