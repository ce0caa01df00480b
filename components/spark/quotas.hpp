// How many people, objects, boxes and facts SPARK keeps, and which when there are more: the nearest
// and most relevant. Pure.
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

/// Settings of the same names.
struct Quotas {
  /// Largest numbers: bodies of an observation that become new people, tracks of people, people of
  /// a HumanState, sources of people, objects remembered, objects, boxes of a Scene, facts of
  /// Facts.
  std::size_t bodies{32}, tracks{64}, people{16}, sources{16}, known_objects{128}, objects{64},
      boxes{64}, facts{256};
};
/// Returns the quotas of the settings; their ranges are not checked.
Quotas quotas_of(const settings::SparkSettings& settings);
/// Refuses quotas that contradict each other. Throws ConfigError "file:line:key: ...".
void check_quotas(const settings::SparkSettings& settings, const SettingsText& text);

/// What a quota has left out.
struct LeftOut {
  std::uint32_t count{};  ///< 0: nothing
  /// Distance of the nearest one from the axis of the arm [m].
  double nearest{std::numeric_limits<double>::infinity()};
};

/// Horizontal distance from the axis to the sides of what the arm reaches [m].
double arm_radius(const Coverage& reach);
/// Distance of a point from the vertical axis in the middle of `reach` [m]; below and above the
/// axis from its end.
double distance_to_arm(const Vector3& point, const Coverage& reach);
/// Of the nearest joint, less the inflation of a lost person [m]; negative inside the inflated
/// body.
double distance_to_arm(const Person& person, const Coverage& reach);
/// Of the nearest joint, of the gaze origin for a body without joints [m]; infinity without either.
double distance_to_arm(const ObservedPerson& person, const Coverage& reach);
/// Of the box from the nearest of five points on the axis [m]; 0 when one is inside.
double distance_to_arm(const SceneBox& box, const Coverage& reach);

/// Place of something in the order in which it is kept: lower first.
struct Rank {
  int order{};        ///< kept in this order, then by distance
  double distance{};  ///< to the arm [m]
  friend auto operator<=>(const Rank&, const Rank&) = default;
};

/// Of an object: held by the robot, held by a person, wanted by the task, any other; the nearest
/// first.
Rank rank_of(const SceneObject& object, bool wanted, const Coverage& reach);

/// Keeps the `max` items of the lowest rank, in the order they have; of equal ranks the first.
/// `rank`: Rank of an item.
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

/// Keeps the people nearest to the arm. Nobody left out is nearer than anybody kept.
template <class SomePerson>
LeftOut keep_nearest(std::vector<SomePerson>& people, std::size_t max, const Coverage& reach) {
  return keep_lowest(people, max, [&](const SomePerson& p) {
    return Rank{0, distance_to_arm(p, reach)};
  });
}

/// Which of the bodies are the `max` nearest to the arm; all of them when `reach` is null.
std::vector<bool> nearest_of(const std::vector<ObservedPerson>& bodies, std::size_t max,
                             const Coverage* reach);

/// Keeps the facts about safety and exchanges first, then those about what is held, then the
/// others; of each kind those about the nearest.
LeftOut keep_most_relevant(std::vector<Fact>& facts, std::size_t max, const Scene& scene,
                           const HumanState& people, const Coverage& reach);

/// A count that sources report one after the other: the largest of the last second.
class RecentCount {
 public:
  /// Takes a count; a smaller one replaces the largest only after a second.
  void add(std::uint32_t count, TimePoint now) {
    if (count < count_ && to_seconds(now - at_) < kMemory) return;
    count_ = count;
    at_ = now;
  }
  /// Returns the count kept, 0 when it is a second old.
  std::uint32_t get(TimePoint now) const { return to_seconds(now - at_) < kMemory ? count_ : 0; }

 private:
  static constexpr double kMemory = 1;  // [s]
  std::uint32_t count_{};
  TimePoint at_{};
};

}  // namespace handsel::spark
