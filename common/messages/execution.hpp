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

/// Motion permission, from the supervisor. Topic Go, profile command (transient local here: keep last of one writer).
/// A new epoch resumes after Hold, and after Stop once its cause is gone; a person (acknowledge) after Fault.
struct Go {
  Stamp stamp{};
  std::uint64_t epoch{};
  bool allowed{};               ///< false: Hold
  bool acknowledge{};           ///< a person acknowledged a Fault
  double override_factor{1.0};  ///< global speed override [0, 1]
  std::string reason;
  std::uint64_t state_revision{};  ///< SafetyState::revision the permission was issued from; 0: from none, which permits no motion
};

/// Soft motion for some axes; starts when accepted, or joins the queue of what runs. Topic Trajectory, profile command.
struct TrajectoryCommand {
  Stamp stamp{};
  std::uint64_t id{};     ///< unique, grows
  std::uint64_t epoch{};  ///< the Go it belongs to; another epoch is refused
  std::string robot;
  std::vector<std::uint32_t> axes;  ///< robot axis of each trajectory axis
  Trajectory trajectory;
  double switch_at{};     ///< on the own time of the command accepted before: when that is left for this one; 0 or past: now [s]
  Attachment attachment;  ///< what the hand holds while it runs
  std::vector<std::string> allowed_contacts;
};

enum class HandAction : std::uint8_t {
  move,             ///< to `position`
  grasp,            ///< toward `position`, squeezing until contact holds
  release_on_pull,  ///< keep the grasp; open to `position` when a person pulls confidently
  release,          ///< open to `position` now
};

/// Topic HandCommand, profile command.
struct HandCommand {
  Stamp stamp{};
  std::uint64_t id{};
  std::uint64_t epoch{};
  std::string robot;
  HandAction action{HandAction::move};
  std::string group{};     ///< the hand's axes; empty: "hand"
  Vector position;         ///< actuated hand axes, in the order of the group [rad]
  Vector effort;           ///< likewise, of a grasp: what they squeeze with [Nm]; empty: as before while holding, else the settings' own
  double pull_force{4.0};  ///< [N] beyond the load's weight, for release_on_pull
  double payload{};        ///< mass of what is grasped, 0: unknown [kg]
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
  human_unknown,       ///< Slow: nobody is seen, but not all is covered
  drive_not_enabled,   ///< Stop
  tracking_error,      ///< Fault
  limit_violation,     ///< Fault
  cycle_late,          ///< Hold after several in a row; Stop when the robot side lacks set-points
  override_slow,       ///< Slow
  wall,                ///< Slow: a virtual wall or the end of the workspace is ahead
  contact,             ///< Stop: the arm feels a contact
  cost_ahead,          ///< Slow: the human-aware cost on the way ahead is high
  blind,               ///< Slow or Hold: no live source observes where the arm can be within its stop
  stop_unproven,       ///< Slow: a set-point had no checked stop behind it
  second_writer,       ///< named only: somebody else publishes a topic that has one writer; its samples are refused
  clamped,             ///< Stop: the arm has been pressed against something for too long
  awaits_person,       ///< Hold: a person has to resume (after a pause, a fault, a protective, user or emergency stop)
};
const char* name(Cause);
/// Returns the bit of a cause in ExecutionStatus::causes; 0 for none.
constexpr std::uint32_t bit(Cause cause) { return cause == Cause::none ? 0U : 1U << static_cast<unsigned>(cause); }
const char* name(Mode);

enum class MotionState : std::uint8_t { idle, running, finished, refused, stopped };
enum class HandState : std::uint8_t { idle, moving, grasped, empty, released, refused };

/// A hand other than the first one.
struct OtherHandState {
  std::string group;
  HandState hand{HandState::idle};  ///< of the last command to it
};

/// 50 Hz and on every change. Topic ExecutionStatus, profile state.
struct ExecutionStatus {
  Stamp stamp{};
  std::string robot;
  Mode mode{Mode::hold};
  std::uint32_t causes{};      ///< bits of Cause
  std::uint64_t epoch{};       ///< Go in force
  std::uint64_t trajectory{};  ///< last trajectory id received
  MotionState motion{MotionState::idle};
  double progress{};             ///< time along the trajectory / its duration
  std::uint64_t hand_command{};  ///< last hand command id received
  HandState hand{HandState::idle};
  std::vector<OtherHandState> other_hands{};                                      ///< none: there is one hand
  double pull{};                                                                  ///< force beyond the load's weight, toward the person [N]
  std::string reason;                                                             ///< of the last refusal, or of slowing, one sentence
  std::uint64_t cycles{}, late_cycles{};                                          ///< control cycles; later than one period
  double limit_share_velocity{}, limit_share_acceleration{}, limit_share_jerk{};  ///< largest |.| sent so far / guard limit
  double separation{1e9};     ///< to the nearest person, excepted parts left out [m]; 1e9 = nobody
  double separation_limit{};  ///< what the separation rule asks for there at the present speed [m]
  Vector3 nearest_on_robot{Vector3::Zero()}, nearest_on_person{Vector3::Zero()};  ///< on the axes of the nearest capsules, world [m]
};

/// What moves now. Topic ActiveTrajectory, profile advice, 50 Hz.
struct ActiveTrajectory {
  Stamp stamp{};
  std::string robot;
  Pose T_world_base{Pose::Identity()};      ///< root link of the robot in the world, as last measured
  std::uint64_t trajectory{};               ///< 0: at rest
  double time{};                            ///< along the trajectory [s]
  double speed_factor{};                    ///< alpha in force, [-1, 1]
  Vector position, velocity, acceleration;  ///< set-point, all axes
  std::vector<std::uint32_t> axes;
  Trajectory rest;  ///< the trajectory that runs (from its own time 0)
  Attachment attachment;
  std::vector<std::string> allowed_contacts;
};

/// Topic TrajectoryForecast, profile advice, 50 Hz, from the collision checker.
struct TrajectoryForecast {
  Stamp stamp{};
  std::uint64_t trajectory{};
  bool collides{};
  double time_to_collision{};  ///< at present speed [s]; infinity if none within the horizon (1e9 on the wire)
  double clearance{};          ///< least distance to people over the horizon [m]
  double cost{};               ///< largest human-aware cost over the horizon, [0, 1]
  std::string reason;          ///< what touches what
};

}  // namespace handsel
