// SPDX-License-Identifier: Apache-2.0
#include "common/bus/writer_pin.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

namespace handsel {
namespace {

constexpr std::size_t kMaxPinnedWriters =
    64;  // max writers known of a topic; samples of further ones are refused and not named
/// Min silence after which a process on another host may have ended: shorter leases give false
/// alarms.
constexpr Duration kUnobservedSilence = std::chrono::milliseconds(300);
/// Min interval of checks whether a process lives: a check costs 10 us, and a second writer may
/// require one with every sample.
constexpr Duration kCheckPeriod = std::chrono::milliseconds(5);

/// Calls a function with each word of a list separated by spaces until one satisfies `found`.
template <class Found>
bool any_word(std::string_view list, Found found) {
  while (!list.empty()) {
    const std::size_t space = list.find(' ');
    if (space != 0 && found(list.substr(0, space))) return true;
    list = space == std::string_view::npos ? std::string_view() : list.substr(space + 1);
  }
  return false;
}

/// Returns the precedence of a writer; a writer of greater precedence takes over the pin.
int precedence_of(const TopicRow& row, const std::string& components) {
  if (&row != &TopicOf<TrajectoryCommand>::row) return 0;
  return any_word(components, [](std::string_view word) { return word == "ros2_lane"; }) ? 1 : 0;
}

}  // namespace

bool may_write(const TopicRow& row, const std::string& components) {
  return any_word(components, [&](std::string_view word) { return named_in(row.writers, word); });
}

void WriterPin::appeared(std::uint64_t writer, WriterIdentity identity, TimePoint now) {
  if (known_.size() >= kMaxPinnedWriters && !known_.contains(writer)) return;
  Known& known = known_[writer];
  known.eligible = identity.matches && may_write(row_, identity.components);
  known.precedence = precedence_of(row_, identity.components);
  known.identity = std::move(identity);
  known.since = now;
  if (writer != pinned_ && takes_pin(known, now)) pin(writer, now);
  name_second();
}

void WriterPin::left(std::uint64_t writer, TimePoint now) {
  if (known_.erase(writer) == 0) return;
  if (writer == pinned_) pin_next(now);
  name_second();
}

void WriterPin::watch(TimePoint now) {
  if (pinned_ != 0 && known_.size() > 1 && known_.at(pinned_).identity.ended && pinned_ended(now))
    pin_next(now);
  if (!second_.empty()) name_second();
}

/// Pins the living eligible writer of greatest precedence that appeared first, except the pinned
/// one; without such a writer the topic has no pinned one.
void WriterPin::pin_next(TimePoint now) {
  const std::uint64_t before = std::exchange(pinned_, 0);
  const Known* best = nullptr;
  for (const auto& [id, known] : known_) {
    if (id == before || !known.eligible || (known.identity.ended && known.identity.ended()))
      continue;
    if (best != nullptr && (known.precedence < best->precedence ||
                            (known.precedence == best->precedence && known.since >= best->since)))
      continue;
    best = &known;
    pin(id, now);
  }
}

bool WriterPin::accepts(std::uint64_t writer, TimePoint arrival) {
  if (writer != pinned_) {
    const auto known = known_.find(writer);
    if (known == known_.end() || !takes_pin(known->second, arrival)) return false;
    pin(writer, arrival);
    name_second();
  }
  last_sample_ = arrival;
  return true;
}

bool WriterPin::takes_pin(const Known& candidate, TimePoint now) {
  if (!candidate.eligible) return false;
  if (pinned_ == 0) return true;
  const Known& pinned = known_.at(pinned_);
  if (candidate.precedence > pinned.precedence) return true;
  if (pinned.identity.ended) return pinned_ended(now);
  const Duration silence = std::max(kUnobservedSilence, from_seconds(row_.deadline));
  return row_.deadline > 0 && candidate.identity.components == pinned.identity.components &&
         candidate.since > last_sample_ && now - last_sample_ > silence;
}

bool WriterPin::pinned_ended(TimePoint now) {
  if (now < next_check_) return false;
  next_check_ = now + kCheckPeriod;
  return known_.at(pinned_).identity.ended();
}

void WriterPin::pin(std::uint64_t writer, TimePoint now) {
  pinned_ = writer;
  last_sample_ = now;
  next_check_ = {};
}

void WriterPin::name_second() {
  second_.clear();
  std::size_t others = 0;
  for (const auto& [id, known] : known_) {
    if (id == pinned_) continue;
    const bool waits_its_turn =
        pinned_ != 0 && known.eligible && known.precedence < known_.at(pinned_).precedence;
    if (waits_its_turn || (known.identity.ended && known.identity.ended())) continue;
    if (others++ == 0) second_ = known.identity.name;
  }
  if (others > 1) second_ += " and " + std::to_string(others - 1) + " more";
}

}  // namespace handsel
