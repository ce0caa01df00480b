// Who is there: bodies from trackers become persistent people with complete, moving bodies. Pure.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/spark.pb.h"
#include "common/messages/world.hpp"

namespace handsel::spark {

/// A lost person is never gone (reliability promise P3): the last body stays, inflated by lost_speed x age, until its volume is seen empty
/// or the person is seen elsewhere.
class PeopleTracker {
 public:
  explicit PeopleTracker(const config::SparkSettings& settings) : settings_(settings) {}

  /// `seen`: when the observation was true (arrival less its age).
  void observe(const HumanObservation& observation, TimePoint seen);
  /// Everybody as of now, ages and inflation filled in. `covered`: some source looked at the whole of `reach` lately.
  HumanState state(TimePoint now, const Coverage& reach) const;

 private:
  struct Track {
    Person person;
    std::string body;  // the tracker's id when last seen
    TimePoint seen{};
  };
  struct Source {
    Coverage coverage;
    TimePoint seen{};
  };

  Track* associate(const ObservedPerson& body, const std::vector<bool>& taken);
  void update(Track& track, const ObservedPerson& body, TimePoint seen) const;
  void forget_seen_empty(const Coverage& coverage, TimePoint seen);

  config::SparkSettings settings_;
  std::vector<Track> tracks_;
  std::map<std::string, Source> sources_;
  int unnamed_{0};
};

}  // namespace handsel::spark
