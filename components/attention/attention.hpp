// The attentional system: behaviours on their own clocks, the least speed factor wins, the most active one leads the gaze.
// Chapter abstract, sections 1 and 2.1; the model is ours (formulas: section 4). Pure: no clock, no I/O.
#pragma once

#include <memory>
#include <vector>

#include "components/attention/adaptive_clock.hpp"
#include "components/attention/schema.hpp"

namespace handsel::attention {

struct BehaviourSettings {
  Behaviour behaviour{};
  ClockSettings clock;
};

struct AttentionSettings {
  bool off{};                  ///< looks at nothing and asks for nothing
  double tick{0.01};           ///< how often step() is called [s]; clocks are rounded to it
  double gaze_dwell{0.5};      ///< gaze stays with a behaviour at least this long [s]
  double gaze_advantage{0.8};  ///< another takes it only with a period below this share of the present one's
  double near_cost_gain{2.0};  ///< gain on the human-aware costs when AVOID is at its most urgent, >= 1
  ZoneSettings zones;
  MotorSettings motor;
  std::vector<BehaviourSettings> behaviours;  ///< at least one; each behaviour at most once
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
    double stimulus{};
    bool released{};
  };
  void choose_gaze(TimePoint now);

  AttentionSettings settings_;
  std::vector<Entry> entries_;
  TimePoint now_{}, gaze_since_{};
  int gaze_{-1};
};

}  // namespace handsel::attention
