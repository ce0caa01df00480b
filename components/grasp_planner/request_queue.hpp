// SPDX-License-Identifier: Apache-2.0
// Requests that wait for an answer, and the latest replies: asking twice is harmless. Pure.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <utility>

#include "common/messages/planning.hpp"

namespace handsel::grasp_planner {

/// Waiting requests of one kind, at most `max_waiting`, and the latest replies.
template <class Reply>
class RequestQueue {
 public:
  /// `max_waiting`: requests that may wait; `remembered`: replies that are kept.
  RequestQueue(std::size_t max_waiting, std::size_t remembered)
      : max_waiting_(max_waiting), remembered_(remembered) {}

  /// Returns the reply to this request if it is remembered; nullptr: it is not.
  const Reply* reply(const RequestId& id) const {
    const auto known =
        std::find_if(replies_.begin(), replies_.end(), [&](const Reply& r) { return r.id == id; });
    return known != replies_.end() ? &*known : nullptr;
  }
  /// Returns whether the request waits.
  bool waits(const RequestId& id) const {
    return std::find(waiting_.begin(), waiting_.end(), id) != waiting_.end();
  }
  /// Returns whether no further request may wait.
  bool full() const { return waiting_.size() >= max_waiting_; }
  /// Adds a request that waits.
  void add(const RequestId& id) { waiting_.push_back(id); }
  /// Ends the wait of the request and remembers its reply.
  void finish(const Reply& reply) {
    std::erase(waiting_, reply.id);
    replies_.push_back(reply);
    if (replies_.size() > remembered_) replies_.pop_front();
  }

 private:
  std::size_t max_waiting_, remembered_;
  std::deque<RequestId> waiting_;
  std::deque<Reply> replies_;
};

}  // namespace handsel::grasp_planner
