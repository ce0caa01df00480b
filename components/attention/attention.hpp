// The attentional system: behaviours on their own clocks, the least speed factor wins, the most active one leads the gaze.
// Chapter abstract, sections 1 and 2.1; the model is ours (formulas: section 4). Pure: no clock, no I/O.
#pragma once

#include <memory>
#include <vector>

#include "components/attention/adaptive_clock.hpp"
#include "components/attention/releaser.hpp"
#include "components/attention/schema.hpp"

namespace handsel::attention {

struct BehaviourSettings {
  Behaviour behaviour{};  ///< its kind
  ClockSettings clock;
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

/// A period between p_min and p_max, as urgent as the most urgent of the behaviours it serves: p_min + (p_max - p_min) times the least
/// share by which one of their clocks has left its own p_min. Ours.
struct WorkSettings {
  Work work{};
  double p_min{}, p_max{};          ///< [s] 0 < p_min <= p_max
  double period{};                  ///< > 0: always this [s]
  std::vector<std::string> serves;  ///< behaviours, at least one
};

struct AttentionSettings {
  bool off{};                  ///< looks at nothing and asks for nothing
  double tick{0.01};           ///< how often step() is called [s]; clocks are rounded to it
  double gaze_dwell{0.5};      ///< gaze stays with a behaviour at least this long [s]
  double gaze_advantage{0.8};  ///< another takes it only with a period below this share of the present one's
  double near_cost_gain{2.0};  ///< gain on the human-aware costs when AVOID is at its most urgent, >= 1
  ZoneSettings zones;
  MotorSettings motor;
  std::vector<BehaviourSettings> behaviours;  ///< at least one; each name at most once
  std::vector<WorkSettings> works;            ///< each at most once; the others are done as it comes
};

class Attention {
 public:
  /// `body` must live as long. Throws ConfigError naming the behaviour and the field.
  Attention(const AttentionSettings& settings, const Body& body);

  /// Lets every behaviour look whose clock is due. Call every `tick`.
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
  std::vector<std::size_t> order_;  // in which releasers are looked at
  TimePoint now_{}, gaze_since_{};
  int gaze_{-1};
};

}  // namespace handsel::attention
