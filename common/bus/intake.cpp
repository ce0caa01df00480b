// SPDX-License-Identifier: Apache-2.0
#include "common/bus/intake.hpp"

#include <algorithm>

#include "common/messages/system.hpp"

namespace handsel {
namespace {
constexpr double kClockDrift = 1e-3;
constexpr std::size_t kMaxTrackedWriters = 64, kMaxKeys = 64;

std::string second_writer_sentence(const std::string& name, const std::string& topics) {
  return "second_writer: " + name + " writes " + topics + " too; its samples are refused";
}

}  // namespace

Duration AgeEstimator::update(Stamp stamp, TimePoint arrival, std::string_view key) {
  if (stamp == 0) return Duration::zero();
  const std::int64_t offset = arrival.time_since_epoch().count() - stamp;
  auto last = last_.find(key);
  const bool first = last == last_.end();
  if (first) {
    if (last_.size() >= kMaxKeys) last_.clear();
    last = last_.emplace(key, Last{}).first;
  }
  if (!seen_) {
    min_offset_ = offset;
  } else if (!first && stamp < last->second.stamp) {
    min_offset_ = offset - last->second.age.count();
  } else {
    const double drift = kClockDrift * static_cast<double>((arrival - last_arrival_).count());
    min_offset_ = std::min(offset, min_offset_ + static_cast<std::int64_t>(drift));
  }
  seen_ = true;
  last_arrival_ = arrival;
  last->second = {stamp, Duration(offset - min_offset_)};
  return last->second.age;
}

Intake::Intake(const MessageType& message, Callback callback, Duration period, Log log)
    : type_(message),
      callback_(std::move(callback)),
      log_(std::move(log)),
      message_(message.new_message()) {
  if (has_one_writer(type_.row())) pin_.emplace(type_.row());
  if (type_.row().deadline > 0) deadline_ = from_seconds(type_.row().deadline) + period;
}

void Intake::deliver(const void* wire, std::uint64_t writer, TimePoint arrival) {
  if (!admits(writer, arrival)) return;
  std::string why;
  LeftOutElements left_out;
  if (!type_.from_wire(wire, message_.get(), why, left_out)) {
    ++status_.rejected;
    status_.last_rejection = why;
    if (logged_.size() < kMaxTrackedWriters && logged_.insert(writer).second)
      log_("rejected a sample: " + why);
    return;
  }
  if (left_out.count > 0) {
    status_.left_out += left_out.count;
    status_.last_left_out = left_out.why;
    if (logged_.size() < kMaxTrackedWriters && logged_.insert(writer).second)
      log_("left out of a sample: " + left_out.why);
  }
  if (!status_.never_seen() && deadline_ > Duration::zero() && !silence_counted_ &&
      arrival - status_.last_arrival > deadline_)
    ++status_.deadline_misses;
  silence_counted_ = false;
  if (ages_.size() >= kMaxTrackedWriters && !ages_.contains(writer)) ages_.clear();
  Receipt receipt;
  receipt.arrival = arrival;
  receipt.age = ages_[writer].update(type_.stamp(wire), arrival, type_.key(wire));
  receipt.writer = writer;
  ++status_.received;
  status_.last_arrival = arrival;
  status_.last_age = receipt.age;
  callback_(message_.get(), receipt);
}

void Intake::watch(TimePoint now) {
  if (pin_) {
    pin_->watch(now);
    name_second_writer();
  }
  if (!status_.never_seen() && deadline_ > Duration::zero() && !silence_counted_ &&
      now - status_.last_arrival > deadline_) {
    ++status_.deadline_misses;
    silence_counted_ = true;
  }
  window_[window_next_] = status_.received;
  window_times_[window_next_] = now;
  window_next_ = (window_next_ + 1) % window_.size();
  window_filled_ = std::min(window_filled_ + 1, window_.size());
}

void Intake::writer_gone(std::uint64_t writer) { ages_.erase(writer); }

void Intake::writer_appeared(std::uint64_t writer, WriterIdentity identity, TimePoint now) {
  if (!pin_) return;
  pin_->appeared(writer, std::move(identity), now);
  name_second_writer();
}

void Intake::writer_left(std::uint64_t writer, TimePoint now) {
  if (!pin_) return;
  pin_->left(writer, now);
  name_second_writer();
}

bool Intake::admits(std::uint64_t writer, TimePoint now) {
  if (!pin_ || pin_->accepts(writer, now)) return true;
  ++status_.refused;
  return false;
}

void Intake::contend(std::uint64_t writer, TimePoint now) {
  if (pin_ && pin_->accepts(writer, now)) name_second_writer();
}

void Intake::name_second_writer() {
  if (status_.second_writer == pin_->second_writer()) return;
  status_.second_writer = pin_->second_writer();
  if (!status_.second_writer.empty())
    log_(second_writer_sentence(status_.second_writer, type_.row().topic));
}

void SecondWriters::add(const Intake& intake) {
  const std::string& name = intake.status().second_writer;
  if (name.empty()) return;
  std::string& topics = topics_[name];
  topics += (topics.empty() ? "" : ", ") + std::string(intake.type().row().topic);
}

std::string SecondWriters::reason() const {
  constexpr std::size_t kMaxNames = 4;
  std::string reason;
  std::size_t names = 0;
  for (const auto& [name, topics] : topics_)
    if (names++ < kMaxNames)
      reason += (reason.empty() ? "" : "; ") + second_writer_sentence(name, topics);
  return reason;
}

TopicHealth Intake::health(TimePoint now) const {
  TopicHealth out;
  out.topic = type_.row().topic;
  out.received = status_.received;
  out.age = status_.never_seen() ? -1.0 : std::clamp(to_seconds(status_.age(now)), 0.0, 1e9);
  out.deadline_misses = status_.deadline_misses;
  out.rejected = status_.rejected;
  out.last_rejection = status_.last_rejection;
  out.refused = status_.refused;
  out.second_writer = status_.second_writer;
  if (window_filled_ > 0) {
    const std::size_t oldest = window_filled_ < window_.size() ? 0 : window_next_;
    const double span = to_seconds(now - window_times_[oldest]);
    if (span > 0)
      out.rate = std::min(1e6, static_cast<double>(status_.received - window_[oldest]) / span);
  }
  return out;
}

}  // namespace handsel
