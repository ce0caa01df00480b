// SPDX-License-Identifier: Apache-2.0
// Detects changes of a scene since the last publication. Pure.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/base/time.hpp"
#include "common/messages/world.hpp"

namespace handsel::spark {

/// News of a scene: a change relevant to a planner, or a new observation of an object in a person's
/// hand, which may be offered.
class SceneNews {
 public:
  /// Notes that the scene was published at `now`.
  void published(const Scene& scene, TimePoint now) {
    revision_ = scene.revision;
    held_seen_ = held_seen(scene, now);
  }
  /// Returns whether the scene of `now` has news.
  bool has_news(const Scene& scene, TimePoint now) const {
    return scene.revision != revision_ ||
           to_seconds(held_seen(scene, now) - held_seen_) > kSameSample;
  }

 private:
  static constexpr double kSameSample = 1e-3;  // max time difference of one sample [s]

  /// Returns the last observation of an object in a person's hand; the epoch: none.
  static TimePoint held_seen(const Scene& scene, TimePoint now) {
    TimePoint newest{};
    for (const SceneObject& object : scene.objects)
      if (object.holder == Holder::human) newest = std::max(newest, now - from_seconds(object.age));
    return newest;
  }

  std::uint64_t revision_{};
  TimePoint held_seen_{};
};

}  // namespace handsel::spark
