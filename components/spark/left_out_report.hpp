// Reports what the quotas have left out: counts on the bus, and a sentence when it matters.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "components/spark/people/people_tracker.hpp"
#include "components/spark/quotas.hpp"
#include "components/spark/scene_model.hpp"

namespace handsel::spark {

/// Counts, by cause, what was left out of observations and messages.
class LeftOutReport {
 public:
  /// Receives what was left out, and how many of that.
  using Count = std::function<void(const std::string& what, std::uint64_t count)>;
  LeftOutReport(Count count, const Quotas& quotas) : count_(std::move(count)), quotas_(quotas) {}

  /// Counts the bodies of an observation that became nobody.
  void add_bodies(std::uint32_t count, TimePoint arrival);
  /// Counts the tracks that were forgotten, and observations of too many sources so far.
  void add_tracks(const LeftOut& tracks, const PeopleTracker& tracker);
  /// Adds the bodies left out lately to the state and counts. `people`: left out of the state.
  void add_people(const LeftOut& people, TimePoint now, HumanState& state);
  /// Counts what was left out of the last scene.
  void add_scene(const SceneModel& scene);
  /// Counts the facts left out of the last message.
  void add_facts(const Facts& facts);
  /// One sentence when people are left out within reach of the arm; empty: none.
  std::string people_in_reach(const Coverage& reach) const;

 private:
  void count_new(const std::string& what, std::uint64_t so_far, std::uint64_t& counted);

  Count count_;
  Quotas quotas_;
  RecentCount bodies_;  // of an observation
  LeftOut people_;      // of the last HumanState
  std::uint64_t observations_counted_{0}, objects_counted_{0};
};

}  // namespace handsel::spark
