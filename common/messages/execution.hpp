// SPDX-License-Identifier: Apache-2.0
// Between the manipulation planner and the trajectory controller: what to run, what runs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/errors.hpp"
#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "common/messages/planning.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

/// Motion permission, from the supervisor. Topic Go, profile latch.
/// A new epoch resumes after Hold, and after Stop once its cause is gone; a person (acknowledge)
/// after Fault.
struct Go {
  Stamp stamp{};          ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t epoch{};  ///< grows when motion may resume; commands of another epoch are refused
  bool allowed{};         ///< false: Hold
  bool acknowledge{};     ///< a person acknowledged a Fault
  double override_factor{1.0};  ///< global speed override [0, 1]
  std::string reason;           ///< why motion is permitted or not, one sentence
  /// SafetyState::revision the permission was issued from; 0: from none, which permits no motion.
  std::uint64_t state_revision{};
};

/// Jerk-limited motion of some axes; starts when accepted, or is queued behind the running one.
/// Topic Trajectory, profile command.
struct TrajectoryCommand {
  Stamp stamp{};                    ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t id{};               ///< unique, grows
  std::uint64_t epoch{};            ///< the Go it belongs to; another epoch is refused
  std::string robot;                ///< name of the robot description; the key of the topic
  std::vector<std::uint32_t> axes;  ///< robot axis of each trajectory axis
  Trajectory trajectory;            ///< one motion per entry of `axes`, all of equal duration
  /// Own time of the command accepted before at which this one takes over [s]; 0 or past: now.
  double switch_at{};
  Attachment attachment;                      ///< what the hand holds while it runs
  std::vector<std::string> allowed_contacts;  ///< as PathRequest::allowed_contacts
};

enum class HandAction : std::uint8_t {
  move,             ///< to `position`
  grasp,            ///< toward `position`, with grip force until contact holds
  release_on_pull,  ///< keep the grasp; open to `position` when a person pulls confidently
  release,          ///< open to `position` now
};

/// Command to one hand. Topic HandCommand, profile command.
struct HandCommand {
  Stamp stamp{};                        ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t id{};                   ///< unique, grows
  std::uint64_t epoch{};                ///< the Go it belongs to; another epoch is refused
  std::string robot;                    ///< name of the robot description; the key of the topic
  HandAction action{HandAction::move};  ///< kind of the command
  std::string group{};                  ///< the hand's axes; empty: "hand"
  Vector position;                      ///< actuated hand axes, in the order of the group [rad]
  /// Grip torque of those axes in a grasp [Nm]; empty: as before while holding, else that of the
  /// settings.
  Vector effort;
  double pull_force{4.0};  ///< [N] beyond the load's weight, for release_on_pull
  double payload{};        ///< mass of what is grasped by this hand, 0: unknown [kg]
  /// The hand holds one object together with the other hands that have such a command: the pull is
  /// that on all of them, and they release together.
  bool both_hands{};
};

/// Ordered: further down takes precedence (architecture: mode machine).
enum class Mode : std::uint8_t { normal, slow, hold, stop, fault };

/// Named causes; the bit is 1 << value.
enum class Cause : std::uint8_t {
  none,
  no_go,               ///< Hold: no permission to move
  supervisor_silent,   ///< Hold at the end of the trajectory
  forecast_silent,     ///< Hold
  forecast_collision,  ///< Slow or Hold
  attention_silent,    ///< Slow
  attention_slow,      ///< Slow
  separation,          ///< Slow ... Stop
  robot_state_silent,  ///< Stop
  human_state_silent,  ///< Stop
  human_unknown,       ///< Slow: no person is observed, but not all space is covered
  drive_not_enabled,   ///< Stop
  tracking_error,      ///< Fault
  limit_violation,     ///< Fault
  cycle_late,          ///< Hold after several in a row; Stop when the robot side lacks set-points
  override_slow,       ///< Slow
  wall,                ///< Slow: a virtual wall or the end of the workspace is ahead
  contact,             ///< Stop: the arm feels a contact
  cost_ahead,          ///< Slow: the human-aware cost ahead on the trajectory is high
  blind,          ///< Slow or Hold: no live source observes where the arm can be within its stop
  stop_unproven,  ///< Slow: a set-point had no checked stop behind it
  /// Reported only: a topic with one writer has a second one, whose samples are refused.
  second_writer,
  clamped,  ///< Stop: the arm has been pressed against something for too long
  /// Hold: a person has to resume (after a pause, a fault, a protective, user or emergency stop).
  awaits_person,
  unlocalised,  ///< Hold: the place of the platform has not been observed for too long
};
/// Returns the word of kCauseNames; "unknown" for a value outside the enumeration.
const char* name(Cause);
/// Returns the bit of a cause in ExecutionStatus::causes; 0 for none.
constexpr std::uint32_t bit(Cause cause) {
  return cause == Cause::none ? 0U : 1U << static_cast<unsigned>(cause);
}
/// Returns the word of kModeNames; "unknown" for a value outside the enumeration.
const char* name(Mode);

