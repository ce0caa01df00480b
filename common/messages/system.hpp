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
  std::string last_rejection;  ///< one sentence
};

/// Topic ComponentHealth, profile health, 10 Hz, keyed by component.
struct ComponentHealth {
  Stamp stamp{};
  std::string component;
  std::uint64_t incarnation{};  ///< random per process start
  std::uint32_t pid{};
  HealthState state{HealthState::starting};
  std::string reason;  ///< of degradation
  double cpu{};        ///< share of one core
  double memory_mb{};
  double uptime{};  ///< [s]
  std::vector<TopicHealth> topics;
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
  restore
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
