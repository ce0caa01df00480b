// SPDX-License-Identifier: Apache-2.0
// What a trial is evaluated by beside success: safety, reaction time, amount of work (formulas:
// section 4). Own method: the definitions of these measures.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/bus/local_bus.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/system.hpp"

namespace handsel {

/// Observes the network passively, from construction on. The simulator's ground truth decides;
/// nothing in the system receives a result.
class Criteria {
 public:
  Criteria(Bus& bus, LocalNetwork& network);
  Criteria(const Criteria&) = delete;
  Criteria& operator=(const Criteria&) = delete;

  /// Returns the fields of the trial's line:
  /// - `reactions_s`: after a person came nearer than 0.40 m to a moving arm, themselves moving
  ///   toward it (> 0.1 m/s): time until the speed factor had fallen by a tenth of its maximum in
  ///   the half second before, or, when it is lowered for people already, of its value without them
  ///   [s]
  /// - `reaction_p50_s`, `reaction_p99_s` of these; `late_reactions`: those above 0.2 s
  /// - `interventions`: times the guard began to limit the speed of a running motion because of the
  ///   separation
  /// - `intervention_s`: for how long the guard limited; `below_separation_s`: for how long a
  ///   moving arm was nearer than speed and separation monitoring (ISO 10218-2:2025) requires at
  ///   its speed
  /// - `closing_speed_m_s`: the fastest rate at which the minimum separation shrank within 0.5 m,
  ///   over 20 ms
  /// - `robot_idle_s`, `person_idle_s`, `concurrent_s`: no axis moved, no person moved, both moved
  /// - `functional_delay_s`: neither of them moved: each waited for the other
  /// - `discomfort`: of the person's arm at the object when it last begins to change hands, [0, 1]
  ///   (arm_comfort_cost); null: it did not
  /// - `legibility`: straight distance of the object that the robot carried to a person over the
  ///   length of its path, (0, 1]; null: it carried nothing there
  /// - `nearest_angle_rad`: level angle between the front of the person and the robot's nearest
  ///   point at the min separation while the robot moved: 0 in front, pi behind; null: it did not
  /// - `unseen_approach_s`: for how long the robot, nearer than 2 m, came nearer to a person from
  ///   behind (by the angle above more than 90 degrees)
  /// - `max_tilt_rad`: largest angle between up and the z axis of the object while the robot alone
  ///   carried it; null: it carried nothing
  /// - `cpu_s`: of each component's handlers and jobs, thread CPU time; `cpu_chain_s`: of
  ///   perception and planning
  /// - `runs`: how often each piece of work was done; `work_period_s`: mean period that was
  /// advised,
  ///   or requested of the sensors
  /// - `sensor_samples`: samples of people and objects; `sensor_values`: joints and objects in them
  nlohmann::json fields() const;

 private:
  void on(const GroundTruth& ground_truth, TimePoint now);
  void on(const ExecutionStatus& status, TimePoint now);
  struct SpeedSample {
    TimePoint at{};
    double speed_factor{};
  };
  struct Reaction {
    TimePoint since{};
    double before{};  // speed factor
  };
  void settle(TimePoint now);
  void watch_handover(const GroundTruth& ground_truth);
  void watch_passing(const GroundTruth& ground_truth);

  LocalNetwork& network_;
  double speed_factor_{};
  std::vector<SpeedSample> speed_samples_;  // the last half second
  std::optional<Reaction> waiting_;
  std::vector<double> reactions_;
  std::optional<GroundTruth> last_;
  ExecutionStatus status_;
  bool running_{}, limited_{};
  std::uint64_t interventions_{}, advices_{};
  double closing_speed_{}, limited_for_{}, below_for_{}, robot_idle_{}, person_idle_{},
      concurrent_{}, both_idle_{};
  std::optional<Vector3> carried_from_;  // where the robot alone began to carry it
  double carried_{};                     // distance moved since [m]
  std::optional<double> discomfort_, legibility_, max_tilt_;
  std::optional<double> nearest_;        // min separation while the robot moved [m]
  std::optional<double> nearest_angle_;  // at that separation [rad]
  double unseen_approach_{};             // [s]
  std::array<double, 5> rates_{};        // sums of advised rates [Hz]
  /// What the sensors delivered, and the sums of the rates requested of them.
  struct Sensing {
    std::uint64_t samples{}, values{}, requests{};
    std::array<double, 3> rates{};  // of people, objects, region [Hz]
  } sensing_;
};

}  // namespace handsel
