// SPDX-License-Identifier: Apache-2.0
// One subscription's intake, the same on every bus: validation, ages, deadline watch, rate.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "common/bus/bus.hpp"
#include "common/bus/writer_pin.hpp"

namespace handsel {

struct TopicHealth;

/// Age of a writer's samples at arrival: stamp offset over the min offset seen. The min offset
/// may drift by 1e-3, so that clocks that are slewed apart do not make samples look old; a writer's
/// clock that steps back continues with the age it had. Instances of a keyed topic share the
/// writer's clock but not their latency: an older stamp is a step of the clock only within one
/// instance.
class AgeEstimator {
 public:
  /// Returns the age of a sample at arrival, >= 0; zero for a stamp of 0 and for the first sample.
  /// `key`: its instance of a keyed topic.
  Duration update(Stamp stamp, TimePoint arrival, std::string_view key = {});

 private:
  struct Last {
    Stamp stamp{};
    Duration age{};
  };
  bool seen_{false};
  TimePoint last_arrival_{};
  std::int64_t min_offset_{};
  std::map<std::string, Last, std::less<>> last_;  // by key
};

/// Validation, ages, deadline and rate of one subscription.
class Intake {
 public:
  using Callback = std::function<void(const void*, const Receipt&)>;
  using Log = std::function<void(const std::string&)>;
  Intake(const MessageType& type, Callback callback, Duration period, Log log);

  /// Validates one IDL sample and passes it to the callback; refused and malformed ones are
  /// counted.
  void deliver(const void* wire, std::uint64_t writer, TimePoint arrival);
  /// Counts a silence that has become longer than the deadline; also moves the window of the rate.
  /// Called at the rate of health.
  void watch(TimePoint now);
  /// Discards the offsets of stamps: after a jump of this component's time they are no longer
  /// valid.
  void forget_ages() { ages_.clear(); }
  /// Forgets the clock offset of a writer that is no longer alive.
  void writer_gone(std::uint64_t writer);
  /// Adds a discovered writer, on topics with one writer only: there, samples of other writers are
  /// refused.
  void writer_appeared(std::uint64_t writer, WriterIdentity identity, TimePoint now);
  /// Removes a writer that was deleted or lost its lease; another one may be accepted then.
  void writer_left(std::uint64_t writer, TimePoint now);
  /// Returns whether a sample of `writer` may enter the queue of the transport; counts a refusal.
  bool admits(std::uint64_t writer, TimePoint now);
  /// Adds `count` samples that the transport has refused because another writer is accepted.
  void count_refused(std::uint64_t count) { status_.refused += count; }
  /// Accepts `writer` from now on if the rule of WriterPin lets it take the place of the accepted
  /// one.
  void contend(std::uint64_t writer, TimePoint now);
  /// Returns the accepted writer; 0: none, or a topic with many writers.
  std::uint64_t pinned() const { return pin_ ? pin_->pinned() : 0; }
  /// Returns whether discovery has reported the writer; always true on a topic with many writers.
  bool knows(std::uint64_t writer) const { return !pin_ || pin_->knows(writer); }
  /// Returns the topic's entry for ComponentHealth; the rate is a mean over the last five calls of
  /// watch().
  TopicHealth health(TimePoint now) const;

  /// Returns the type the intake was created for.
  const MessageType& type() const { return type_; }
  /// Returns the counters, for the bus to update what the transport reports (writers).
  SubscriptionStatus& status() { return status_; }
  /// Returns the counters; valid as long as the intake.
  const SubscriptionStatus& status() const { return status_; }

 private:
  void name_second_writer();

  const MessageType& type_;
  Callback callback_;
  Duration deadline_{};
  Log log_;
  SubscriptionStatus status_;
  std::optional<WriterPin> pin_;  ///< of a topic with one writer
  std::shared_ptr<void> message_;
  std::map<std::uint64_t, AgeEstimator> ages_;  // by writer
  std::set<std::uint64_t> logged_;
  bool silence_counted_{false};
  std::array<std::uint64_t, 5> window_{};  ///< received at the last watches
  std::array<TimePoint, 5> window_times_{};
  std::size_t window_next_{0}, window_filled_{0};
};

/// Reason for ComponentHealth: which other writers there are on topics with one writer.
class SecondWriters {
 public:
  /// Notes the second writer of the subscription's topic, if there is one.
  void add(const Intake& intake);
  /// Returns an empty text without second writers; else "second_writer: NAME writes TOPIC, TOPIC
  /// too; its samples are refused", the first four names.
  std::string reason() const;

 private:
  std::map<std::string, std::string> topics_;  // by name of the writer
};

}  // namespace handsel
