#include "sim/time_keeper.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::sim {
namespace {

constexpr std::int64_t kGrantsAhead = 2;
constexpr Duration kOwnTurn = std::chrono::milliseconds(10);  // between two turns, when the simulator gets its processor

}  // namespace

TimeKeeper::TimeKeeper(const SimSettings& settings)
    : period_(from_seconds(settings.step)),
      clock_period_(from_seconds(settings.clock_period)),
      max_lag_(from_seconds(settings.max_lag)),
      max_wait_(from_seconds(settings.max_wait)),
      per_setpoint_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(settings.robot_side.period / settings.step)))) {}

void TimeKeeper::answered(const std::string& component, std::uint64_t incarnation, std::uint64_t grant) {
  answers_[component] = {incarnation, grant};
}

void TimeKeeper::turn(TimePoint wall) {
  if (!started_) {
    started_ = true;
    start_ = wall;
    grant_ = 1;
  } else {
    blocked_ += std::min(wall - wall_, kOwnTurn);
  }
  wall_ = wall;
  if (const Duration lag = wall - waited_ - time(); lag > max_lag_) waited_ += lag - max_lag_;
}

bool TimeKeeper::everybody_answered() const {
  return std::all_of(answers_.begin(), answers_.end(), [&](const auto& answer) { return answer.second.grant >= grant_; });
}

/// Those that have not answered are waited for again once they do.
void TimeKeeper::stop_waiting() {
  setpoints_flow_ = false;
  std::erase_if(answers_, [&](const auto& answer) { return answer.second.grant < grant_; });
}

bool TimeKeeper::may_step(bool has_setpoint) {
  if (wall_ - waited_ < time()) {
    blocked_ = Duration::zero();
    return false;
  }
  if (blocked_ > max_wait_) stop_waiting();
  if (takes_setpoint()) setpoints_flow_ = setpoints_flow_ || has_setpoint;
  const bool at_boundary = time() >= start_ + clock_period_ * static_cast<std::int64_t>(grant_);
  if ((takes_setpoint() && setpoints_flow_ && !has_setpoint) || (at_boundary && !everybody_answered())) return false;
  if (at_boundary) ++grant_;
  blocked_ = Duration::zero();
  return true;
}

void TimeKeeper::stepped() { ++steps_; }

TimeGrant TimeKeeper::grant() const {
  return {.incarnation = 0, .until = start_ + clock_period_ * (static_cast<std::int64_t>(grant_) - 1 + kGrantsAhead), .waited = waited_};
}

}  // namespace handsel::sim
