// SPDX-License-Identifier: Apache-2.0
// Decides when the durable state is stored and published, and when a person is answered. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/supervisor.hpp"
#include "common/messages/task.hpp"
#include "components/supervisor/safety/lost_people.hpp"
#include "components/supervisor/safety/safety_latches.hpp"

namespace handsel::supervisor {

/// Requests of the keeper in one cycle.
struct StateOutput {
  std::optional<DurableState> store;  ///< to be stored; the next follows only after the answer
  std::optional<SafetyState> safety;  ///< to be published; ages count from now
};

/// Stores and publishes changes of the latches, and delays answers to people until the relevant
/// state is stored.
class StateKeeper {
 public:
  /// `stored`: stored revision at the start.
  StateKeeper(const settings::SupervisorSettings& settings, std::uint64_t stored);

  /// Notes that the state of this revision has been stored.
  void on_stored(std::uint64_t revision);
  /// Notes that the state could not be stored; `reason` names the file, one sentence.
  void on_store_failure(const std::string& reason, TimePoint now);
  /// Returns whether this revision, or a later one, is stored.
  bool is_stored(std::uint64_t revision) const { return stored_ >= revision; }
  /// Returns why the state cannot be stored, one sentence; empty: the last attempt succeeded.
  const std::string& store_failure() const { return failure_; }

  /// Adds the lost people to the latches, then returns the states to store and publish. `stamp`:
  /// system clock, the reference of stored ages.
  StateOutput step(TimePoint now, Stamp stamp, SafetyLatches& latches, LostPeople& lost);

  /// Delays an answer to a person until the revision is stored or a store has failed; it is sent
  /// unchanged in both cases.
  void answer_when_stored(std::uint64_t revision, const TaskStatus& status);
  /// Moves the due answers to the end of `out`, in order.
  void take_answers(std::vector<TaskStatus>& out);

 private:
  struct Answer {
    std::uint64_t revision{};
    TaskStatus status;
  };

  double lost_period_, store_retry_, safety_period_;  // [s]
  std::uint64_t stored_, published_{};                // revisions
  bool storing_{false};
  std::optional<TimePoint> lost_noted_, safety_sent_, failed_at_;
  std::string failure_;
  std::vector<Answer> answers_;
};

}  // namespace handsel::supervisor
