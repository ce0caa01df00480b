// SPDX-License-Identifier: Apache-2.0
// Requests of several clients and the answers to them: a repeated request is harmless, a client may
// cancel, and all lists are bounded. No I/O, no clock, no locks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace handsel {

/// Bounds of a RequestQueue.
struct RequestLimits {
  std::size_t open{64};        ///< requests that are admitted and not answered
  std::size_t remembered{64};  ///< answers kept for a client that asks again
  /// Clients whose newest and cancelled numbers are remembered. A superseded or cancelled request
  /// of a forgotten client counts as fresh.
  std::size_t clients{64};
};

/// What a newer request of a client means for its older ones.
enum class OlderRequests {
  keep,       ///< each is answered
  supersede,  ///< older ones are superseded, see superseded(); open ones stay open
};

/// Open requests and kept replies. `Reply::id` has the fields `client` and `number`; the numbers of
/// a client grow.
template <class Reply>
class RequestQueue {
 public:
  using Id = decltype(Reply::id);
  explicit RequestQueue(OlderRequests older, const RequestLimits& limits = {})
      : older_(older), limits_(limits) {}

  enum class Admission {
    fresh,       ///< new: to be worked on
    under_way,   ///< a repeated request whose answer is still to come
    answered,    ///< a repeated request, see answer()
    superseded,  ///< the client has sent a newer request since
    cancelled,   ///< withdrawn by the client
    full,        ///< the limit of open requests is reached: to be refused
  };
  /// Registers a request and returns what to do with it; only `fresh` opens it. May forget the
  /// client whose last request or cancellation is oldest; `answered` and `under_way` do not count.
  Admission admit(const Id& id) {
    if (answer(id) != nullptr) return Admission::answered;
    if (std::find(open_.begin(), open_.end(), id) != open_.end()) return Admission::under_way;
    Client& client = client_of(id);
    if (client.any_cancelled && id.number <= client.cancelled) return Admission::cancelled;
    if (older_ == OlderRequests::supersede && id.number < client.newest)
      return Admission::superseded;
    if (open_.size() >= limits_.open) return Admission::full;
    client.newest = std::max(client.newest, id.number);
    open_.push_back(id);
    return Admission::fresh;
  }
  /// Returns whether the client has sent a newer request that replaces this one; false under
  /// OlderRequests::keep and for unknown clients.
  bool superseded(const Id& id) const {
    const auto client = find(id.client);
    return older_ == OlderRequests::supersede && client != clients_.end() &&
           client->newest > id.number;
  }
  /// Marks this request and all older ones of the client as cancelled. Returns those that are open;
  /// they stay open until close(). May forget another client, as admit().
  std::vector<Id> cancel(const Id& id) {
    Client& client = client_of(id);
    client.cancelled = std::max(client.cancelled, id.number);
    client.any_cancelled = true;
    std::vector<Id> unanswered;
    for (const Id& open : open_)
      if (open.client == id.client && open.number <= id.number) unanswered.push_back(open);
    return unanswered;
  }
  /// Removes the request from the open ones and keeps the reply for repeated requests; the oldest
  /// reply is dropped at the bound.
  void close(const Reply& reply) {
    std::erase(open_, reply.id);
    answers_.push_back(reply);
    if (answers_.size() > limits_.remembered) answers_.pop_front();
  }
  /// Returns the reply that is kept for the request, valid until the next close(); nullptr if there
  /// is none.
  const Reply* answer(const Id& id) const {
    const auto found = std::find_if(answers_.begin(), answers_.end(),
                                    [&id](const Reply& reply) { return reply.id == id; });
    return found == answers_.end() ? nullptr : &*found;
  }
  /// Returns the reason for Admission::full, one sentence.
  std::string why_full() const {
    return std::to_string(limits_.open) +
           " requests wait already, which is the limit; ask again later";
  }
  /// Returns the number of requests that are admitted and not answered.
  std::size_t open() const { return open_.size(); }
  /// Returns the number of clients that are remembered.
  std::size_t clients() const { return clients_.size(); }

 private:
  struct Client {
    std::uint64_t id{}, newest{}, cancelled{};
    bool any_cancelled{};
  };
  using Clients = std::vector<Client>;
  typename Clients::const_iterator find(std::uint64_t id) const {
    return std::find_if(clients_.begin(), clients_.end(),
                        [id](const Client& client) { return client.id == id; });
  }
  /// The client, last in the list from now on.
  Client& client_of(const Id& id) {
    const auto at = clients_.begin() + (find(id.client) - clients_.cbegin());
    if (at != clients_.end()) {
      std::rotate(at, at + 1, clients_.end());
    } else {
      if (clients_.size() >= limits_.clients) clients_.erase(clients_.begin());
      clients_.push_back({id.client, 0, 0, false});
    }
    return clients_.back();
  }

  OlderRequests older_;
  RequestLimits limits_;
  std::vector<Id> open_;
  std::deque<Reply> answers_;
  Clients clients_;  // the one that asked last at the end
};

}  // namespace handsel
