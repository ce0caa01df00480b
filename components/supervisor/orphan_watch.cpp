// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/orphan_watch.hpp"

namespace handsel::supervisor {
namespace {

constexpr std::size_t kMaxReported = 64;  // max number of stored tasks

}  // namespace

std::optional<TaskStatus> OrphanWatch::step(std::optional<std::uint64_t> id, TimePoint now) {
  if (!id || reported_.contains(*id)) {
    since_.reset();
    return std::nullopt;
  }
  if (!since_) since_ = now;
  if (to_seconds(now - *since_) < timeout_) return std::nullopt;
  reported_.insert(*id);
  if (reported_.size() > kMaxReported) reported_.erase(reported_.begin());
  TaskStatus status;
  status.id = *id;
  status.state = TaskState::failed;
  status.reason =
      "the supervisor was started anew while this task ran, and nobody asked for it again; its "
      "last action runs to its end";
  return status;
}

}  // namespace handsel::supervisor
