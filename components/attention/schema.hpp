// A behaviour as a schema: perception on its own clock, a releaser, a motor part (speed, gaze). Chapter abstract and section 2.1; the
// reconstruction is ours (formulas: section 4).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"
#include "components/attention/zones.hpp"

namespace handsel::attention {

/// The latest samples; null = never seen.
struct World {
  const HumanState* people{};
  const Facts* facts{};
  const ActionStatus* action{};
  const ActiveTrajectory* active{};
  const TrajectoryForecast* forecast{};
  const Scene* scene{};
};

/// The robot's body in the world, for the schemata.
class Body {
 public:
  /// `p_tool_grasp`: where the hand touches things, in the tool frame [m].
  Body(const RobotModel& robot, const Vector3& p_tool_grasp);
  /// Nearest approach in posture q (all axes); distance +inf when nobody is there.
  Separation separation_at(const Vector& q, const Pose& T_world_base, const HumanState& people, const Exception& exception) const;
  Vector3 grasp_point(const Vector& q, const Pose& T_world_base) const;  ///< world [m]
  Vector3 base_point(const Pose& T_world_base, const Vector3& p_base) const { return T_world_base * p_base; }
  int dof() const { return robot_.dof(); }

 private:
  const RobotModel& robot_;
  std::vector<LinkCapsule> capsules_;
  Vector3 p_tool_grasp_;
  mutable std::vector<Pose> links_;
};

/// Numbers of the motor parts, all behaviours (units in the comments).
struct MotorSettings {
  double avoid_stop{0.06};           ///< nearest distance at which AVOID asks for 0 [m]
  double avoid_slow{0.60};           ///< distance from which AVOID asks for less than 1 [m]
  double avoid_contact_time{1.2};    ///< time to contact from which AVOID asks for less than 1 [s]
  double partner_slow{0.40};         ///< both of whom the robot hands something to or takes something from: they expect it near [m] ...
  double partner_contact_time{0.8};  ///< ... [s]
  double avoid_recede{0.5};          ///< least factor while the running trajectory leads away from the person
  double recoil_factor{-0.15};       ///< factor when nearer than avoid_stop and closing in
  double recoil_speed{0.10};         ///< closing speed that counts as closing in [m/s]
  double ease_distance{0.10};        ///< PICK and PLACE ease over this distance [m]
  double ease_factor{0.4};           ///< to this factor
  double hand_near{0.30};            ///< GIVE and RECEIVE slow when the person's hand is nearer than this [m]
  double hand_factor{0.25};          ///< to this factor
  double shift_limit{0.15};          ///< largest shift of the exchange point [m]
  double lost_after{1.0};            ///< a person not seen for longer is not tracked [s]
  double reach_near{0.6};            ///< a hand that reaches for what the robot holds counts when it is nearer than this [m] ...
  double reach_hold{0.2};            ///< ... for this long [s]
};

/// What a behaviour that is described, not programmed, can watch.
enum class Input {
  human_distance,    ///< least distance between robot and a person, the exchanging hand left out [m]
  hand_distance,     ///< between the robot's hand and the nearest hand of the person of interest [m]
  object_distance,   ///< between the robot's hand and the object of the action [m]
  clearance,         ///< least distance foreseen on the running trajectory [m]
  forecast_contact,  ///< time until a contact that is foreseen on the running trajectory [s]
  unseen_time,       ///< since the person of interest was last seen [s]
};
inline constexpr const char* kInputNames[] = {"human_distance", "hand_distance",    "object_distance",
                                              "clearance",      "forecast_contact", "unseen_time"};

enum class GazeAt { nothing, head, hand, object };

/// A behaviour of kind WATCH.
struct WatchSettings {
  Input input{};
  double slow_from{};       ///< input below which it asks for less than full speed (unit of the input); 0: never
  double slow_at{};         ///< input at which it asks for slow_factor, < slow_from
  double slow_factor{1.0};  ///< [0, 1]
  GazeAt gaze{};
  std::string reason;  ///< one phrase for people
};

/// That another task should take the place of the one that runs.
struct TaskWish {
  TaskChange change{};
  std::string person;  ///< whom it is about
};

/// One behaviour. perceive() runs when its clock fires; released() and the motor part use what it saw last.
class Schema {
 public:
  virtual ~Schema() = default;
  virtual Behaviour kind() const = 0;
  /// Looks; returns the stimulus: >= 0, SI, smaller is more urgent.
  virtual double perceive(const World& world, TimePoint now) = 0;
  virtual bool released(const World& world) const = 0;
  virtual double speed_factor() const { return 1.0; }
  virtual const char* reason() const { return ""; }                             ///< one phrase for a factor below 1
  virtual std::optional<Vector3> gaze() const { return std::nullopt; }          ///< world [m]
  virtual std::optional<Vector3> target_shift() const { return std::nullopt; }  ///< world [m]
  virtual std::optional<TaskWish> wish() const { return std::nullopt; }         ///< only of the behaviour that owns the task
};

std::unique_ptr<Schema> make_schema(Behaviour kind, const Body& body, const MotorSettings& motor, const ZoneSettings& zones,
                                    const WatchSettings& watch = {});

}  // namespace handsel::attention
