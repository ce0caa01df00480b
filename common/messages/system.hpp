// Health of the processes, control of the simulator, and the truth only tests may see.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "common/messages/world.hpp"

namespace handsel {

enum class HealthState : std::uint8_t { starting, ok, degraded, stopping };

struct TopicHealth {
  std::string topic;
  std::uint64_t received{};  ///< samples accepted since start
  double rate{};             ///< [Hz]
  double age{};              ///< since the last one [s]; negative: never seen
  std::uint64_t deadline_misses{};
  std::uint64_t rejected{};
  std::string last_rejection;   ///< one sentence
  std::uint64_t refused{};      ///< samples of another writer than the accepted one, on a topic with one writer
  std::string second_writer{};  ///< identity of that other writer (process, host), while it is there; else empty
};

/// How often something was left out or dropped, by cause.
struct NamedCount {
  std::string name;  ///< what and why, e.g. "people: farther than the nearest 16"
  std::uint64_t count{};
};

/// Topic ComponentHealth, profile health, 10 Hz, keyed by component.
struct ComponentHealth {
  Stamp stamp{};
  std::string component;
  std::uint64_t incarnation{};  ///< random per process start
  std::uint32_t pid{};
  HealthState state{HealthState::starting};
  std::string reason;  ///< of degradation
  bool job_silent{};   ///< a job in the background has given no sign of life for two seconds
  double cpu{};        ///< share of one core
  double memory_mb{};
  double uptime{};  ///< [s]
  std::vector<TopicHealth> topics;
  std::vector<NamedCount> left_out{};  ///< what quotas have left out since start
};

/// Latches that outlive every process: what a person, a fault or a stop has decided. Topic SafetyState, profile latch, from the supervisor,
/// which keeps it on disk.
struct SafetyState {
  Stamp stamp{};
  std::uint64_t revision{};     ///< grows with every change, also over restarts; 0: never valid
  bool paused{};                ///< a person paused the robot
  double override_factor{1.0};  ///< speed override a person asked for, [0, 1]
  bool fault{};                 ///< a fault nobody has acknowledged
  bool awaits_person{};         ///< a protective, user or emergency stop after which nobody has resumed
  std::string reason;           ///< why it does not permit motion, one sentence; empty: it does
  std::vector<Person> lost{};   ///< people lost from sight and not seen to be gone, as they were last known; `age` counts from `stamp`
};

/// The simulator gives the pace. Time of the system is CLOCK_MONOTONIC of the simulator's machine less `waited`, and stands still at
/// `granted_until`. Topic SimClock, profile advice, 100 Hz.
struct SimClock {
  Stamp stamp{};
  std::uint64_t incarnation{};  ///< of the simulator
  std::uint64_t sequence{};     ///< grows by one with each grant; the same one again while the simulator waits
  double granted_until{};       ///< no component's time passes this instant [s], [0, 1e9]
  double waited{};              ///< for how long time has stood still since the simulator started [s], [0, 1e9]
};

/// A process has received a grant of SimClock, and handled what came before it. Topic ClockReached, profile advice, keyed by component.
struct ClockReached {
  Stamp stamp{};
  std::string component;
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
  human_frozen,     ///< the source repeats its last picture for `value` seconds, with new stamps
  human_empty,      ///< the source repeats an empty picture for `value` seconds
  human_late,       ///< the source is late by `value` seconds until restored
  human_elsewhere,  ///< the source looks elsewhere for `value` seconds
  emergency_stop    ///< the red button
};

/// Topic SimControl, profile command: disturbances and control of the simulator.
struct SimControl {
  Stamp stamp{};
  SimAction action{};
  std::string subject;  ///< person or source
  double value{};       ///< dart: speed [m/s]; silence: duration [s]
};

/// A note of whoever runs a study, for the record; nothing in the system heeds it. Topic StudyMark, profile goal, on demand.
struct StudyMark {
  Stamp stamp{};
  std::string condition;    ///< of the study; empty: none
  std::string participant;  ///< pseudonym; empty: none
  std::uint64_t trial{};    ///< number in the order in which trials are done, from 1; 0: none
  std::string text;         ///< the mark, e.g. "begin"
};

/// The simulator's own truth, for tests and reports only. Topic GroundTruth, profile state, 50 Hz.
struct GroundTruth {
  Stamp stamp{};
  double sim_time{};  ///< [s]
  double real_time_factor{};
  std::string carrier;  ///< who carries the watched object: "", "surface", "robot", "both", "human"
  std::string object;
  Pose T_world_object{Pose::Identity()};
  std::string hold;                       ///< what the robot holds it by: "", "contact", "constraint"
  double held_time{};                     ///< how long the robot has held it so far [s]
  double constraint_time{};               ///< of that, how long the constraint did [s]
  double lifted{};                        ///< height above where it started [m]
  double max_lifted{};                    ///< while carried by the robot [m]
  double human_contact_before_release{};  ///< how long the person's hand touched the object before the robot let go [s]
  double human_alone{};                   ///< how long the person alone has carried it [s]
  bool dropped{};                         ///< touched floor or fell
  bool handover_done{};                   ///< lifted >= 0.10, contact >= 0.2, alone >= 1
  double separation{};                    ///< robot to any person, exchanging forearm and hand excepted while engaged [m]
  double least_separation{};
  std::uint64_t ssm_violations{};  ///< steps in which the speed toward a person was above what the rule allows
  double peak_closing_speed{};     ///< within 0.5 m [m/s]
  double contact_force{};          ///< largest robot-person contact force so far [N]
  double limit_share_velocity{}, limit_share_acceleration{}, limit_share_jerk{};  ///< of received set-points, largest so far
  std::uint64_t limit_violations{};
  std::uint64_t self_or_scene_collisions{};  ///< steps with an unintended robot contact
  std::uint64_t commanders{};                ///< distinct writers of JointCommand seen
  double setpoint_gap_max{};                 ///< longest time without a set-point since the first [s]
  std::uint64_t set_points{};                ///< received so far
  bool robot_moving{};                       ///< any arm axis faster than 1e-3 rad/s
  std::uint64_t hash{};                      ///< running hash of the physical state: equal seeds, equal hashes
  std::vector<BodyJoint> person;             ///< true body of the nearest person
};

}  // namespace handsel
