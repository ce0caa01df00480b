// Who asked what: makes asking twice harmless and lets a newer request of a client replace its older ones, and a client cancel. Pure.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "common/messages/planning.hpp"

namespace handsel::path_planner {

class RequestDesk {
 public:
  /// Remembers this many answers.
  explicit RequestDesk(std::size_t remembered = 64) : remembered_(remembered) {}

  enum class Admission {
    fresh,       ///< plan it
    under_way,   ///< asked before, the answer will come
    answered,    ///< asked before, see `answer`
    superseded,  ///< the client has asked something newer since
    cancelled,   ///< the client wants it no more
  };
  Admission admit(const RequestId& id) {
    if (answer(id) != nullptr) return Admission::answered;
    for (const RequestId& open : open_)
      if (open == id) return Admission::under_way;
    if (const auto last = cancelled_.find(id.client); last != cancelled_.end() && id.number <= last->second) return Admission::cancelled;
    std::uint64_t& newest = newest_[id.client];
    if (id.number < newest) return Admission::superseded;
    newest = id.number;
    open_.push_back(id);
    return Admission::fresh;
  }
  bool superseded(const RequestId& id) const {
    const auto found = newest_.find(id.client);
    return found != newest_.end() && found->second > id.number;
  }
  /// This request and all older ones of the client are wanted no more: those that are not answered yet.
  std::vector<RequestId> cancel(const RequestId& id) {
    std::uint64_t& last = cancelled_[id.client];
    last = std::max(last, id.number);
    std::vector<RequestId> unanswered;
    for (const RequestId& open : open_)
      if (open.client == id.client && open.number <= id.number) unanswered.push_back(open);
    return unanswered;
  }
  void close(const PathReply& reply) {
    std::erase(open_, reply.id);
    answers_.push_back(reply);
    if (answers_.size() > remembered_) answers_.pop_front();
  }
  const PathReply* answer(const RequestId& id) const {
    for (const PathReply& reply : answers_)
      if (reply.id == id) return &reply;
    return nullptr;
  }
  const std::vector<RequestId>& open() const { return open_; }

 private:
  std::size_t remembered_;
  std::vector<RequestId> open_;
  std::deque<PathReply> answers_;
  std::map<std::uint64_t, std::uint64_t> newest_, cancelled_;  // numbers, by client
};

}  // namespace handsel::path_planner
