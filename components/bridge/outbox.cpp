// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/outbox.hpp"

#include <utility>

namespace handsel::bridge {

bool Outbox::put(Frame frame) {
  if (controls_.size() >= settings_.max_controls) return false;
  control_bytes_ += frame.size();
  controls_.push_back(std::move(frame));
  return true;
}

void Outbox::put_newest(std::uint32_t subscription, std::uint64_t instance, Frame frame) {
  if (const auto waiting = newest_.find({subscription, instance}); waiting != newest_.end()) {
    Sample& sample = *waiting->second;
    bytes_ = bytes_ - sample.frame.size() + frame.size();
    sample.frame = std::move(frame);
    ++dropped_;
    trim();
    return;
  }
  add({subscription, instance, true, std::move(frame)});
}

void Outbox::put_queued(std::uint32_t subscription, Frame frame) {
  if (queued_[subscription] >= settings_.max_queued) {
    for (Place place = samples_.begin(); place != samples_.end(); ++place) {
      if (place->newest || place->subscription != subscription) continue;
      remove(place);
      ++dropped_;
      break;
    }
  }
  add({subscription, 0, false, std::move(frame)});
}

void Outbox::forget(std::uint32_t subscription) {
  for (Place place = samples_.begin(); place != samples_.end();) {
    const Place next = std::next(place);
    if (place->subscription == subscription) remove(place);
    place = next;
  }
  queued_.erase(subscription);
}

Frame Outbox::pop() {
  Frame frame;
  if (!controls_.empty()) {
    frame = std::move(controls_.front());
    controls_.pop_front();
    control_bytes_ -= frame.size();
  } else {
    const Place first = samples_.begin();
    bytes_ -= first->frame.size();
    frame = std::move(first->frame);
    first->frame = {};
    remove(first);
  }
  return frame;
}

void Outbox::add(Sample sample) {
  bytes_ += sample.frame.size();
  samples_.push_back(std::move(sample));
  const Place place = std::prev(samples_.end());
  if (place->newest) {
    newest_[{place->subscription, place->instance}] = place;
  } else {
    ++queued_[place->subscription];
  }
  trim();
}

void Outbox::trim() {
  while (bytes_ > settings_.max_bytes && samples_.size() > 1) {
    remove(samples_.begin());
    ++dropped_;
  }
}

void Outbox::remove(Place place) {
  bytes_ -= place->frame.size();
  if (place->newest) {
    newest_.erase({place->subscription, place->instance});
  } else {
    --queued_[place->subscription];
  }
  samples_.erase(place);
}

}  // namespace handsel::bridge
