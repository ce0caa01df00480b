// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/observer.hpp"

#include "common/messages/names.hpp"

namespace handsel {
namespace {

constexpr std::size_t kMaxTimeline = 20000;
constexpr std::size_t kMaxTasks = 4096, kMaxComponents = 64;

std::string with_reason(const std::string& text, const std::string& reason) {
  return reason.empty() ? text : text + ": " + reason;
}

template <class M>
void keep_newest(Seen<M>& seen, const M& sample, TimePoint at) {
  seen.ever = true;
  seen.sample = sample;
  seen.arrival = at;
}

}  // namespace

std::string cause_names(std::uint32_t causes) {
  std::string names;
  for (std::size_t value = 1; value < std::size(kCauseNames); ++value) {
    if (causes & (1u << value))
      names += (names.empty() ? "" : ", ") + std::string(name(static_cast<Cause>(value)));
  }
  return names;
}

template <class M, class Store>
void Observer::watch(Bus& bus, Store store) {
  bus.subscribe<M>([this, store](const M& sample, const Receipt& receipt) {
    store(sample, receipt.arrival);
    if (on_sample_) on_sample_(snapshot_, receipt.arrival);
  });
}

Observer::Observer(Bus& bus) {
  watch_health(bus);
  watch_tasks(bus);
  watch_execution(bus);
  watch_advice(bus);
  watch_trajectories(bus);
  watch_ground_truth(bus);
}

void Observer::watch_health(Bus& bus) {
  watch<ComponentHealth>(bus, [this](const ComponentHealth& health, TimePoint at) {
    if (snapshot_.health.size() >= kMaxComponents && !snapshot_.health.contains(health.component))
      return;
    auto& seen = snapshot_.health[health.component];
    const bool is_new = !seen.ever || seen.sample.incarnation != health.incarnation;
    if (is_new || seen.sample.state != health.state || seen.sample.reason != health.reason) {
      note(at,
           with_reason(
               health.component + " " +
                   (is_new && seen.ever && health.state != HealthState::stopping ? "back, " : "") +
                   name(health.state),
               health.reason));
    }
    keep_newest(seen, health, at);
  });
}

void Observer::watch_tasks(Bus& bus) {
  watch<TaskStatus>(bus, [this](const TaskStatus& task, TimePoint at) {
    const auto& seen = snapshot_.task;
    if (!seen.ever || seen.sample.id != task.id || seen.sample.state != task.state ||
        seen.sample.step != task.step) {
      const std::string step = task.step < task.plan.size() ? ", step " + task.plan[task.step] : "";
      note(at, with_reason("task " + std::string(name(task.state)) + step, task.reason));
    }
    snapshot_.tasks[task.id] = task;
    if (snapshot_.tasks.size() > kMaxTasks) snapshot_.tasks.erase(snapshot_.tasks.begin());
    keep_newest(snapshot_.task, task, at);
  });
  watch<ActionStatus>(bus, [this](const ActionStatus& action, TimePoint at) {
    const auto& seen = snapshot_.action;
    if (!seen.ever || seen.sample.id != action.id || seen.sample.phase != action.phase ||
        seen.sample.state != action.state) {
      const std::string phase = action.phase == ActionPhase::none ? "" : " " + phase_text(action);
      if (action.state != ActionState::idle)
        note(at, with_reason("action " + std::string(name(action.kind)) + phase, action.reason));
    }
    if (!action.human.empty()) snapshot_.partner = action.human;
    keep_newest(snapshot_.action, action, at);
  });
}

void Observer::watch_execution(Bus& bus) {
  watch<ExecutionStatus>(bus, [this](const ExecutionStatus& execution, TimePoint at) {
    const auto& seen = snapshot_.execution;
    if (!seen.ever || seen.sample.mode != execution.mode ||
        seen.sample.causes != execution.causes) {
      const std::string causes = cause_names(execution.causes);
      note(at, "mode " + std::string(name(execution.mode)) +
                   (causes.empty() ? "" : " (" + causes + ")"));
    }
    const auto note_hand = [&](const std::string& hand, HandState was, HandState is) {
      if (seen.ever && was != is) note(at, hand + " " + name(is));
    };
    note_hand("hand", seen.sample.hand, execution.hand);
    for (std::size_t i = 0; i < execution.other_hands.size(); ++i) {
      const auto& before = seen.sample.other_hands;
      const OtherHandState& other = execution.other_hands[i];
      if (i < before.size()) note_hand(other.group, before[i].hand, other.hand);
    }
    keep_newest(snapshot_.execution, execution, at);
  });
  watch<SafetyState>(bus, [this](const SafetyState& safety, TimePoint at) {
    const auto& seen = snapshot_.safety;
    if (!seen.ever || seen.sample.reason != safety.reason)
      if (seen.ever || !safety.reason.empty())
        note(at, safety.reason.empty() ? "released by a person" : "held: " + safety.reason);
    keep_newest(snapshot_.safety, safety, at);
  });
}

void Observer::watch_advice(Bus& bus) {
  watch<AttentionAdvice>(bus, [this](const AttentionAdvice& advice, TimePoint at) {
    keep_newest(snapshot_.advice, advice, at);
  });
  watch<AttentionState>(bus, [this](const AttentionState& state, TimePoint at) {
    keep_newest(snapshot_.attention, state, at);
  });
}

void Observer::watch_trajectories(Bus& bus) {
  watch<TrajectoryForecast>(bus, [this](const TrajectoryForecast& forecast, TimePoint at) {
    keep_newest(snapshot_.forecast, forecast, at);
  });
  watch<ActiveTrajectory>(bus, [this](const ActiveTrajectory& active, TimePoint at) {
    snapshot_.active.ever = true;
    snapshot_.active.arrival = at;
    snapshot_.active.sample.trajectory = active.trajectory;
    snapshot_.active.sample.time = active.time;
    snapshot_.active.sample.speed_factor = active.speed_factor;
  });
}

void Observer::watch_ground_truth(Bus& bus) {
  watch<GroundTruth>(bus, [this](const GroundTruth& ground_truth, TimePoint at) {
    const auto& seen = snapshot_.ground_truth;
    if (!seen.ever || seen.sample.carrier != ground_truth.carrier)
      note(at, ground_truth.object + " carried by " +
                   (ground_truth.carrier.empty() ? "nobody" : ground_truth.carrier));
    if (ground_truth.hold == "constraint" && !(seen.ever && seen.sample.hold == ground_truth.hold))
      note(at, ground_truth.object + " held by the grasp constraint more than by contact");
    if (ground_truth.handover_done && !(seen.ever && seen.sample.handover_done))
      note(at, "handover done");
    if (ground_truth.dropped && !(seen.ever && seen.sample.dropped))
      note(at, ground_truth.object + " dropped");
    if (ground_truth.limit_violations && !(seen.ever && seen.sample.limit_violations))
      note(at, "a set-point broke a limit");
    keep_newest(snapshot_.ground_truth, ground_truth, at);
  });
}

void Observer::note(TimePoint at, const std::string& text) {
  if (timeline_.size() >= kMaxTimeline) return;
  timeline_.push_back({at, text});
  if (on_event_) on_event_(timeline_.back());
}

}  // namespace handsel
