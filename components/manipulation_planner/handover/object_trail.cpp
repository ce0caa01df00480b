// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/object_trail.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace handsel::manipulation_planner {
namespace {

constexpr double kMinStep = 1e-3;         // between two observations [s]
constexpr std::size_t kDifferences = 10;  // of positions, from which the noise is measured

}  // namespace

void ObjectTrail::add(TimePoint seen, const Vector3& p_world) {
  if (!places_.empty() && to_seconds(seen - places_.back().first) < kMinStep) return;
  places_.emplace_back(seen, p_world);
  while (to_seconds(seen - places_.front().first) > settings_.offer_trail) places_.pop_front();
  measure_noise();
}

/// Fourth differences hold hardly anything of the motion of a hand, and 70 times the variance of
/// the noise. Their median is 1.54 standard deviations long.
void ObjectTrail::measure_noise() {
  if (places_.size() < kDifferences + 4) return;
  std::array<double, kDifferences> lengths;
  const std::size_t first = places_.size() - kDifferences - 4;
  for (std::size_t i = 0; i < kDifferences; ++i) {
    const auto p = [&](std::size_t k) -> const Vector3& { return places_[first + i + k].second; };
    lengths[i] = (p(0) - 4 * p(1) + 6 * p(2) - 4 * p(3) + p(4)).norm();
  }
  std::nth_element(lengths.begin(), lengths.begin() + kDifferences / 2, lengths.end());
  const double measured = lengths[kDifferences / 2] / (1.54 * std::sqrt(70.0));
  const double dt = to_seconds(places_.back().first - places_[places_.size() - 2].first);
  noise_ = std::min(measured, noise_ + settings_.offer_noise_growth * dt);
}

double ObjectTrail::tremor() const {
  return std::max(settings_.offer_tremor, settings_.offer_tremor_noise * noise_);
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
  const std::size_t arrival = last_beyond(tremor());
  const TimePoint since = arrival == places_.size() ? places_.back().first : places_[arrival].first;
  return to_seconds(places_.back().first - since);
}

/// Returns the index of the last place before the last part of the path, or the first index.
std::size_t ObjectTrail::before_arrival() const {
  const std::size_t before = last_beyond(settings_.offer_arrival * tremor());
  return before == 0 ? 0 : before - 1;
}

double ObjectTrail::turning_time() const {
  const std::size_t arrival = last_beyond(tremor());
  if (arrival == 0) return 0;
  return settings_.offer_turn_ratio *
         to_seconds(places_[arrival].first - places_[before_arrival()].first);
}

Vector3 ObjectTrail::arrival() const {
  const std::size_t arrival = last_beyond(tremor());
  if (arrival == 0) return Vector3::Zero();
  return (places_[arrival].second - places_[before_arrival()].second).stableNormalized();
}

double ObjectTrail::retreat() const {
  const Vector3 along = arrival();
  double sum = 0;
  int count = 0;
  for (std::size_t i = last_beyond(tremor()); i < places_.size(); ++i) {
    const double ago = to_seconds(places_.back().first - places_[i].first);
    if (ago < settings_.offer_retreat_begin || ago > settings_.offer_retreat_end) continue;
    sum += along.dot(places_[i].second);
    ++count;
  }
  return count > 0 ? sum / count - along.dot(places_.back().second) : 0;
}

double ObjectTrail::detour() const {
  const std::size_t arrival = last_beyond(tremor());
  if (arrival == 0) return 0;
  double length = 0;
  std::size_t corner = arrival - 1;
  for (std::size_t i = arrival - 1; i-- > 0;) {
    if (to_seconds(places_[arrival].first - places_[i].first) >= settings_.offer_detour_time) break;
    const double step = (places_[i].second - places_[corner].second).norm();
    if (step < tremor()) continue;
    length += step;
    corner = i;
  }
  return length - (places_[arrival - 1].second - places_[corner].second).norm();
}

}  // namespace handsel::manipulation_planner
