// Who is there: bodies from several trackers become persistent people with complete, moving bodies.
// Pure.
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

/// What all sources report about one person is one body: each joint is the newest sight of it, a
/// gaze may come from another source. Ids of the trackers are hints only; places decide.
///
/// A lost person is never gone (reliability promise P3): the last body stays, inflated by
/// lost_speed x age, until its volume has been seen empty (from where the sources stand) for
/// empty_after, the same person is seen as far away as they may have come, or an operator clears
/// them. A body that is nearer the field-of-view boundary than `edge` when lost has left through
/// it, or stands there unseen: it grows no farther than `edge` while the source continues to
/// observe, because a person who comes back is seen; whoever comes in over the boundary then is
/// that person.
///
/// Occupied space does not shrink by a jump: one too far for a person makes a second person, and
/// the first counts as lost; a shorter one inflates the body by its length for doubt_time. Where a
/// lost person may have been counts until several samples show them. Data reported twice is no
/// news. Own method, for promise P3.
class PeopleTracker {
 public:
  /// `eyes`: viewpoint of each source, by name [m]; without, a source sees all of its coverage.
  explicit PeopleTracker(const settings::SparkSettings& settings,
                         std::map<std::string, Vector3> eyes = {})
      : settings_(settings), eyes_(std::move(eyes)) {}

  /// `seen`: when the observation was captured (arrival less its age). `latency`: its age at
  /// arrival [s]. One whose stamp has not advanced, or that shows people exactly as before, is no
  /// news, and does not make its source live. Where `reach` is given, only the nearest bodies, by
  /// the quota, become new people; whoever is known already is followed all the same. Returns how
  /// many bodies became nobody.
  std::uint32_t observe(const HumanObservation& observation, TimePoint seen,
                        const Obstacles& obstacles = {}, const Coverage* reach = nullptr,
                        double latency = 0);
  /// An observation whose age is not known shows nothing; `why`: one sentence, for trouble().
  void refuse(const HumanObservation& observation, const std::string& why, TimePoint now);
  /// An operator says that a lost person is gone: `id`, or everybody lost when it is empty. Who is
  /// seen stays. How many went.
  std::size_t clear(const std::string& id, TimePoint now);
  /// Adopts people whom a SPARK before this one had lost: last seen before `started`, `age` counted
  /// from `now`. Each is adopted once. A person who is seen where the lost one may be, under the
  /// same id or at the same place, is that person.
  void adopt(const std::vector<Person>& lost, TimePoint now, TimePoint started);
  /// Everybody as of now, ages and inflation filled in, and what every source observes. `covered`:
  /// live sources observe the whole of `reach`. `left_out`, if not null: what the quota of people
  /// has left out.
  HumanState state(TimePoint now, const Coverage& reach, LeftOut* left_out = nullptr) const;
  /// Forgets the people farthest from the arm beyond the quota of tracks: nobody forgotten is
  /// nearer than anybody kept.
  LeftOut keep_nearest(TimePoint now, const Coverage& reach);
  /// Observations of sources beyond the quota, which were not taken.
  std::uint64_t refused_observations() const { return refused_observations_; }
  /// Which source is not live and why; empty: none.
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
  Track* successor(const Track& gone, TimePoint now);
  Track* re_entered(const Track& gone, TimePoint now);
  void erase(std::size_t index, Track* name_goes_to);
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
