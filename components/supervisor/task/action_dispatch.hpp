// SPDX-License-Identifier: Apache-2.0
// Sends the actions of a task one at a time, each repeated until the planner reports it. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/messages/task.hpp"

namespace handsel::supervisor {

/// Assigns the id of each action, repeats its goal, and cancels it.
class ActionDispatch {
 public:
  enum class State { idle, running, stopping };

  /// `retry`: period after which a goal without an answer is sent again [s].
  explicit ActionDispatch(double retry) : retry_(retry) {}

  /// Returns the state of the last started action.
  State state() const { return state_; }
  /// Returns whether any action was begun.
  bool has_begun() const { return has_begun_; }
  /// Returns whether this is the status of the action that was begun last.
  bool reports(const std::optional<ActionStatus>& status) const {
    return status && status->id == id_;
  }
  /// Returns whether the last goal was sent long enough ago for another attempt.
  bool retry_due(TimePoint now) const { return to_seconds(now - sent_) >= retry_; }
  /// Returns why the action is being stopped, or was last stopped.
  const std::string& stop_reason() const { return stop_reason_; }

  /// Begins an action. Returns whether it runs already, so that nothing has to be sent: after a
  /// restart of this process the action may be running. `next_id`: last id used, counted up.
  bool begin(const ActionGoal& goal, const std::optional<ActionStatus>& running,
             std::uint64_t& next_id);
  /// Sends the goal of the action under its id.
  void send(ActionGoal goal, TimePoint now, std::vector<ActionGoal>& out);
  /// Cancels the action and waits for its end.
  void stop(const std::string& reason, TimePoint now, std::vector<ActionGoal>& out);
  /// Cancels the action without waiting for its end.
  void cancel(std::vector<ActionGoal>& out) const;
  /// Notes the end of the action. Returns whether it was being stopped.
  bool end();

 private:
  double retry_;
  State state_{State::idle};
  bool has_begun_{false};
  std::uint64_t id_{};
  TimePoint sent_{};
  std::string stop_reason_;
};

}  // namespace handsel::supervisor
