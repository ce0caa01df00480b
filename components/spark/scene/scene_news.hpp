// What of a scene is new since it was published last. Pure.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/base/time.hpp"
#include "common/messages/world.hpp"

namespace handsel::spark {

/// News of a scene: a change that matters to a planner, or a new observation of an object in a
/// person's hand, which may be offered.
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
  static constexpr double kSameSample = 1e-3;  // [s]

  /// Returns when an object in a person's hand was observed last; the epoch: no person holds one.
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