enum class MotionState : std::uint8_t { idle, running, finished, refused, stopped };
enum class HandState : std::uint8_t { idle, moving, grasped, empty, released, refused };
/// Returns the word of kHandStateNames; "unknown" for a value outside the enumeration.
const char* name(HandState);

/// A hand other than the first one.
struct OtherHandState {
  std::string group;                ///< group of the hand's axes in the robot description
  HandState hand{HandState::idle};  ///< of the last command to it
};

/// State of the trajectory controller, 50 Hz and on every change. Topic ExecutionStatus, profile
/// state.
struct ExecutionStatus {
  Stamp stamp{};                          ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::string robot;                      ///< name of the robot description; the key of the topic
  Mode mode{Mode::hold};                  ///< mode of the controller
  std::uint32_t causes{};                 ///< causes in force, see bit()
  std::uint64_t epoch{};                  ///< Go in force
  std::uint64_t trajectory{};             ///< last trajectory id received
  MotionState motion{MotionState::idle};  ///< state of that trajectory
  double progress{};                      ///< time along the trajectory / its duration
  std::uint64_t hand_command{};           ///< last hand command id received
  HandState hand{HandState::idle};        ///< state of that command
  std::vector<OtherHandState> other_hands{};  ///< every hand but the first; empty: there is one
  double pull{};                          ///< force beyond the load's weight, toward the person [N]
  std::string reason;                     ///< of the last refusal, or of slowing, one sentence
  std::uint64_t cycles{}, late_cycles{};  ///< control cycles; later than one period
  /// Largest |.| sent so far / guard limit.
  double limit_ratio_velocity{}, limit_ratio_acceleration{}, limit_ratio_jerk{};
  double separation{1e9};  ///< to the nearest person, without exempt parts [m]; 1e9: no person
  /// Required by speed and separation monitoring there at the present speed [m].
  double separation_limit{};
  /// On the axes of the nearest capsules, world [m].
  Vector3 nearest_on_robot{Vector3::Zero()}, nearest_on_person{Vector3::Zero()};
};

/// The motion being executed. Topic ActiveTrajectory, profile advice, 50 Hz.
struct ActiveTrajectory {
  Stamp stamp{};                        ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::string robot;                    ///< name of the robot description; the key of the topic
  Pose T_world_base{Pose::Identity()};  ///< root link of the robot in the world, as last measured
  std::uint64_t trajectory{};           ///< id of the running trajectory; 0: at rest
  double time{};                        ///< time along the trajectory [s]
  double speed_factor{};                ///< alpha in force, [-1, 1]
  Vector position, velocity, acceleration;    ///< set-point, all axes
  std::vector<std::uint32_t> axes;            ///< robot axis of each axis of `rest`
  Trajectory rest;                            ///< the trajectory that runs (from its own time 0)
  Attachment attachment;                      ///< what the hand holds
  std::vector<std::string> allowed_contacts;  ///< as PathRequest::allowed_contacts
};

/// Predicted collisions of the running trajectory. Topic TrajectoryForecast, profile advice, 50 Hz,
/// from the collision checker.
struct TrajectoryForecast {
  Stamp stamp{};               ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t trajectory{};  ///< id of the trajectory checked; 0: at rest
  bool collides{};             ///< a collision is predicted within the horizon
  /// At present speed [s]; infinity if none within the horizon (1e9 on the wire).
  double time_to_collision{};
  double clearance{};  ///< min distance to people over the horizon [m]
  double cost{};       ///< max human-aware cost over the horizon, [0, 1]
  std::string reason;  ///< which bodies touch
};

}  // namespace handsel
