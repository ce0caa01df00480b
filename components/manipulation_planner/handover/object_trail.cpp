#include "components/manipulation_planner/handover/object_trail.hpp"

#include <algorithm>

namespace handsel::manipulation_planner {
namespace {

constexpr double kLength = 2.0;      // of the trail [s]
constexpr double kNoise = 0.007;     // of an object at rest in a hand, tremor included [m]
constexpr double kDetourTime = 1.0;  // before the rest [s]
constexpr double kDrift = 0.4;       // of rest, after which only sway moves the object [s]
constexpr double kTurns = 1.9;       // times the last part of the path: out and back again
constexpr double kBeforeEnd = 8;     // times the noise: there the last part begins

}  // namespace

void ObjectTrail::add(TimePoint now, const Vector3& p_world) {
  places_.emplace_back(now, p_world);
  while (to_seconds(now - places_.front().first) > kLength) places_.pop_front();
}

/// Returns one more than the index of the last place farther than `radius` from the newest; 0: none
/// is.
std::size_t ObjectTrail::last_beyond(double radius) const {
  std::size_t i = places_.size();
  while (i > 0 && (places_[i - 1].second - places_.back().second).norm() <= radius) --i;
  return i;
}

double ObjectTrail::rest() const {
  if (places_.empty()) return 0;
  const std::size_t arrival = last_beyond(kNoise);
  const TimePoint since = arrival == places_.size() ? places_.back().first : places_[arrival].first;
  return to_seconds(places_.back().first - since);
}

double ObjectTrail::turning_time() const {
  const std::size_t arrival = last_beyond(kNoise), before = last_beyond(kBeforeEnd * kNoise);
  if (arrival == 0 || before == 0) return 0;
  return kTurns * to_seconds(places_[arrival].first - places_[before].first);
}

double ObjectTrail::retreat() const {
  const std::size_t arrival = last_beyond(kNoise), before = last_beyond(kBeforeEnd * kNoise);
  if (arrival == 0 || before == 0 || arrival == places_.size() || rest() > kDrift) return 0;
  const Vector3 along = (places_[arrival].second - places_[before - 1].second).stableNormalized();
  double farthest = 0;
  for (std::size_t i = arrival; i < places_.size(); ++i)
    farthest = std::max(farthest, along.dot(places_[i].second - places_.back().second));
  return farthest;
}

double ObjectTrail::detour() const {
  const std::size_t arrival = last_beyond(kNoise);
  if (arrival == 0) return 0;
  double length = 0;
  std::size_t i = arrival;
  while (i > 1 && to_seconds(places_[arrival].first - places_[i - 1].first) < kDetourTime) {
    --i;
    length += (places_[i].second - places_[i - 1].second).norm();
  }
  return length - (places_[arrival - 1].second - places_[i - 1].second).norm();
}

}  // namespace handsel::manipulation_planner
