// SPDX-License-Identifier: Apache-2.0
#include "sim/time_keeper.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::sim {
namespace {

constexpr std::int64_t kGrantsAhead = 2;  // clock periods granted in advance
// Delay of a step after which stopped processes are searched for.
constexpr Duration kMaxDelay = std::chrono::milliseconds(50);
// Period of the search for stopped processes.
constexpr Duration kCheckPeriod = std::chrono::milliseconds(10);
// Max time between two ticks that is attributed to the components rather than to the simulator.
constexpr Duration kMaxTickPeriod = std::chrono::milliseconds(10);

}  // namespace

TimeKeeper::TimeKeeper(const SimSettings& settings)
    : period_(from_seconds(settings.step)),
      clock_period_(from_seconds(settings.clock_period)),
      max_lag_(from_seconds(settings.max_lag)),
      max_wait_(from_seconds(settings.max_wait)),
      per_setpoint_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(
                                                   settings.robot_side.period / settings.step)))) {}

void TimeKeeper::answered(const std::string& component, std::uint64_t process,
                          std::uint64_t grant) {
  answers_[component] = {process, grant};
}

void TimeKeeper::leave_out_stopped(const std::function<bool(std::uint64_t process)>& runs) {
  if (blocked_ < std::max(kMaxDelay, checked_ + kCheckPeriod)) return;
  checked_ = blocked_;
  stop_waiting([&](const Answer& answer) { return !runs(answer.process); });
}

void TimeKeeper::turn(TimePoint wall) {
  if (!started_) {
    started_ = true;
    start_ = wall;
    grant_ = 1;
  } else {
    blocked_ += std::min(wall - wall_, kMaxTickPeriod);
  }
  wall_ = wall;
  if (const Duration lag = wall - waited_ - time(); lag > max_lag_) waited_ += lag - max_lag_;
}

bool TimeKeeper::all_answered() const {
  return std::all_of(answers_.begin(), answers_.end(),
                     [&](const auto& answer) { return answer.second.grant >= grant_; });
}

void TimeKeeper::stop_waiting(const std::function<bool(const Answer&)>& selected) {
  if (std::erase_if(answers_, [&](const auto& answer) { return selected(answer.second); }) > 0)
    setpoints_flow_ = false;
}

bool TimeKeeper::may_step(bool has_setpoint) {
  if (wall_ - waited_ < time()) {
    blocked_ = checked_ = Duration::zero();
    return false;
  }
  if (blocked_ > max_wait_) {
    setpoints_flow_ = false;
    stop_waiting([&](const Answer& answer) { return answer.grant < grant_; });
  }
  if (takes_setpoint()) setpoints_flow_ = setpoints_flow_ || has_setpoint;
  const bool at_boundary = time() >= start_ + clock_period_ * static_cast<std::int64_t>(grant_);
  if ((takes_setpoint() && setpoints_flow_ && !has_setpoint) || (at_boundary && !all_answered()))
    return false;
  if (at_boundary) ++grant_;
  blocked_ = checked_ = Duration::zero();
  return true;
}

void TimeKeeper::stepped() { ++steps_; }

TimeGrant TimeKeeper::grant() const {
  return {.incarnation = 0,
          .until = start_ + clock_period_ * (static_cast<std::int64_t>(grant_) - 1 + kGrantsAhead),
          .waited = waited_};
}

}  // namespace handsel::sim
