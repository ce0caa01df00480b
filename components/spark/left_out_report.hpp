// SPDX-License-Identifier: Apache-2.0
// Reports the elements left out by quotas: counts on the bus, and a sentence about people in reach.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "components/spark/people/people_tracker.hpp"
#include "components/spark/quotas.hpp"
#include "components/spark/scene_model.hpp"

namespace handsel::spark {

/// Counts, by cause, the elements left out of observations and messages.
class LeftOutReport {
 public:
  /// Receives the kind and the number to add to its count.
  using Count = std::function<void(const std::string& what, std::uint64_t count)>;
  LeftOutReport(Count count, const Quotas& quotas) : count_(std::move(count)), quotas_(quotas) {}

  /// Counts the bodies of an observation that did not become a person.
  void add_bodies(std::uint32_t count, TimePoint arrival);
  /// Counts the deleted tracks, and the observations of sources beyond the quota.
  void add_tracks(const LeftOut& tracks, const PeopleTracker& tracker);
  /// Adds the bodies left out within the last second to state.left_out and counts the sum.
  /// `people`: left out of the state; kept for people_in_reach().
  void add_people(const LeftOut& people, TimePoint now, HumanState& state);
  /// Counts the objects and boxes left out of the newest scene, in full at each call, and the
  /// objects forgotten since the last call.
  void add_scene(const SceneModel& scene);
  /// Counts the facts left out of the last message.
  void add_facts(const Facts& facts);
  /// Returns one sentence if people within reach of the arm are left out; empty: none.
  std::string people_in_reach(const Coverage& reach) const;

 private:
  void count_new(const std::string& what, std::uint64_t so_far, std::uint64_t& counted);

  Count count_;
  Quotas quotas_;
  RecentCount bodies_;  // left out of observations
  LeftOut people_;      // left out of the last HumanState
  std::uint64_t observations_counted_{0}, objects_counted_{0};
};

}  // namespace handsel::spark
