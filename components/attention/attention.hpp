// The attentional system: behaviours on their own clocks, the least speed factor wins, the most
// active one leads the gaze. Chapter abstract, sections 1 and 2.1. Own method: the chapter's
// section on attention is missing (formulas: section 4). Pure: no clock, no I/O.
#pragma once

#include <memory>
#include <vector>

#include "components/attention/adaptive_clock.hpp"
#include "components/attention/releaser.hpp"
#include "components/attention/schema.hpp"

namespace handsel::attention {

/// One behaviour as configured.
struct BehaviourSettings {
  Behaviour behaviour{};                ///< its kind
  ClockSettings clock;                  ///< period of the perception
  std::string name{};                   ///< empty: that of the kind
  std::vector<Condition> conditions{};  ///< of its releaser, beside those of its kind
  WatchSettings watch{};                ///< where the kind is watch
};

/// Work that others do as often as attention wants.
enum class Work {
  people,    ///< what they do, in facts
  objects,   ///< where they are and who has them, in the scene
  forecast,  ///< of the running trajectory
  cost_map,
  replan,  ///< a better path for the running motion
};
inline constexpr const char* kWorkNames[] = {"people", "objects", "forecast", "cost_map", "replan"};

/// A period between p_min and p_max, as urgent as the most urgent of the behaviours it serves:
/// p_min + (p_max - p_min) times the smallest fraction of its range by which one of their clocks is
/// above its own p_min. Before a behaviour has observed, p_min.
struct WorkSettings {
  Work work{};                      ///< the work that is paced
  double p_min{}, p_max{};          ///< [s] 0 < p_min <= p_max
  double period{};                  ///< > 0: always this [s]
  std::vector<std::string> serves;  ///< behaviours, at least one
};

struct AttentionSettings {
  bool off{};              ///< no behaviour observes or asks for anything
  double tick{0.01};       ///< period of step() [s]; clocks are rounded
  double gaze_dwell{0.5};  ///< gaze stays at least this long [s]
  /// Another behaviour takes the gaze only with a period below this times that of the present one.
  double gaze_advantage{0.8};
  /// Gain on the human-aware costs when AVOID is at its most urgent, >= 1.
  double near_cost_gain{2.0};
  ZoneSettings zones;                         ///< of TRACK and AVOID
  MotorSettings motor;                        ///< of all behaviours
  std::vector<BehaviourSettings> behaviours;  ///< at least one; each name at most once
  std::vector<WorkSettings> works;            ///< each at most once; other work sets its own period
};

class Attention {
 public:
  /// `body` must live as long. Throws ConfigError naming the behaviour and the field.
  Attention(const AttentionSettings& settings, const Body& body);

  /// Runs the perception of every behaviour whose clock is due. Call every `tick`.
  void step(const World& world, TimePoint now);
  AttentionAdvice advice() const;  ///< as of the last step
  AttentionState state() const;    ///< as of the last step

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

  AttentionSettings settings_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> order_;  // in which releasers are evaluated
  TimePoint now_{}, gaze_since_{};
  int gaze_{-1};
};

}  // namespace handsel::attention
