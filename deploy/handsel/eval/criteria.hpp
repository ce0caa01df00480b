// What a trial is judged by beside success: how safe, how quick to react, how much work (formulas: section 4; definitions ours).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/bus/local_bus.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/system.hpp"

namespace handsel {

/// Watches from a seat of the network, from construction on. The truth judges; nothing in the system hears of it.
class Criteria {
 public:
  Criteria(Bus& seat, LocalNetwork& network);
  Criteria(const Criteria&) = delete;
  Criteria& operator=(const Criteria&) = delete;

  /// Fields of the trial's line:
  /// - `reactions_s`: a person came nearer than 0.40 m to a moving arm, themselves moving toward it (> 0.1 m/s): time until the speed
  ///   factor had fallen by a tenth of what it had been at most in the half second before, or, when it is lowered for people already, of
  ///   what it would be without them [s]
  /// - `reaction_p50_s`, `reaction_p99_s` of these; `late_reactions`: those above 0.2 s
  /// - `interventions`: times the guard began to limit the speed of a running motion because of the separation
  /// - `intervention_s`: for how long the guard limited; `below_separation_s`: a moving arm was nearer than the separation rule asks for at
  /// its speed
  /// - `closing_speed_m_s`: the fastest by which the least separation shrank within 0.5 m, over 20 ms
  /// - `robot_idle_s`, `person_idle_s`, `concurrent_s`: neither axis nor person moved, both did
  /// - `functional_delay_s`: neither of them moved: each waited for the other
  /// - `discomfort`: of the person's arm at the object when it last begins to change hands, [0, 1] (arm_comfort_cost); null: it did not
  /// - `legibility`: the straight way of what the robot carried to a person over the way it took, (0, 1]; null: it carried nothing there
  /// - `cpu_s`: of each component's handlers and jobs, thread CPU time; `cpu_chain_s`: of perception and planning
  /// - `runs`: how often each piece of work was done; `work_period_s`: mean period that was advised
  nlohmann::json fields() const;

 private:
  void on(const GroundTruth& truth, TimePoint now);
  void on(const ExecutionStatus& status, TimePoint now);
  struct Look {
    TimePoint at{};
    double speed_factor{};
  };
  struct Reaction {
    TimePoint since{};
    double before{};  // speed factor
  };
  void settle(TimePoint now);
  void watch_exchange(const GroundTruth& truth);

  LocalNetwork& network_;
  double speed_factor_{};
  std::vector<Look> looks_;  // the last half second
  std::optional<Reaction> waiting_;
  std::vector<double> reactions_;
  std::optional<GroundTruth> last_;
  ExecutionStatus status_;
  bool running_{}, limited_{};
  std::uint64_t interventions_{}, advices_{};
  double closing_speed_{}, limited_for_{}, below_for_{}, robot_idle_{}, person_idle_{}, concurrent_{}, both_idle_{};
  std::optional<Vector3> carried_from_;  // where the robot alone began to carry it
  double carried_{};                     // the way since [m]
  std::optional<double> discomfort_, legibility_;
  std::array<double, 5> rates_{};  // sums of advised rates [Hz]
};

}  // namespace handsel
