// SPDX-License-Identifier: Apache-2.0
// The attentional system's state and advice (chapter abstract, sections 1 and 2.1; the behaviour
// model is this project's own).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "common/messages/perception.hpp"

namespace handsel {

enum class Behaviour : std::uint8_t { search, track, avoid, pick, place, give, receive, watch };
/// Returns the word of kBehaviourNames; "unknown" for a value outside the enumeration.
const char* name(Behaviour);

/// Change of the running task that attention asks for.
enum class TaskChange : std::uint8_t {
  none,
  suspend,
  resume,
  abort,
  give,  ///< hand the held object to `person`, as that person reaches for it
};
/// Returns the word of kTaskChangeNames; "unknown" for a value outside the enumeration.
const char* name(TaskChange);

/// State of one behaviour of the attentional system.
struct BehaviourState {
  std::string name;                        ///< as described in the settings
  Behaviour behaviour{};                   ///< kind of its perceptual and motor schema
  double period{};                         ///< period of its adaptive clock now [s]
  std::uint64_t activations{};             ///< of its perceptual schema since start
  std::uint64_t activations_at_fastest{};  ///< had the clock always run at its shortest period
  bool released{};           ///< its releaser and the conditions of its description hold
  double stimulus{};         ///< perceived quantity that drives its clock, SI unit by kind
  double speed_factor{1.0};  ///< what it asks for, [-1, 1]
  bool winner{};             ///< decides the speed or the gaze now
  std::string reason;        ///< of its speed factor, one phrase for people
};

/// Topic AttentionState, profile state, 10 Hz.
struct AttentionState {
  Stamp stamp{};                           ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::vector<BehaviourState> behaviours;  ///< every behaviour of the settings, released or not
};

/// Topic AttentionAdvice, profile advice, 50 Hz.
struct AttentionAdvice {
  Stamp stamp{};             ///< time of sending, UTC [ns]; 0: filled in by the bus
  double speed_factor{1.0};  ///< minimum over the released behaviours, [-1, 1]
  /// A person closes in, and neither direction along the path leads away: retreat beside the path.
  bool leaves_path{};
  std::string limiting;                   ///< name of the behaviour that asked for it; empty: none
  std::string reason;                     ///< one phrase for people
  bool has_gaze_target{};                 ///< false: `gaze_target` has no meaning
  Vector3 gaze_target{Vector3::Zero()};   ///< world [m]
  bool has_target_shift{};                ///< false: `target_shift` has no meaning
  Vector3 target_shift{Vector3::Zero()};  ///< of the handover point, world [m]
  double cost_gain{1.0};                  ///< factor on the human-aware costs
  /// Wanted period of the interpretation of people [s]; 0: the fastest, here and below.
  double people_period{};
  double objects_period{};   ///< wanted period of the interpretation of objects [s]
  double forecast_period{};  ///< wanted period of the forecast of the running trajectory [s]
  double cost_map_period{};  ///< wanted period of the cost map [s]
  double replan_period{};    ///< wanted period of the search for a better path [s]
  TaskChange change{};       ///< change wanted of the running task
  std::string person;        ///< id of the person the change concerns; empty: none
};

/// Topic SensorRequest, profile advice, 10 Hz, keyed by source: how often sources measure what. A
/// source returns to its own rate when requests stop, and never goes below the rate that the guard
/// needs.
struct SensorRequest {
  Stamp stamp{};          ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::string source;     ///< source that is asked; empty: every source
  double people_rate{};   ///< samples of people [Hz]; 0: own rate of the source
  bool hands{};           ///< false: knuckles may be left out
  double objects_rate{};  ///< samples of all objects [Hz]; 0: own rate of the source
  /// Samples of `objects` and of what is in `region` [Hz]; 0: those of all objects suffice.
  double region_rate{};
  Coverage region;                   ///< world [m]; equal corners: no region
  std::vector<std::string> objects;  ///< ids, at most 16
};

}  // namespace handsel
