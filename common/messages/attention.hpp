// The attentional system's state and advice (chapter abstract, sections 1 and 2.1; the behaviour model is ours).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

namespace handsel {

enum class Behaviour : std::uint8_t { search, track, avoid, pick, place, give, receive, watch };
const char* name(Behaviour);

/// What attention wants of the task that runs.
enum class TaskChange : std::uint8_t {
  none,
  suspend,
  resume,
  abort,
  give,  ///< hand what is held to `person`: they reach for it
};
const char* name(TaskChange);

struct BehaviourState {
  std::string name;                        ///< as described in the settings
  Behaviour behaviour{};                   ///< its kind
  double period{};                         ///< of its clock now [s]
  std::uint64_t activations{};             ///< of its perceptual schema since start
  std::uint64_t activations_at_fastest{};  ///< had the clock always run at its shortest period
  bool released{};
  double stimulus{};         ///< what it watches, SI
  double speed_factor{1.0};  ///< what it asks for, [-1, 1]
  bool winner{};             ///< decides the speed or the gaze now
  std::string reason;        ///< of its speed factor, one phrase for people
};

/// Topic AttentionState, profile state, 10 Hz.
struct AttentionState {
  Stamp stamp{};
  std::vector<BehaviourState> behaviours;
};

/// Topic AttentionAdvice, profile advice, 50 Hz.
struct AttentionAdvice {
  Stamp stamp{};
  double speed_factor{1.0};  ///< minimum over the released behaviours, [-1, 1]
  std::string limiting;      ///< name of the behaviour that asked for it; empty: none
  std::string reason;        ///< one phrase for people
  bool has_gaze_target{};
  Vector3 gaze_target{Vector3::Zero()};  ///< world [m]
  bool has_target_shift{};
  Vector3 target_shift{Vector3::Zero()};  ///< of the exchange point, world [m]
  double cost_gain{1.0};                  ///< on the human-aware costs
  double people_period{};                 ///< how often interpretation of people is wanted [s]; 0 = as it comes, here and below
  double objects_period{};                ///< the same of things [s]
  double forecast_period{};               ///< how often the forecast of the running trajectory is wanted [s]
  double cost_map_period{};               ///< how often the cost map is wanted [s]
  double replan_period{};                 ///< how often a better path for the running motion is wanted [s]
  TaskChange change{};                    ///< of the task that runs
  std::string person;                     ///< whom the change is about; empty: nobody
};

}  // namespace handsel
