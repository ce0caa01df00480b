// SPDX-License-Identifier: Apache-2.0
// Health of the processes, control of the simulator, and the ground truth for tests.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "common/messages/world.hpp"

namespace handsel {

enum class HealthState : std::uint8_t { starting, ok, degraded, stopping };

/// Reception of one topic by one component.
struct TopicHealth {
  std::string topic;                ///< name on the wire
  std::uint64_t received{};         ///< samples accepted since start
  double rate{};                    ///< mean over about the last half second [Hz]
  double age{};                     ///< since the last one [s]; negative: never seen
  std::uint64_t deadline_misses{};  ///< silences longer than the topic's deadline
  std::uint64_t rejected{};         ///< malformed samples dropped
  std::string last_rejection;       ///< one sentence
  /// Samples of another writer than the accepted one, on a topic with one writer.
  std::uint64_t refused{};
  /// Identity of that other writer (process, host), while it is there; else empty.
  std::string second_writer{};
};

/// How often something was left out or dropped, by cause.
struct NamedCount {
  std::string name;       ///< what and why, e.g. "people: farther than the nearest 16"
  std::uint64_t count{};  ///< since the start of the process
};

/// Topic ComponentHealth, profile health, 10 Hz, keyed by component.
struct ComponentHealth {
  Stamp stamp{};                             ///< time of sending, UTC [ns]
  std::string component;                     ///< name of the component; the key of the topic
  std::uint64_t incarnation{};               ///< random per process start
  std::uint32_t pid{};                       ///< operating-system process; 0: none
  HealthState state{HealthState::starting};  ///< degraded: `reason` says why
  std::string reason;                        ///< why the state is degraded, one sentence
  bool job_silent{};   ///< a job in the background gives no sign of life (Executor::job_silent())
  double cpu{};        ///< load of one core, 1: fully used
  double memory_mb{};  ///< resident memory [MB]
  double uptime{};     ///< since the start of the process [s]
  std::vector<TopicHealth> topics;     ///< one entry per subscription, at most 64
  std::vector<NamedCount> left_out{};  ///< what quotas have left out since start
};

/// Latches that outlive every process: what a person, a fault or a stop has decided. Topic
/// SafetyState, profile latch, from the supervisor, which keeps it on disk.
struct SafetyState {
  Stamp stamp{};  ///< time of the state, UTC [ns]; `age` of the lost people counts from it
  std::uint64_t revision{};     ///< grows with every change, also over restarts; 0: never valid
  bool paused{};                ///< a person paused the robot
  double override_factor{1.0};  ///< speed override a person asked for, [0, 1]
  bool fault{};                 ///< an unacknowledged fault
  bool awaits_person{};         ///< a protective, user or emergency stop without a resume since
  std::string reason;           ///< why it does not permit motion, one sentence; empty: it does
  /// People out of sight and not known to have left, in their last known state.
  std::vector<Person> lost{};
};

/// Time grant of the simulator. Time of the system is CLOCK_MONOTONIC of the simulator's machine
/// less `waited`, and halts at `granted_until`. Topic SimClock, profile advice, 100 Hz.
struct SimClock {
  Stamp stamp{};                ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t incarnation{};  ///< incarnation of the simulator
  /// Grows by one with each grant; the same one again while the simulator waits.
  std::uint64_t sequence{};
  double granted_until{};  ///< no component's time passes this instant [s], [0, 1e9]
  double waited{};         ///< total halt of time since the simulator started [s], [0, 1e9]
};

/// A process has received a grant of SimClock, and handled what came before it. Topic ClockReached,
/// profile advice, keyed by component.
struct ClockReached {
  Stamp stamp{};                ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::string component;        ///< name of the component; the key of the topic
  std::uint64_t incarnation{};  ///< process id: one that the kernel has stopped is not waited for
  std::uint64_t sequence{};     ///< of that grant
};

enum class SimAction : std::uint8_t {
  pause,
  resume,
  reset,
  person_freeze,
  person_unfreeze,
  person_dart,
  person_leave,
  person_refuse,
  robot_stop,
  robot_enable,
  silence_human,
  silence_robot_state,
  restore,
  human_frozen,       ///< the source repeats its last picture for `value` seconds, with new stamps
  human_empty,        ///< the source repeats an empty picture for `value` seconds
  human_late,         ///< the source is late by `value` seconds until restored
  human_elsewhere,    ///< the source observes another region for `value` seconds
  emergency_stop,     ///< the red button
  localisation_lost,  ///< the place of the platform is not found for `value` seconds
  localisation_jump,  ///< the place of the platform is found `value` m beside it, along x
  wheel_slip,         ///< the wheels roll on by `value` m without the platform
  /// The hand `side` of the person goes to `point` and stays there, at most for `value` seconds; 0:
  /// it goes back.
  person_hand,
  person_look_away  ///< the person looks away for `value` seconds
};

/// Topic SimControl, profile goal: disturbances and control of the simulator.
struct SimControl {
  Stamp stamp{};        ///< time of sending, UTC [ns]; 0: filled in by the bus
  SimAction action{};   ///< disturbance or control wanted
  std::string subject;  ///< person or source
  double value{};       ///< dart: speed [m/s]; silence: duration [s]
  Side side{};          ///< the hand that person_hand moves
  /// Where person_hand moves the centre of the hand, world [m].
  Vector3 point{Vector3::Zero()};
};

/// A note of the operator of a study, for the record; no component reads it but the bridge. Topic
/// StudyMark, profile goal, on demand.
struct StudyMark {
  Stamp stamp{};            ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::string condition;    ///< of the study; empty: none
  std::string participant;  ///< pseudonym; empty: none
  std::uint64_t trial{};    ///< number in the order in which trials are done, from 1; 0: none
  std::string text;         ///< the mark, e.g. "begin"
};

/// Ground truth of the simulator, for tests and reports only. Topic GroundTruth, profile state, 50
/// Hz.
struct GroundTruth {
  Stamp stamp{};              ///< time of sending, UTC [ns]; 0: filled in by the bus
  double sim_time{};          ///< simulated time since the start of the scenario [s]
  double real_time_factor{};  ///< simulated time / real time over the last second or more
  std::string carrier;  ///< carrier of the watched object: "", "surface", "robot", "both", "human"
  std::string object;   ///< id of the watched object
  Pose T_world_object{Pose::Identity()};  ///< its frame in the world
  std::string hold;          ///< what the robot holds it by: "", "contact", "constraint"
  double held_time{};        ///< how long the robot has held it so far [s]
  double constraint_time{};  ///< part of `held_time` by the grasp constraint [s]
  double lifted{};           ///< height above where it started [m]
  double max_lifted{};       ///< while carried by the robot [m]
  /// How long the person's hand touched the object before the release [s].
  double human_contact_before_release{};
  double human_alone{};  ///< how long the person alone has carried it [s]
  bool dropped{};        ///< touched floor or fell
  bool handover_done{};  ///< lifted >= 0.10, contact >= 0.2, alone >= 1
  /// Times the watched object changed hands: a give and a receive count one each.
  std::uint64_t handovers{};
  bool taken{};                   ///< a person has taken the object from the robot's hand
  Side taking_side{Side::right};  ///< the hand that took it last; valid if `taken`
  /// Min fraction of its ranges that the wrist of that hand used at the release, [0, 1].
  double taking_wrist_strain{};
  double taking_arm_strain{};  ///< fraction of its range that the upper arm used then, [0, 1]
  /// Robot to any person [m]; exempt: the exchanging forearm and hand while engaged.
  double separation{};
  double min_separation{};  ///< smallest `separation` so far [m]; infinity: no person was present
  double min_robot_distance{};  ///< smallest distance to other robots [m]; infinity: no other robot
  std::uint64_t ssm_violations{};  ///< steps with a higher speed toward a person than SSM allows
  double peak_closing_speed{};     ///< of robot and person within 0.5 m [m/s]
  double contact_force{};          ///< largest robot-person contact force so far [N]
  /// Largest |.| of the received set-points so far / limit.
  double limit_ratio_velocity{}, limit_ratio_acceleration{}, limit_ratio_jerk{};
  std::uint64_t limit_violations{};          ///< set-points beyond the guard limits so far
  std::uint64_t self_or_scene_collisions{};  ///< steps with an unintended robot contact
  std::uint64_t commanders{};                ///< distinct writers of JointCommand seen
  double setpoint_gap_max{};      ///< longest time without a set-point since the first [s]
  std::uint64_t set_points{};     ///< set-points received so far
  bool robot_moving{};            ///< any arm axis faster than 1e-3 rad/s
  std::uint64_t hash{};           ///< running hash of the physical state: equal seeds, equal hashes
  std::vector<BodyJoint> person;  ///< true body of the nearest person
};

}  // namespace handsel
