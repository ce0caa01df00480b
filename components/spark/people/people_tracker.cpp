// SPDX-License-Identifier: Apache-2.0
#include "components/spark/people/people_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace handsel::spark {
namespace {

constexpr double kMaxTestRadius = 5;    // max radius of the tested volume of a lost person [m]
constexpr double kMaxBodyExtent = 4;    // max extent of a body; farther bodies are not compared [m]
constexpr double kMaxInflation = 1000;  // max inflation, beyond any robot's reach [m]

const int kHead = body_joint_index("head"), kTorso = body_joint_index("torso");

const Vector3& position(const Person& person, int joint) {
  return person.joints[static_cast<std::size_t>(joint)].position;
}

bool same(const std::vector<ObservedPerson>& a, const std::vector<ObservedPerson>& b) {
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(), [](const ObservedPerson& x, const ObservedPerson& y) {
        return x.gaze_direction == y.gaze_direction &&
               std::equal(x.joints.begin(), x.joints.end(), y.joints.begin(), y.joints.end(),
                          [](const ObservedJoint& j, const ObservedJoint& k) {
                            return j.name == k.name && j.position == k.position;
                          });
      });
}

/// Returns the body with a head at the gaze origin if of the body only the gaze was observed.
ObservedPerson with_head(const ObservedPerson& body) {
  ObservedPerson out = body;
  const auto is_of_body = [](const ObservedJoint& j) { return body_joint_index(j.name) >= 0; };
  if (std::none_of(out.joints.begin(), out.joints.end(), is_of_body) && out.has_gaze)
    out.joints.push_back({"head", body.gaze_origin, 0.5});
  return out;
}

Vector3 middle_of(const ObservedPerson& body) {
  Vector3 sum = Vector3::Zero();
  for (const ObservedJoint& joint : body.joints) sum += joint.position;
  return body.joints.empty() ? sum : Vector3(sum / static_cast<double>(body.joints.size()));
}

}  // namespace

/// Returns the track of each body of the observation, or -1; assigns the nearest pairs first.
std::vector<int> PeopleTracker::associate(const HumanObservation& observation,
                                          TimePoint seen) const {
  std::vector<std::tuple<double, int, int>> pairs;
  for (std::size_t b = 0; b < observation.people.size(); ++b) {
    const ObservedPerson body = with_head(observation.people[b]);
    const Vector3 middle = middle_of(body);
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      const Track& track = tracks_[t];
      const auto known = track.bodies.find(observation.source);
      const bool same_id = known != track.bodies.end() && known->second == body.body;
      const double gap = std::max(0.0, track.age(seen));
      const double reach =
          settings_.association_distance +
          settings_.lost_speed * (same_id ? gap : std::min(gap, settings_.max_other_id_gap));
      if ((middle - position(track.person, kTorso)).head<2>().norm() > reach + kMaxBodyExtent)
        continue;
      const double d = distance(track, body);
      if (d <= reach)
        pairs.emplace_back(d - (same_id ? settings_.same_id_distance : 0.0), static_cast<int>(b),
                           static_cast<int>(t));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<int> of(observation.people.size(), -1);
  std::vector<bool> assigned(tracks_.size(), false);
  for (const auto& [cost, b, t] : pairs) {
    if (of[static_cast<std::size_t>(b)] >= 0 || assigned[static_cast<std::size_t>(t)]) continue;
    of[static_cast<std::size_t>(b)] = t;
    assigned[static_cast<std::size_t>(t)] = true;
  }
  return of;
}

void PeopleTracker::add(const ObservedPerson& body, const std::string& source, TimePoint seen) {
  if (body.joints.empty()) return;
  Track track;
  const bool name_free =
      !body.body.empty() && std::none_of(tracks_.begin(), tracks_.end(),
                                         [&](const Track& t) { return t.person.id == body.body; });
  track.person.id = name_free ? body.body : "person" + std::to_string(++unnamed_);
  track.born = track.seen = seen;
  track.bodies[source] = body.body;
  const auto from = sources_.find(source);
  update(track, body, seen, 0, settings_);
  if (track.person.joints.empty()) return;
  track.entered_at_boundary =
      from != sources_.end() &&
      at_boundary(from->second, position(track.person, kTorso), settings_.edge);
  tracks_.push_back(std::move(track));
}

/// Returns whether sources observe head or torso at all tested places of the inflated volume, so
/// that a person there would be observed.
bool PeopleTracker::seen_empty(const Track& track, TimePoint now,
                               const Obstacles& obstacles) const {
  const double radius = settings_.lost_speed * track.age(now);
  if (radius > kMaxTestRadius) return false;
  const auto is_observed_at = [&](const Vector3& shift) {
    return std::any_of(sources_.begin(), sources_.end(), [&](const auto& entry) {
      const Source& source = entry.second;
      return live(source, now) && source.seen > track.seen && !source.repeats &&
             (observes(source, obstacles, position(track.person, kHead) + shift) ||
              observes(source, obstacles, position(track.person, kTorso) + shift));
    });
  };
  if (!is_observed_at(Vector3::Zero())) return false;
  const int rings = std::max(1, static_cast<int>(std::ceil(radius / settings_.lost_grid)));
  for (int ring = rings; ring > 0; --ring) {
    const double r = radius * ring / rings;
    const int count = std::max(8, static_cast<int>(std::ceil(2 * M_PI * r / settings_.lost_grid)));
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * M_PI * i / count;
      if (!is_observed_at(r * Vector3(std::cos(angle), std::sin(angle), 0))) return false;
    }
  }
  return true;
}

