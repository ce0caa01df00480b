// A behaviour as a schema: perception on its own clock, a releaser, a motor part (speed, gaze).
// Chapter abstract and section 2.1. Own method: the chapter's section on attention is missing
// (formulas: section 4).
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

/// The latest samples; null = never seen.
struct World {
  const HumanState* people{};            ///< tracked people
  const Facts* facts{};                  ///< symbolic facts of SPARK
  const ActionStatus* action{};          ///< of the manipulation planner
  const ActiveTrajectory* active{};      ///< axes of the robot and the running trajectory
  const TrajectoryForecast* forecast{};  ///< of the collision checker, for the running trajectory
  const Scene* scene{};                  ///< objects and boxes
};

/// The robot's body in the world, for the schemata.
class Body {
 public:
  /// `p_tool_grasp`: where the hand touches things, in the tool frame [m].
  Body(const RobotModel& robot, const Vector3& p_tool_grasp);
  /// Returns the nearest approach of robot and people in configuration q (all axes); distance +inf
  /// when nobody is there.
  Separation separation_at(const Vector& q, const Pose& T_world_base, const HumanState& people,
                           const SeparationExemption& exception) const;
  Vector3 grasp_point(const Vector& q, const Pose& T_world_base) const;  ///< world [m]
  /// Returns a point of the frame in which the robot stands [m] in the world [m].
  Vector3 base_point(const ActiveTrajectory& active, const Vector3& p_base) const {
    if (active.position.size() != robot_.dof()) return active.T_world_base * p_base;
    return T_world_platform(robot_, active.position, active.T_world_base) * p_base;
  }
  /// Number of axes of the robot.
  int dof() const { return robot_.dof(); }

 private:
  const RobotModel& robot_;
  std::vector<LinkCapsule> capsules_;
  Vector3 p_tool_grasp_;
  mutable std::vector<Pose> links_;
};

/// Numbers of the motor parts, all behaviours: attention.txtpb.
using MotorSettings = settings::AttentionSettings::Motor;

/// What a behaviour that is described, not programmed, can watch.
enum class Input {
  human_distance,    ///< from the robot to a person, without the hand in the handover [m]
  hand_distance,     ///< from the robot's hand to the nearest hand of the person of interest [m]
  object_distance,   ///< between the robot's hand and the object of the action [m]
  clearance,         ///< least distance foreseen on the running trajectory [m]
  forecast_contact,  ///< time until a contact that is foreseen on the running trajectory [s]
  unseen_time,       ///< since the person of interest was last seen [s]
};
inline constexpr const char* kInputNames[] = {"human_distance",   "hand_distance",
                                              "object_distance",  "clearance",
                                              "forecast_contact", "unseen_time"};

enum class GazeAt { nothing, head, hand, object };

/// A behaviour of kind WATCH.
struct WatchSettings {
  Input input{};            ///< quantity observed
  double slow_from{};       ///< input below which less than full speed is asked for; 0: never
  double slow_at{};         ///< input at which slow_factor is asked for, < slow_from
  double slow_factor{1.0};  ///< [0, 1]
  GazeAt gaze{};            ///< target of the gaze, of the person of interest or the action
  std::string reason;       ///< one phrase for people
};

/// That another task should take the place of the one that runs.
struct TaskWish {
  TaskChange change{};  ///< change of the running task that is asked for
  std::string person;   ///< id of the person concerned
};

/// One behaviour. perceive() runs when its clock fires; released() and the motor part use its last
/// result.
class Schema {
 public:
  virtual ~Schema() = default;
  /// Kind of the behaviour, the same over its whole life.
  virtual Behaviour kind() const = 0;
  /// Observes the world and returns the stimulus: >= 0, SI units, smaller is more urgent; +inf:
  /// nothing is urgent.
  virtual double perceive(const World& world, TimePoint now) = 0;
  /// Returns the distance of the nearest person as of perceive() [m], for the clock law margin;
  /// +inf: nobody is there; 0: it is not known. A behaviour that observes no person returns 0.
  virtual double person_distance() const { return 0; }
  /// Returns whether the behaviour may act now; conditions of the settings come on top.
  virtual bool released(const World& world) const = 0;
  /// Speed factor asked for, in [-1, 1]; below 0: back along the path.
  virtual double speed_factor() const { return 1.0; }
  /// Returns whether the arm shall retreat beside its path.
  virtual bool leaves_path() const { return false; }
  /// One phrase for a factor below 1.
  virtual const char* reason() const { return ""; }
  /// Point the head should look at, world [m]; nothing: none.
  virtual std::optional<Vector3> gaze() const { return std::nullopt; }
  /// Shift of the exchange point, world [m]; nothing: none.
  virtual std::optional<Vector3> target_shift() const { return std::nullopt; }
  /// Change of the running task that is asked for; only of the behaviour that owns the task.
  virtual std::optional<TaskWish> wish() const { return std::nullopt; }
};

/// Returns a new behaviour; `body` must live as long. `watch`: used where the kind is watch.
std::unique_ptr<Schema> make_schema(Behaviour kind, const Body& body, const MotorSettings& motor,
                                    const ZoneSettings& zones, const WatchSettings& watch = {});

}  // namespace handsel::attention
