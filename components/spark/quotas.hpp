// SPDX-License-Identifier: Apache-2.0
// Quotas of people, objects, boxes and facts; beyond a quota the nearest and most relevant are
// kept. Pure.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "common/config/settings/spark.hpp"
#include "common/messages/world.hpp"

namespace handsel {
class SettingsText;
}

namespace handsel::spark {

/// Quotas by the settings of the same names.
struct Quotas {
  /// Max numbers: bodies of an observation that become new people, tracks of people, people of a
  /// HumanState, sources of people, remembered objects, objects and boxes of a Scene, facts of
  /// Facts.
  std::size_t bodies{32}, tracks{64}, people{16}, sources{16}, known_objects{128}, objects{64},
      boxes{64}, facts{256};
};
/// Returns the quotas of the settings; their ranges are not checked.
Quotas quotas_of(const settings::SparkSettings& settings);
/// Checks the consistency of the quotas. Throws ConfigError "file:line:key: ...".
void check_quotas(const settings::SparkSettings& settings, const SettingsText& text);

/// The elements left out by a quota.
struct LeftOut {
  std::uint32_t count{};  ///< number of elements
  /// Distance of the nearest element from the axis of the arm [m].
  double nearest{std::numeric_limits<double>::infinity()};
};

/// Returns the horizontal distance from the arm's axis to the sides of its reach [m].
double arm_radius(const Coverage& reach);
/// Returns the distance of a point from the vertical axis segment in the middle of `reach` [m].
double distance_to_arm(const Vector3& point, const Coverage& reach);
/// Returns the distance of the nearest joint, less the inflation of a lost person [m]; negative
/// inside the inflated body.
double distance_to_arm(const Person& person, const Coverage& reach);
/// Returns the distance of the nearest joint, or of the gaze origin of a body without joints [m];
/// infinity without either.
double distance_to_arm(const ObservedPerson& person, const Coverage& reach);
/// Returns the min distance of the box from five points on the axis [m]; 0 if one is inside.
double distance_to_arm(const SceneBox& box, const Coverage& reach);

/// Rank of an element; elements of lower rank are kept first.
struct Rank {
  int order{};        ///< class of the element; compared before the distance
  double distance{};  ///< to the arm [m]
  friend auto operator<=>(const Rank&, const Rank&) = default;
};

/// Returns the rank of an object: held by the robot, held by a person, requested by the task, any
/// other; then by distance.
Rank rank_of(const SceneObject& object, bool requested, const Coverage& reach);

/// Keeps the `max` items of lowest rank in their order; of equal ranks the first. `rank` returns
/// the Rank of an item.
template <class T, class RankOf>
LeftOut keep_lowest(std::vector<T>& items, std::size_t max, RankOf&& rank) {
  LeftOut out;
  if (items.size() <= max) return out;
  std::vector<Rank> ranks;
  ranks.reserve(items.size());
  for (const T& item : items) ranks.push_back(rank(item));
  std::vector<std::size_t> order(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>(max);
  std::nth_element(order.begin(), middle, order.end(), [&](std::size_t a, std::size_t b) {
    return ranks[a] != ranks[b] ? ranks[a] < ranks[b] : a < b;
  });
  for (auto left = middle; left != order.end(); ++left)
    out.nearest = std::min(out.nearest, ranks[*left].distance);
  out.count = static_cast<std::uint32_t>(order.end() - middle);
  order.erase(middle, order.end());
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != i) items[i] = std::move(items[order[i]]);
  items.resize(max);
  return out;
}

/// Keeps the people nearest to the arm.
template <class SomePerson>
LeftOut keep_nearest(std::vector<SomePerson>& people, std::size_t max, const Coverage& reach) {
  return keep_lowest(people, max, [&](const SomePerson& p) {
    return Rank{0, distance_to_arm(p, reach)};
  });
}

/// Returns for each body whether it is among the `max` nearest to the arm; all true without
/// `reach`.
std::vector<bool> nearest_of(const std::vector<ObservedPerson>& bodies, std::size_t max,
                             const Coverage* reach);

/// Keeps first the facts about safety and handovers, then about held objects, then all others;
/// within each class those about the nearest.
LeftOut keep_most_relevant(std::vector<Fact>& facts, std::size_t max, const Scene& scene,
                           const HumanState& people, const Coverage& reach);

/// The max of the counts reported by all sources within the last second.
class RecentCount {
 public:
  /// Adds a count; a smaller count replaces the max only after one second.
  void add(std::uint32_t count, TimePoint now) {
    if (count < count_ && to_seconds(now - at_) < kMemory) return;
    count_ = count;
    at_ = now;
  }
  /// Returns the max count; 0 if it is one second old.
  std::uint32_t get(TimePoint now) const { return to_seconds(now - at_) < kMemory ? count_ : 0; }

 private:
  static constexpr double kMemory = 1;  // duration for which a count is kept [s]
  std::uint32_t count_{};
  TimePoint at_{};
};

}  // namespace handsel::spark
