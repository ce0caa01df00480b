// Listens to a running system and remembers the newest of everything a person asks about, and what changed when.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
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
  bool ever{false};
  M sample{};
  TimePoint arrival{};
};

struct Snapshot {
  std::map<std::string, Seen<ComponentHealth>> health;  ///< by component
  std::map<std::uint64_t, TaskStatus> tasks;            ///< by task id
  Seen<TaskStatus> task;                                ///< newest of any id
  Seen<ActionStatus> action;
  Seen<ExecutionStatus> execution;
  Seen<AttentionAdvice> advice;
  Seen<AttentionState> attention;
  Seen<TrajectoryForecast> forecast;
  Seen<GroundTruth> truth;
};

/// A change worth telling, e.g. {"mode", "", "stop"}.
struct TimelineEvent {
  TimePoint at{};
  std::string text;
};

/// Names of the causes whose bits are set, comma separated.
std::string cause_names(std::uint32_t causes);

class Observer {
 public:
  /// Subscribes; the bus must outlive it and must not deliver after it is gone.
  explicit Observer(Bus& bus);

  /// Runs f(const Snapshot&) while nothing changes and returns its result.
  template <class F>
  auto read(F&& f) const {
    std::lock_guard lock(mutex_);
    return f(snapshot_);
  }
  /// Waits on real time until condition(const Snapshot&) holds; false when `limit` passed. Not for LocalBus.
  bool wait(Duration limit, const std::function<bool(const Snapshot&)>& condition) const;
  /// Called after every sample with the state and the time, on the executor thread, nothing changing meanwhile.
  void on_sample(std::function<void(const Snapshot&, TimePoint)> callback);
  /// Called with every event of the timeline as it happens, on the executor thread.
  void on_event(std::function<void(const TimelineEvent&)> callback);
  /// Adds an event of the listener's own, e.g. what a story did.
  void note(TimePoint at, const std::string& text);
  std::vector<TimelineEvent> timeline() const;

 private:
  template <class M, class Store>
  void watch(Bus& bus, Store store);
  void tell(TimePoint at, const std::string& text);

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  Snapshot snapshot_;
  std::vector<TimelineEvent> timeline_;
  std::function<void(const Snapshot&, TimePoint)> on_sample_;
  std::function<void(const TimelineEvent&)> on_event_;
};

}  // namespace handsel
