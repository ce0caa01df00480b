// SPDX-License-Identifier: Apache-2.0
// Which writer of a topic with one writer is accepted: the rule every bus applies. Pure.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "common/base/time.hpp"
#include "common/topics/topics.hpp"

namespace handsel {

/// What discovery knows of a writer.
struct WriterIdentity {
  /// Entity name of its participant: the components it speaks for, separated by spaces.
  std::string components;
  std::string name;    ///< for a person: "spark (pid 7 on host desk)"
  bool matches{true};  ///< type and QoS let its samples arrive
  /// Returns whether its process has ended; empty: that cannot be known from here.
  std::function<bool()> ended;
};

/// Returns whether a participant with this entity name may write the topic: one of its words is in
/// the row's column `writers`.
bool may_write(const TopicRow& row, const std::string& components);

/// Pins the first eligible writer of a topic and keeps the pin while that writer lives, also while
/// it is silent. Another one follows at once when the pinned writer has left or its process has
/// ended. Where the process cannot be observed (another host), a writer of the same component that
/// appeared after the last sample follows when the silence is longer than the deadline and 0.3 s.
/// Of a trajectory, ros2_lane takes the pin from the manipulation planner for as long as it has a
/// writer, which it has only while it hands over a command.
class WriterPin {
 public:
  explicit WriterPin(const TopicRow& row) : row_(row) {}

  /// Adds a discovered writer of the topic, at most 64; a first eligible one is pinned at once.
  void appeared(std::uint64_t writer, WriterIdentity identity, TimePoint now);
  /// Removes a writer that was deleted or whose participant lost its lease; the pin moves on.
  void left(std::uint64_t writer, TimePoint now);
  /// Returns whether the writer has appeared and not left.
  bool knows(std::uint64_t writer) const { return known_.contains(writer); }
  /// Returns whether a sample of `writer` is accepted, and moves the pin where the rule permits.
  /// Samples of writers that have not appeared are refused.
  bool accepts(std::uint64_t writer, TimePoint arrival);
  /// Notices writers whose process has ended before discovery reports them as gone. Called at the
  /// rate of health.
  void watch(TimePoint now);
  std::uint64_t pinned() const { return pinned_; }  ///< handle of the accepted writer; 0: none
  /// Returns the name of a living writer beside the pinned one, with the count of further ones;
  /// empty: there is none.
  const std::string& second_writer() const { return second_; }

 private:
  struct Known {
    WriterIdentity identity;
    TimePoint since{};
    bool eligible{};
    int precedence{};
  };
  bool takes_pin(const Known& candidate, TimePoint now);
  bool pinned_ended(TimePoint now);
  void pin_next(TimePoint now);
  void pin(std::uint64_t writer, TimePoint now);
  void name_second();

  const TopicRow& row_;
  std::map<std::uint64_t, Known> known_;
  std::uint64_t pinned_{0};
  TimePoint last_sample_{};  // of the pinned writer, or when it was pinned
  TimePoint next_check_{};   // of the pinned writer's process
  std::string second_;
};

}  // namespace handsel
