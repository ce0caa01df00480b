// Makes asking twice harmless: the same request is planned once and answered as often as asked. Pure.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <vector>

#include "common/messages/planning.hpp"

namespace handsel::trajectory_planner {

class RequestDesk {
 public:
  explicit RequestDesk(std::size_t remembered = 64) : remembered_(remembered) {}

  /// True: plan it. False: it is under way, or see answer().
  bool admit(const RequestId& id) {
    if (answer(id) != nullptr || std::find(open_.begin(), open_.end(), id) != open_.end()) return false;
    open_.push_back(id);
    return true;
  }
  void close(const TrajectoryReply& reply) {
    std::erase(open_, reply.id);
    answers_.push_back(reply);
    if (answers_.size() > remembered_) answers_.pop_front();
  }
  const TrajectoryReply* answer(const RequestId& id) const {
    const auto found = std::find_if(answers_.begin(), answers_.end(), [&id](const TrajectoryReply& r) { return r.id == id; });
    return found == answers_.end() ? nullptr : &*found;
  }

 private:
  std::size_t remembered_;
  std::vector<RequestId> open_;
  std::deque<TrajectoryReply> answers_;
};

}  // namespace handsel::trajectory_planner