/// Confines a person lost near the boundary of a source's coverage, or outside, if the source has
/// observed without a gap since. After a gap the coverage counts as empty after empty_after.
void PeopleTracker::confine(Track& track, TimePoint now) const {
  for (const auto& [name, source] : sources_) {
    if (!track.left_by.empty()) break;
    // An adopted person was lost before the start of this process: an observation of empty_after
    // without a gap replaces the earlier time.
    const bool is_continuous =
        source.continuous_since <= track.seen ||
        (track.adopted &&
         to_seconds(source.seen - source.continuous_since) >= settings_.empty_after);
    const bool is_observed = recent(source, now) && source.seen > track.seen && is_continuous;
    if (is_observed && at_boundary(source, position(track.person, kTorso), settings_.edge))
      track.left_by = name, track.confined = source.seen;
  }
  const auto found = sources_.find(track.left_by);
  if (found == sources_.end()) return;
  const Source& source = found->second;
  if (source.continuous_since <= track.confined ||
      to_seconds(source.seen - source.continuous_since) >= settings_.empty_after)
    track.confined = std::max(track.confined, source.seen);
}

/// Returns the nearest person who appeared after the loss, within the possible walking distance or
/// with the same id.
Track* PeopleTracker::successor(const Track& lost, TimePoint now) {
  Track* out = nullptr;
  const double max_walk = settings_.association_distance + settings_.lost_speed * lost.age(now);
  double min_distance = std::numeric_limits<double>::infinity();
  for (Track& other : tracks_) {
    const double d = (position(other.person, kTorso) - position(lost.person, kTorso)).norm();
    const bool same_id =
        std::any_of(other.bodies.begin(), other.bodies.end(), [&](const auto& body) {
          const auto before = lost.bodies.find(body.first);
          return before != lost.bodies.end() && before->second == body.second;
        });
    if (&other == &lost || other.born <= lost.seen || d >= min_distance ||
        (d > max_walk && !same_id))
      continue;
    out = &other;
    min_distance = d;
  }
  return out;
}

/// Returns the person who entered over a boundary after the loss, within the walking distance of
/// the person who left.
Track* PeopleTracker::re_entered(const Track& lost, TimePoint now) {
  if (lost.left_by.empty() || lost.age(now) <= settings_.doubt_time) return nullptr;
  Track* other = successor(lost, now);
  if (other == nullptr || !other->entered_at_boundary) return nullptr;
  const double max_walk = settings_.association_distance + settings_.lost_speed * lost.age(now);
  return (position(other->person, kTorso) - position(lost.person, kTorso)).norm() <= max_walk
             ? other
             : nullptr;
}

void PeopleTracker::erase(std::size_t index, Track* successor_track) {
  if (successor_track != nullptr) {
    successor_track->person.id = tracks_[index].person.id;
    successor_track->entered_at_boundary = false;
  }
  tracks_.erase(tracks_.begin() + static_cast<std::ptrdiff_t>(index));
}

void PeopleTracker::forget(TimePoint now, const Obstacles& obstacles) {
  for (std::size_t i = tracks_.size(); i-- > 0;) {
    Track& track = tracks_[i];
    if (track.age(now) <= settings_.lost_after) continue;
    confine(track, now);
    const bool empty = seen_empty(track, now, obstacles);
    if (!empty) track.empty_since.reset();
    if (empty && !track.empty_since) track.empty_since = now;
    if (empty && to_seconds(now - *track.empty_since) >= settings_.empty_after)
      erase(i, successor(track, now));
    else if (Track* other = re_entered(track, now))
      erase(i, other);
  }
}

/// Returns the source of the observation, adding it if new; nullptr: the quota is reached.
Source* PeopleTracker::find_source(const HumanObservation& observation, TimePoint seen) {
  if (!sources_.contains(observation.source) && !room_for_source(seen)) return nullptr;
  const auto [entry, first] = sources_.try_emplace(observation.source);
  if (!first) return &entry->second;
  entry->second.coverage = observation.coverage;
  if (const auto eye = eyes_.find(observation.source); eye != eyes_.end())
    entry->second.eye = eye->second;
  return &entry->second;
}

void PeopleTracker::refuse(const HumanObservation& observation, const std::string& why,
                           TimePoint now) {
  if (Source* source = find_source(observation, now)) source->unknown_age = why;
}

