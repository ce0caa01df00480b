// What the sources of people have observed: their coverage, less what is hidden from where they
// stand. Pure.
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

/// What hides things from a source.
struct Obstacles {
  std::vector<SightCapsule> robot;  ///< of its links, world [m]
  std::vector<SightBox> boxes;      ///< fixed ones of the scene, world [m]
};

struct Source {
  Coverage coverage;  ///< box it reports to observe, world [m]
  bool ever{};        ///< an observation of known age has come
  TimePoint seen{};   ///< when its newest new observation was captured
  /// Since when it has looked without a gap longer than coverage_memory.
  TimePoint unbroken{};
  std::optional<Vector3> eye;          ///< viewpoint, world [m]; none: it sees all of its coverage
  std::vector<ObservedPerson> people;  ///< of its newest observation
  bool repeats{};                      ///< its last observation was the same as the one before
  Stamp stamp{};                       ///< of its newest observation
  /// From the capture of its newest observation to the arrival [s].
  double latency{};
  /// Why the age of its last observation is not known; empty: it is.
  std::string unknown_age;

  /// Since the capture of its newest new picture [s]; 1e9: there was none.
  double age(TimePoint now) const { return ever ? to_seconds(now - seen) : 1e9; }
};

/// Returns why the source is not live now, one sentence without its name; empty: it is. `max_age`:
/// of its newest new picture [s].
std::string why_not_active(const Source& source, TimePoint now, double max_age);

/// Returns what every source observes now; `max_age` as for why_not_active().
std::vector<SourceView> views_of(const std::map<std::string, Source>& sources, TimePoint now,
                                 double max_age);

/// Whether the point is inside, kept away from the sides by `margin` [m]; people move over the
/// floor: the margin is horizontal.
bool contains(const Coverage&, const Vector3& point, double margin);

/// Whether the union of the boxes contains the whole of `box`. Exact.
bool covers(const std::vector<Coverage>& boxes, const Coverage& box);

/// Whether the source looked at this point and nothing fixed or of the robot stood between.
bool looks_at(const Source&, const Obstacles&, const Vector3& point);

/// Returns whether a place is nearer the sides of what the source observes than `margin` [m], or
/// beyond; false for a source that observes nothing.
bool at_boundary(const Source& source, const Vector3& place, double margin);

}  // namespace handsel::spark
