// SPDX-License-Identifier: Apache-2.0
// A behaviour as a schema: perception on its own clock, a releaser, a motor part (speed, gaze).
// Chapter abstract and section 2.1. Own method: the chapter has no section on attention (formulas:
// section 4).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/config/settings/attention.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "common/model/platform.hpp"
#include "common/model/robot_capsules.hpp"
#include "components/attention/zones.hpp"

namespace handsel::attention {

/// The latest samples; null: none received.
struct World {
  const HumanState* people{};            ///< tracked people
  const Facts* facts{};                  ///< symbolic facts of SPARK
  const ActionStatus* action{};          ///< status of the manipulation planner
  const ActiveTrajectory* active{};      ///< axes of the robot and the running trajectory
  const TrajectoryForecast* forecast{};  ///< forecast of the running trajectory
  const Scene* scene{};                  ///< objects and boxes
};

/// Geometry of the robot for the behaviours.
class Body {
 public:
  /// `p_tool_grasp`: contact point of the hand, in the tool frame [m].
  Body(const RobotModel& robot, const Vector3& p_tool_grasp);
  /// Returns the nearest approach of robot and people in configuration q (all axes); distance +inf
  /// without people.
  Separation separation_at(const Vector& q, const Pose& T_world_base, const HumanState& people,
                           const SeparationExemption& exception) const;
  /// Returns the contact point of the hand, world [m].
  Vector3 grasp_point(const Vector& q, const Pose& T_world_base) const;
  /// Converts a point from the frame of the robot's base or platform to the world [m].
  Vector3 base_point(const ActiveTrajectory& active, const Vector3& p_base) const {
    if (active.position.size() != robot_.dof()) return active.T_world_base * p_base;
    return T_world_platform(robot_, active.position, active.T_world_base) * p_base;
  }
  /// Returns the number of axes of the robot.
  int dof() const { return robot_.dof(); }

 private:
  const RobotModel& robot_;
  std::vector<LinkCapsule> capsules_;
  Vector3 p_tool_grasp_;
  mutable std::vector<Pose> links_;
};

/// Parameters of the motor parts of all behaviours: attention.txtpb.
using MotorSettings = settings::AttentionSettings::Motor;

/// Inputs of a behaviour of kind watch.
enum class Input {
  human_distance,    ///< from the robot to a person, without the exempt hand [m]
  hand_distance,     ///< from the robot's hand to the nearest hand of the person of interest [m]
  object_distance,   ///< between the robot's hand and the object of the action [m]
  clearance,         ///< min forecast distance on the running trajectory [m]
  forecast_contact,  ///< forecast time to a contact on the running trajectory [s]
  unseen_time,       ///< since the person of interest was last observed [s]
};
inline constexpr const char* kInputNames[] = {"human_distance",   "hand_distance",
                                              "object_distance",  "clearance",
                                              "forecast_contact", "unseen_time"};

enum class GazeAt { nothing, head, hand, object };

/// A behaviour of kind WATCH.
struct WatchSettings {
  Input input{};            ///< observed quantity
  double slow_from{};       ///< input below which the speed is reduced; 0: never
  double slow_at{};         ///< input at which slow_factor applies, < slow_from
  double slow_factor{1.0};  ///< min speed factor, [0, 1]
  GazeAt gaze{};            ///< gaze target on the person of interest or the action's object
  std::string reason;       ///< reason as one phrase
};

/// A requested change of the running task.
struct TaskWish {
  TaskChange change{};  ///< requested change
  std::string person;   ///< id of the relevant person
};

/// One behaviour. perceive() runs when its clock fires; released() and the motor part use its last
/// result.
class Schema {
 public:
  virtual ~Schema() = default;
  /// Returns the kind of the behaviour, which never changes.
  virtual Behaviour kind() const = 0;
  /// Observes the world and returns the stimulus >= 0 in SI units, which falls with urgency; +inf:
  /// not urgent.
  virtual double perceive(const World& world, TimePoint now) = 0;
  /// Returns the distance of the nearest person as of perceive() [m], for the clock law margin;
  /// +inf: no person; 0: unknown, or the behaviour observes no person.
  virtual double person_distance() const { return 0; }
  /// Returns whether the behaviour may act now; the settings may add further conditions.
  virtual bool released(const World& world) const = 0;
  /// Returns the requested speed factor, [-1, 1]; negative: backward on the path.
  virtual double speed_factor() const { return 1.0; }
  /// Returns whether the arm is to retreat off its path.
  virtual bool leaves_path() const { return false; }
  /// Returns the reason of a factor below 1 as one phrase.
  virtual const char* reason() const { return ""; }
  /// Returns the gaze target of the head, world [m]; nullopt: none.
  virtual std::optional<Vector3> gaze() const { return std::nullopt; }
  /// Returns whether the gaze target has precedence over those of all other behaviours.
  virtual bool needs_gaze() const { return false; }
  /// Returns the shift of the exchange point, world [m]; nullopt: none.
  virtual std::optional<Vector3> target_shift() const { return std::nullopt; }
  /// Returns the requested change of the running task; nullopt for all but the task's behaviour.
  virtual std::optional<TaskWish> wish() const { return std::nullopt; }
};

/// Returns a new behaviour; `body` must outlive it. `watch`: used by the kind watch.
std::unique_ptr<Schema> make_schema(Behaviour kind, const Body& body, const MotorSettings& motor,
                                    const ZoneSettings& zones, const WatchSettings& watch = {});

}  // namespace handsel::attention
