// SPDX-License-Identifier: Apache-2.0
// Regrasp requests that wait for an answer, and the latest reply: asking twice is harmless. Pure.
#pragma once

#include <cstddef>
#include <optional>

#include "common/messages/planning.hpp"

namespace handsel::grasp_planner {

/// Counts waiting requests, at most `max_waiting`, and remembers the newest request and reply.
class RegraspQueue {
 public:
  /// `max_waiting`: requests that may wait.
  explicit RegraspQueue(std::size_t max_waiting) : max_waiting_(max_waiting) {}

  /// Returns the reply to this request if it is the latest one; nullptr: it is not.
  const RegraspReply* reply(const RequestId& id) const {
    return reply_ && reply_->id == id ? &*reply_ : nullptr;
  }
  /// Returns whether the request is the newest one and waits.
  bool waits(const RequestId& id) const { return newest_ == id; }
  /// Returns whether no further request may wait.
  bool full() const { return waiting_ >= max_waiting_; }
  /// Adds a request that waits.
  void add(const RequestId& id) {
    ++waiting_;
    newest_ = id;
  }
  /// Ends the wait of one request and remembers its reply.
  void finish(const RegraspReply& reply) {
    --waiting_;
    newest_.reset();
    reply_ = reply;
  }

 private:
  std::size_t max_waiting_;
  std::size_t waiting_{0};
  std::optional<RequestId> newest_;
  std::optional<RegraspReply> reply_;
};

}  // namespace handsel::grasp_planner
