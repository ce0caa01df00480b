// SPDX-License-Identifier: Apache-2.0
// The attentional system: behaviours with adaptive clocks; the min speed factor applies, and the
// most active behaviour controls the gaze. Chapter abstract, sections 1 and 2.1. Own method: the
// chapter has no section on attention (formulas: section 4). Pure: no clock, no I/O.
#pragma once

#include <memory>
#include <vector>

#include "components/attention/adaptive_clock.hpp"
#include "components/attention/releaser.hpp"
#include "components/attention/schema.hpp"

namespace handsel::attention {

/// One behaviour as configured.
struct BehaviourSettings {
  Behaviour behaviour{};                ///< kind
  ClockSettings clock;                  ///< period of the perception
  std::string name{};                   ///< empty: name of the kind
  std::vector<Condition> conditions{};  ///< conditions of the releaser, besides those of the kind
  WatchSettings watch{};                ///< used by the kind watch
};

/// Work of other components whose period attention advises.
enum class Work {
  people,    ///< facts about people
  objects,   ///< poses and holders in the scene
  forecast,  ///< forecast of the running trajectory
  cost_map,
  replan,          ///< online replanning
  sensed_people,   ///< samples of people by the sensors
  sensed_objects,  ///< samples of all objects by the sensors
  sensed_region,   ///< samples of the action's object and of objects at the robot's hand
};
inline constexpr const char* kWorkNames[] = {"people",         "objects",      "forecast",
                                             "cost_map",       "replan",       "sensed_people",
                                             "sensed_objects", "sensed_region"};

/// The advised period of a work, by its most urgent behaviour: p_min + (p_max - p_min) * r, where r
/// is the min over the behaviours of (period - p_min) / (p_max - p_min) of their clocks; p_min
/// before the first observation.
struct WorkSettings {
  Work work{};                      ///< the work
  double p_min{}, p_max{};          ///< bounds of the period, 0 < p_min <= p_max [s]
  double period{};                  ///< > 0: constant period [s]
  std::vector<std::string> serves;  ///< behaviours, at least one
};

struct AttentionSettings {
  bool off{};              ///< no behaviour observes or acts; the advice is neutral (factor 1)
  double tick{0.01};       ///< period of step(), to which clocks are rounded [s]
  double gaze_dwell{0.5};  ///< min duration of a gaze target [s]
  /// Max ratio of periods at which another behaviour takes over the gaze.
  double gaze_advantage{0.8};
  /// Factor on the planner's human-aware costs (cost_gain) at the shortest period of AVOID, >= 1.
  double near_cost_gain{2.0};
  ZoneSettings zones;                         ///< zones of TRACK and AVOID
  MotorSettings motor;                        ///< motor parts of all behaviours
  std::vector<BehaviourSettings> behaviours;  ///< at least one; each name at most once
  std::vector<WorkSettings> works;  ///< each at most once; other works keep their own period
  /// Bound of the periods of sensed_people and sensed_objects, which the guard needs [s].
  double max_sensed_period{0.09};
  double region_size{0.3};  ///< half the edge of the region at the robot's hand [m]
};

class Attention {
 public:
  /// `body` must outlive this. Throws ConfigError that names behaviour and field.
  Attention(const AttentionSettings& settings, const Body& body);

  /// Runs the perception of all due behaviours; to be called every `tick`.
  void step(const World& world, TimePoint now);
  AttentionAdvice advice() const;  ///< Returns the advice as of the last step.
  AttentionState state() const;    ///< Returns the state as of the last step.
  /// Returns how often the sensors are to measure what, in the world of the last step.
  SensorRequest sensor_request(const World& world) const;

 private:
  struct Entry {
    std::string name;
    std::unique_ptr<Schema> schema;
    AdaptiveClock clock;
    ClockSettings settings;
    std::vector<Condition> conditions{};
    double stimulus{};
    bool released{};
  };
  void choose_gaze(TimePoint now);
  const Entry* find(const std::string& behaviour) const;
  bool conditions_met(const Entry& entry, const World& world) const;
  double period(const WorkSettings& work) const;
  /// Returns the period of a work; 0: not described.
  double period(Work work) const;

  AttentionSettings settings_;
  const Body& body_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> order_;  // order of evaluation of the releasers
  TimePoint now_{}, gaze_since_{};
  int gaze_{-1};
};

}  // namespace handsel::attention
