// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/safety/state_keeper.hpp"

namespace handsel::supervisor {

StateKeeper::StateKeeper(const settings::SupervisorSettings& settings, std::uint64_t stored)
    : lost_period_(settings.lost_period),
      store_retry_(settings.store_retry),
      safety_period_(settings.safety_period),
      stored_(stored) {}

void StateKeeper::on_stored(std::uint64_t revision) {
  storing_ = false;
  stored_ = revision;
  failed_at_.reset();
  failure_.clear();
}

void StateKeeper::on_store_failure(const std::string& reason, TimePoint now) {
  storing_ = false;
  failed_at_ = now;
  failure_ = reason;
}

StateOutput StateKeeper::step(TimePoint now, Stamp stamp, SafetyLatches& latches,
                              LostPeople& lost) {
  const auto due = [&](const std::optional<TimePoint>& last, double period) {
    return !last || to_seconds(now - *last) >= period;
  };
  StateOutput out;
  if (due(lost_noted_, lost_period_) && lost.changed(now)) {
    latches.set_lost(lost.people(now), stamp);
    lost_noted_ = now;
  }
  const std::uint64_t revision = latches.safety().revision;
  if (revision != stored_ && !storing_ && due(failed_at_, store_retry_)) {
    out.store = latches.state();
    storing_ = true;
  }
  if (revision == published_ && !due(safety_sent_, safety_period_)) return out;
  out.safety = latches.safety();
  out.safety->stamp = stamp;
  out.safety->lost = lost.people(now);
  published_ = revision;
  safety_sent_ = now;
  return out;
}

void StateKeeper::answer_when_stored(std::uint64_t revision, const TaskStatus& status) {
  answers_.push_back({revision, status});
}

void StateKeeper::take_answers(std::vector<TaskStatus>& out) {
  std::erase_if(answers_, [&](const Answer& answer) {
    const bool due = stored_ >= answer.revision || failed_at_.has_value();
    if (due) out.push_back(answer.status);
    return due;
  });
}

}  // namespace handsel::supervisor
