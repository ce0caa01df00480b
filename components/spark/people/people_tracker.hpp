// SPDX-License-Identifier: Apache-2.0
// Tracks people: merges bodies from several trackers to persistent people with complete, moving
// bodies. Pure.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/world.hpp"
#include "components/spark/people/track.hpp"
#include "components/spark/quotas.hpp"
#include "components/spark/sources.hpp"

namespace handsel::spark {

/// The observations of one person by all sources form one body: each joint has its newest
/// observation, and the gaze may be from another source. Ids of trackers are hints; positions
/// decide.
///
/// A lost person is never dropped (reliability requirement P3). The last body remains, inflated by
/// lost_speed x age, until sources have observed its volume empty for empty_after, the same person
/// is observed within the possible walking distance, or an operator clears the person. A body
/// nearer to the field-of-view boundary than `edge` when lost has left over the boundary or stands
/// unobserved next to it. Its inflation is at most `edge` while the source continues to observe,
/// because the source would observe a return; the next person who enters over the boundary is that
/// person.
///
/// Occupied space does not shrink by a jump. A jump too long for a person creates a second person,
/// and the first counts as lost; a shorter jump inflates the body by its length for doubt_time. The
/// volume of a lost person remains until several samples show the person. Duplicate data is not a
/// new observation. Own method, for requirement P3.
class PeopleTracker {
 public:
  /// `eyes`: viewpoint of each source, by name, world [m]; a source without viewpoint has no
  /// occlusion.
  explicit PeopleTracker(const settings::SparkSettings& settings,
                         std::map<std::string, Vector3> eyes = {})
      : settings_(settings), eyes_(std::move(eyes)) {}

  /// Takes an observation. `seen`: capture time (arrival less age). `latency`: age at arrival [s].
  /// A duplicate (same stamp, or same people) is ignored and does not make its source live. With
  /// `reach`, only the nearest bodies, by the quota, become new people; known people are tracked in
  /// any case. Returns the number of bodies that did not become a person.
  std::uint32_t observe(const HumanObservation& observation, TimePoint seen,
                        const Obstacles& obstacles = {}, const Coverage* reach = nullptr,
                        double latency = 0);
  /// Rejects an observation of unknown age; `why`: one sentence, for trouble().
  void refuse(const HumanObservation& observation, const std::string& why, TimePoint now);
  /// Deletes the lost person `id`, or all lost people if empty, by order of an operator. Observed
  /// people remain. Returns the number of deleted people.
  std::size_t clear(const std::string& id, TimePoint now);
  /// Adopts people lost by a previous SPARK process: last observed before `started`, with `age` at
  /// `now`. Each person is adopted once. A tracked person within the lost person's volume, with the
  /// same id or at the same place, is that person.
  void adopt(const std::vector<Person>& lost, TimePoint now, TimePoint started);
  /// Returns the state at `now`: all people with ages and inflation, and the views of all sources.
  /// `covered`: live sources observe the whole of `reach`. Writes the people left out by the quota
  /// to `left_out` unless null.
  HumanState state(TimePoint now, const Coverage& reach, LeftOut* left_out = nullptr) const;
  /// Deletes the people farthest from the arm beyond the quota of tracks. Returns the deleted
  /// people.
  LeftOut keep_nearest(TimePoint now, const Coverage& reach);
  /// Returns the number of ignored observations of sources beyond the quota.
  std::uint64_t refused_observations() const { return refused_observations_; }
  /// Returns the sources that are not live, with reasons; empty: none.
  std::string trouble(TimePoint now) const;

 private:
  std::vector<int> associate(const HumanObservation& observation, TimePoint seen) const;
  double inflation(const Track& track, TimePoint now) const;
  bool room_for_source(TimePoint seen);
  Source* find_source(const HumanObservation& observation, TimePoint seen);
  bool live(const Source& source, TimePoint now) const {
    return source.age(now) <= settings_.max_view_age;
  }
  bool recent(const Source& source, TimePoint now) const {
    return to_seconds(now - source.seen) <= settings_.coverage_memory;
  }
  bool seen_empty(const Track& track, TimePoint now, const Obstacles& obstacles) const;
  void confine(Track& track, TimePoint now) const;
  Track* successor(const Track& lost, TimePoint now);
  Track* re_entered(const Track& lost, TimePoint now);
  void erase(std::size_t index, Track* successor_track);
  Track* same_as(const Person& lost);
  void add(const ObservedPerson& body, const std::string& source, TimePoint seen);
  void forget(TimePoint now, const Obstacles& obstacles);

  settings::SparkSettings settings_;
  std::map<std::string, Vector3> eyes_;
  std::vector<Track> tracks_;
  std::map<std::string, Source> sources_;
  int unnamed_{0};
  std::uint64_t refused_observations_{0};
  std::set<std::string> adopted_;  // ids of all people adopted so far
};

}  // namespace handsel::spark
