// SPDX-License-Identifier: Apache-2.0
// Listens to a running system and keeps the newest sample of everything a person asks about, and
// what changed when.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/system.hpp"
#include "common/messages/task.hpp"

namespace handsel {

/// The newest sample of a topic, and when it came (clock of the bus).
template <class M>
struct Seen {
  bool ever{false};     ///< false: no sample has come, and the rest is empty
  M sample{};           ///< the newest
  TimePoint arrival{};  ///< of `sample`
};

struct Snapshot {
  std::map<std::string, Seen<ComponentHealth>> health;  ///< by component
  std::map<std::uint64_t, TaskStatus> tasks;            ///< by task id
  Seen<TaskStatus> task;                                ///< newest of any id
  Seen<ActionStatus> action;                            ///< of the manipulation planner
  std::string partner;                ///< the person the newest action that concerned one was about
  Seen<ExecutionStatus> execution;    ///< of the trajectory controller
  Seen<SafetyState> safety;           ///< of the supervisor
  Seen<AttentionAdvice> advice;       ///< speed factor and gaze that attention advises
  Seen<AttentionState> attention;     ///< behaviours and their clocks
  Seen<TrajectoryForecast> forecast;  ///< of the running trajectory
  Seen<ActiveTrajectory> active;      ///< without the trajectory itself
  Seen<GroundTruth> ground_truth;     ///< of the simulator; never seen on a real robot
};

/// A change worth reporting, e.g. "mode hold".
struct TimelineEvent {
  TimePoint at{};    ///< when it happened, clock of the bus
  std::string text;  ///< one phrase for people
};

/// Names of the causes whose bits are set, comma separated.
std::string cause_names(std::uint32_t causes);

/// Lives on the executor thread of its bus, as everything on a bus does; on DdsBus that is the
/// thread inside run_until().
class Observer {
 public:
  /// Subscribes; must outlive the deliveries of the bus.
  explicit Observer(Bus& bus);
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;

  /// Returns the newest samples; changes when the bus delivers.
  const Snapshot& snapshot() const { return snapshot_; }
  /// Called after every sample, with the time it came.
  void on_sample(std::function<void(const Snapshot&, TimePoint)> callback) {
    on_sample_ = std::move(callback);
  }
  /// Called with every event of the timeline as it happens.
  void on_event(std::function<void(const TimelineEvent&)> callback) {
    on_event_ = std::move(callback);
  }
  /// Adds an event of the listener's own, e.g. what a story did.
  void note(TimePoint at, const std::string& text);
  /// In order of time, at most 20 000.
  const std::vector<TimelineEvent>& timeline() const { return timeline_; }

 private:
  template <class M, class Store>
  void watch(Bus& bus, Store store);
  void watch_health(Bus& bus);
  void watch_tasks(Bus& bus);
  void watch_execution(Bus& bus);
  void watch_advice(Bus& bus);
  void watch_trajectories(Bus& bus);
  void watch_ground_truth(Bus& bus);

  Snapshot snapshot_;
  std::vector<TimelineEvent> timeline_;
  std::function<void(const Snapshot&, TimePoint)> on_sample_;
  std::function<void(const TimelineEvent&)> on_event_;
};

}  // namespace handsel
