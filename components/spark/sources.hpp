// SPDX-License-Identifier: Apache-2.0
// Sources of people: coverage, newest observation and visibility. Pure.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/line_of_sight.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/world.hpp"

namespace handsel::spark {

/// Bodies that occlude points from a source.
struct Obstacles {
  std::vector<SightCapsule> robot;  ///< capsules of the robot's links, world [m]
  std::vector<SightBox> boxes;      ///< fixed boxes of the scene, world [m]
};

struct Source {
  Coverage coverage;    ///< box that the source claims to observe, world [m]
  bool has_observed{};  ///< whether an observation of known age has arrived
  TimePoint seen{};     ///< capture time of the newest distinct observation
  /// Begin of the present observation without a gap longer than coverage_memory.
  TimePoint continuous_since{};
  std::optional<Vector3> eye;          ///< viewpoint, world [m]; nullopt: no occlusion
  std::vector<ObservedPerson> people;  ///< people of the newest observation
  bool repeats{};                      ///< whether the last observation equals the previous
  Stamp stamp{};                       ///< stamp of the newest observation
  /// Time from capture to arrival of the newest observation [s].
  double latency{};
  /// Why the age of the last observation is unknown; empty: known.
  std::string unknown_age;

  /// Returns the time since the capture of the newest distinct observation [s]; 1e9: none.
  double age(TimePoint now) const { return has_observed ? to_seconds(now - seen) : 1e9; }
};

/// Returns why the source is not live, one sentence without its name; empty: live. `max_age`: max
/// age of the newest distinct observation [s].
std::string why_not_active(const Source& source, TimePoint now, double max_age);

/// Returns the present views of all sources; `max_age` as for why_not_active().
std::vector<SourceView> views_of(const std::map<std::string, Source>& sources, TimePoint now,
                                 double max_age);

/// Returns whether the point is inside with at least a horizontal `margin` to the sides [m].
bool contains(const Coverage&, const Vector3& point, double margin);

/// Returns whether the union of the boxes contains the whole of `box`; exact.
bool covers(const std::vector<Coverage>& boxes, const Coverage& box);

/// Returns whether the source observes the point: covered, and not occluded by fixed boxes or
/// robot.
bool observes(const Source&, const Obstacles&, const Vector3& point);

/// Returns whether a place is nearer to the sides of the source's coverage than `margin` [m], or
/// outside; false for a source without coverage.
bool at_boundary(const Source& source, const Vector3& place, double margin);

}  // namespace handsel::spark
