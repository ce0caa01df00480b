// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/liveness.hpp"

#include <algorithm>

namespace handsel {
namespace {

Duration growth(Duration from, Duration to) { return std::max(Duration{}, to - from); }

}  // namespace

void Liveness::beat(TimePoint at, bool job_silent) {
  beaten_ = true;
  new_beat_ = at;
  job_silent_ = job_silent;
  if (!job_silent) job_since_.reset();
}

Life Liveness::assess(const LifeSigns& signs) {
  if (new_beat_) {
    last_ = signs;
    last_.now = *new_beat_;
    new_beat_.reset();
  }
  if (job_silent_ && !job_since_) job_since_ = signs;

  if (signs.state != 'T')
    stopped_since_.reset();
  else if (!stopped_since_)
    stopped_since_ = signs.now;
  const bool stopped = stopped_since_ && signs.now - *stopped_since_ >= settings_.hung_after;
  const bool kept =
      signs.state == 't' ||
      signs.state == 'D';  // killing a process held by a debugger or a device fails or is wrong
  const Duration silence = signs.now - last_.now;
  const Duration idle = silence - growth(last_.own_delay, signs.own_delay) -
                        growth(last_.main_delay, signs.main_delay);
  job_hung_ = beaten_ && job_since_ && !kept &&
              signs.now - job_since_->now - growth(job_since_->own_delay, signs.own_delay) -
                      growth(job_since_->total_delay, signs.total_delay) >
                  settings_.silent_job_after;
  const Duration timeout = beaten_ ? settings_.hung_after : settings_.start_timeout;
  if (stopped || job_hung_ || (idle > timeout && !kept && signs.state != 'T')) return Life::hung;
  if (!beaten_) return Life::starting;
  return silence > settings_.hung_after ? Life::starved : Life::alive;
}

Duration Backoff::after_life_of(Duration lived) {
  if (lived >= settings_.stable_after) next_ = settings_.first;
  const Duration wait = next_;
  next_ = std::min(2 * next_, settings_.max_wait);
  return wait;
}

}  // namespace handsel