std::uint32_t PeopleTracker::observe(const HumanObservation& observation, TimePoint seen,
                                     const Obstacles& obstacles, const Coverage* reach,
                                     double latency) {
  Source* const found = find_source(observation, seen);
  if (found == nullptr) return 0;
  Source& source = *found;
  const bool first = !std::exchange(source.has_observed, true);
  source.unknown_age.clear();
  const bool same_stamp = observation.stamp != 0 && observation.stamp == source.stamp;
  if (!same_stamp && !first && seen < source.seen) return 0;
  source.repeats =
      !first &&
      (same_stamp || (!observation.people.empty() && same(observation.people, source.people)));
  if (source.repeats) return 0;
  source.stamp = observation.stamp;
  source.latency = latency;
  const bool moved = source.coverage.low != observation.coverage.low ||
                     source.coverage.high != observation.coverage.high;
  if (first || moved || to_seconds(seen - source.seen) > settings_.coverage_memory)
    source.continuous_since = seen;
  source.coverage = observation.coverage;
  source.seen = seen;
  source.people = observation.people;

  const std::vector<int> of = associate(observation, seen);
  for (std::size_t b = 0; b < of.size(); ++b) {
    if (of[b] < 0) continue;
    Track& track = tracks_[static_cast<std::size_t>(of[b])];
    const ObservedPerson& body = observation.people[b];
    track.bodies[observation.source] = body.body;
    update(track, body, seen, body.joints.empty() ? 0.0 : distance(track, body), settings_);
  }
  const std::vector<bool> near = nearest_of(observation.people, quotas_of(settings_).bodies, reach);
  std::uint32_t left_out = 0;
  for (std::size_t b = 0; b < of.size(); ++b) {
    if (of[b] >= 0) continue;
    if (near[b])
      add(with_head(observation.people[b]), observation.source, seen);
    else
      ++left_out;
  }
  forget(seen, obstacles);
  return left_out;
}

std::size_t PeopleTracker::clear(const std::string& id, TimePoint now) {
  return std::erase_if(tracks_, [&](const Track& track) {
    return track.age(now) > settings_.lost_after && (id.empty() || track.person.id == id);
  });
}

/// Returns the max distance of a lost or uncertain person from the last body [m].
double PeopleTracker::inflation(const Track& track, TimePoint now) const {
  double out = 0;
  const double unseen = std::max(0.0, track.age(now));
  if (unseen > settings_.lost_after) {
    out = std::min(kMaxInflation, settings_.lost_speed * unseen);
    if (!track.left_by.empty())
      out = std::min(out, settings_.edge + settings_.lost_speed *
                                               std::max(0.0, to_seconds(now - track.confined)));
  }
  return now < track.extra_until ? std::max(out, track.extra_inflation) : out;
}

LeftOut PeopleTracker::keep_nearest(TimePoint now, const Coverage& reach) {
  const auto rank = [&](const Track& track) {
    return Rank{0, distance_to_arm(track.person, reach) - inflation(track, now)};
  };
  return keep_lowest(tracks_, quotas_of(settings_).tracks, rank);
}

/// Returns whether a new source may be added: at the quota it replaces the source that has been
/// silent for the longest time.
bool PeopleTracker::room_for_source(TimePoint seen) {
  if (sources_.size() < quotas_of(settings_).sources) return true;
  const auto oldest =
      std::min_element(sources_.begin(), sources_.end(),
                       [](const auto& a, const auto& b) { return a.second.seen < b.second.seen; });
  if (recent(oldest->second, seen) || eyes_.contains(oldest->first)) {
    ++refused_observations_;
    return false;
  }
  for (Track& track : tracks_) track.bodies.erase(oldest->first);
  sources_.erase(oldest);
  return true;
}

HumanState PeopleTracker::state(TimePoint now, const Coverage& reach, LeftOut* report) const {
  HumanState out;
  for (const Track& track : tracks_) {
    Person person = track.person;
    person.age = std::max(0.0, track.age(now));
    person.gaze_known =
        track.gaze_seen && to_seconds(now - *track.gaze_seen) <= settings_.gaze_memory;
    person.inflation = inflation(track, now);
    if (person.age <= settings_.lost_after)
      person.hands = hands_ahead(track, person, now, settings_);
    person.palms = palms_of(track, now, settings_);
    out.people.push_back(std::move(person));
  }
  std::vector<Coverage> observed;
  for (const auto& [name, source] : sources_)
    if (live(source, now)) observed.push_back(source.coverage);
  out.views = views_of(sources_, now, settings_.max_view_age);
  out.covered = covers(observed, reach);
  const LeftOut left_out = spark::keep_nearest(out.people, quotas_of(settings_).people, reach);
  out.left_out = left_out.count;
  out.covered = out.covered && left_out.nearest >= kMaxTestRadius;
  if (report != nullptr) *report = left_out;
  return out;
}

std::string PeopleTracker::trouble(TimePoint now) const {
  std::string out;
  for (const auto& [name, source] : sources_) {
    const std::string why = why_not_active(source, now, settings_.max_view_age);
    if (!why.empty()) out += (out.empty() ? "source " : "; source ") + name + " " + why;
  }
  return out;
}

}  // namespace handsel::spark
