// SPDX-License-Identifier: Apache-2.0
// What waits to be sent to one viewer: bounded, and of what a viewer only wants the newest of, only
// the newest. Pure.
#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace handsel::bridge {

using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;
using SharedText = std::shared_ptr<const std::string>;

/// One WebSocket message: a text, or a binary head with a body that several viewers share.
struct Frame {
  SharedText text;                 ///< null: binary
  std::vector<std::uint8_t> head;  ///< of a binary message
  Bytes body;                      ///< may be null

  /// Returns the length of the message [bytes].
  std::size_t size() const {
    return (text ? text->size() : 0) + head.size() + (body ? body->size() : 0);
  }
};

struct OutboxSettings {
  /// Answers and announcements that may wait; more mean that the client does not read.
  std::size_t max_controls{1024};
  /// Samples of one queued subscription that may wait; the oldest goes first.
  std::size_t max_queued{64};
  /// Of samples that may wait altogether [bytes]; the oldest goes first.
  std::size_t max_bytes{std::size_t{32} << 20U};
};

class Outbox {
 public:
  explicit Outbox(const OutboxSettings& settings = {}) : settings_(settings) {}

  /// Answers and announcements: in order, before any sample. False when too many wait: the viewer
  /// is to be cut.
  bool put(Frame frame);
  /// A sample of which only the newest of each (subscription, instance) is wanted: it takes the
  /// place of the one that waits.
  void put_newest(std::uint32_t subscription, std::uint64_t instance, Frame frame);
  /// A sample of which every one is wanted.
  void put_queued(std::uint32_t subscription, Frame frame);
  /// Removes the samples of a subscription that wait; they do not count as dropped.
  void forget(std::uint32_t subscription);

  /// Returns whether nothing waits.
  bool empty() const { return controls_.empty() && samples_.empty(); }
  /// The next message. Only while not empty.
  Frame pop();

  std::uint64_t dropped() const { return dropped_; }  ///< samples replaced or given up
  std::size_t bytes() const { return bytes_; }        ///< of the samples that wait [bytes]
  /// Returns the size of the answers and announcements that wait [bytes].
  std::size_t control_bytes() const { return control_bytes_; }

 private:
  struct Sample {
    std::uint32_t subscription{};
    std::uint64_t instance{};
    bool newest{};
    Frame frame;
  };
  using Place = std::list<Sample>::iterator;
  void add(Sample sample);
  void trim();
  void remove(Place place);

  OutboxSettings settings_;
  std::deque<Frame> controls_;
  std::list<Sample> samples_;
  std::map<std::pair<std::uint32_t, std::uint64_t>, Place> newest_;
  std::map<std::uint32_t, std::size_t> queued_;
  std::size_t bytes_{0}, control_bytes_{0};
  std::uint64_t dropped_{0};
};

}  // namespace handsel::bridge
