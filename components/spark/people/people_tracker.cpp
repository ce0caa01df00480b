#include "components/spark/people/people_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace handsel::spark {
namespace {

constexpr double kSameId = 0.15;  // a body with the id they had is preferred by this [m]
constexpr double kPause = 0.3;    // under another id a person comes back no farther than walked [s]
constexpr double kGrid = 0.3;     // places of a lost person are tried this far apart [m]
constexpr double kFarthest = 5;   // and no farther than this [m]
constexpr double kWidest = 4;     // max extent of a body: beyond, joints are not compared [m]
constexpr double kMaxInflation = 1000;  // farther than any robot; HumanState has room for 10 km [m]

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

/// A body of which only the gaze is known is where its eyes are.
ObservedPerson with_head(const ObservedPerson& body) {
  ObservedPerson out = body;
  if (out.joints.empty() && out.has_gaze) out.joints.push_back({"head", body.gaze_origin, 0.5});
  return out;
}

Vector3 middle_of(const ObservedPerson& body) {
  Vector3 sum = Vector3::Zero();
  for (const ObservedJoint& joint : body.joints) sum += joint.position;
  return body.joints.empty() ? sum : Vector3(sum / static_cast<double>(body.joints.size()));
}

}  // namespace

/// For every body of the observation the track it is of, or -1: the nearest pairs first.
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
      const double reach = settings_.association_distance +
                           settings_.lost_speed * (same_id ? gap : std::min(gap, kPause));
      if ((middle - position(track.person, kTorso)).head<2>().norm() > reach + kWidest) continue;
      const double d = distance(track, body);
      if (d <= reach)
        pairs.emplace_back(d - (same_id ? kSameId : 0.0), static_cast<int>(b), static_cast<int>(t));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<int> of(observation.people.size(), -1);
  std::vector<bool> taken(tracks_.size(), false);
  for (const auto& [cost, b, t] : pairs) {
    if (of[static_cast<std::size_t>(b)] >= 0 || taken[static_cast<std::size_t>(t)]) continue;
    of[static_cast<std::size_t>(b)] = t;
    taken[static_cast<std::size_t>(t)] = true;
  }
  return of;
}

void PeopleTracker::add(const ObservedPerson& body, const std::string& source, TimePoint seen) {
  if (body.joints.empty()) return;
  Track fresh;
  const bool name_free =
      !body.body.empty() && std::none_of(tracks_.begin(), tracks_.end(),
                                         [&](const Track& t) { return t.person.id == body.body; });
  fresh.person.id = name_free ? body.body : "person" + std::to_string(++unnamed_);
  fresh.born = fresh.seen = seen;
  fresh.bodies[source] = body.body;
  const auto from = sources_.find(source);
  update(fresh, body, seen, 0, settings_);
  if (fresh.person.joints.empty()) return;
  fresh.came_in = from != sources_.end() &&
                  at_boundary(from->second, position(fresh.person, kTorso), settings_.edge);
  tracks_.push_back(std::move(fresh));
}

/// Whether a person anywhere in the grown volume would show head or chest to a source.
bool PeopleTracker::seen_empty(const Track& track, TimePoint now,
                               const Obstacles& obstacles) const {
  const double radius = settings_.lost_speed * track.age(now);
  if (radius > kFarthest) return false;
  const auto shows = [&](const Vector3& shift) {
    return std::any_of(sources_.begin(), sources_.end(), [&](const auto& entry) {
      const Source& source = entry.second;
      return live(source, now) && source.seen > track.seen && !source.repeats &&
             (looks_at(source, obstacles, position(track.person, kHead) + shift) ||
              looks_at(source, obstacles, position(track.person, kTorso) + shift));
    });
  };
  if (!shows(Vector3::Zero())) return false;
  const int rings = std::max(1, static_cast<int>(std::ceil(radius / kGrid)));
  for (int ring = rings; ring > 0; --ring) {
    const double r = radius * ring / rings;
    const int around = std::max(8, static_cast<int>(std::ceil(2 * M_PI * r / kGrid)));
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * M_PI * i / around;
      if (!shows(r * Vector3(std::cos(angle), std::sin(angle), 0))) return false;
    }
  }
  return true;
}

/// Confines a person who was lost near the boundary of a source's coverage, or beyond, if the
/// source has observed without a gap since. After a gap its coverage counts as seen empty of the
/// person after empty_after.
void PeopleTracker::confine(Track& track, TimePoint now) const {
  for (const auto& [name, source] : sources_) {
    if (!track.left_by.empty()) break;
    // An adopted person was lost before this process began to observe: empty_after without a
    // gap stands for the time before.
    const bool observed_on =
        source.unbroken <= track.seen ||
        (track.adopted && to_seconds(source.seen - source.unbroken) >= settings_.empty_after);
    const bool watched = recent(source, now) && source.seen > track.seen && observed_on;
    if (watched && at_boundary(source, position(track.person, kTorso), settings_.edge))
      track.left_by = name, track.confined = source.seen;
  }
  const auto found = sources_.find(track.left_by);
  if (found == sources_.end()) return;
  const Source& source = found->second;
  if (source.unbroken <= track.confined ||
      to_seconds(source.seen - source.unbroken) >= settings_.empty_after)
    track.confined = std::max(track.confined, source.seen);
}

/// Returns the person who appeared since, as near as the lost one may have come or with the same
/// id.
Track* PeopleTracker::successor(const Track& gone, TimePoint now) {
  Track* out = nullptr;
  const double walked = settings_.association_distance + settings_.lost_speed * gone.age(now);
  double nearest = std::numeric_limits<double>::infinity();
  for (Track& other : tracks_) {
    const double d = (position(other.person, kTorso) - position(gone.person, kTorso)).norm();
    const bool called_so =
        std::any_of(other.bodies.begin(), other.bodies.end(), [&](const auto& body) {
          const auto before = gone.bodies.find(body.first);
          return before != gone.bodies.end() && before->second == body.second;
        });
    if (&other == &gone || other.born <= gone.seen || d >= nearest || (d > walked && !called_so))
      continue;
    out = &other;
    nearest = d;
  }
  return out;
}

/// Returns the person who came in over a boundary since, as near as the one who left may have come.
Track* PeopleTracker::re_entered(const Track& gone, TimePoint now) {
  if (gone.left_by.empty() || gone.age(now) <= settings_.doubt_time) return nullptr;
  Track* other = successor(gone, now);
  if (other == nullptr || !other->came_in) return nullptr;
  const double walked = settings_.association_distance + settings_.lost_speed * gone.age(now);
  return (position(other->person, kTorso) - position(gone.person, kTorso)).norm() <= walked
             ? other
             : nullptr;
}

void PeopleTracker::erase(std::size_t index, Track* name_goes_to) {
  if (name_goes_to != nullptr) {
    name_goes_to->person.id = tracks_[index].person.id;
    name_goes_to->came_in = false;
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

/// The source of the observation, known from now on; nullptr: there is no room for it.
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
  const bool first = !std::exchange(source.ever, true);
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
    source.unbroken = seen;
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

/// How far a lost or doubted person may be from the last body [m].
double PeopleTracker::inflation(const Track& track, TimePoint now) const {
  double out = 0;
  const double unseen = std::max(0.0, track.age(now));
  if (unseen > settings_.lost_after) {
    out = std::min(kMaxInflation, settings_.lost_speed * unseen);
    if (!track.left_by.empty())
      out = std::min(out, settings_.edge + settings_.lost_speed *
                                               std::max(0.0, to_seconds(now - track.confined)));
  }
  return now < track.doubted_until ? std::max(out, track.doubt) : out;
}

LeftOut PeopleTracker::keep_nearest(TimePoint now, const Coverage& reach) {
  const auto rank = [&](const Track& track) {
    return Rank{0, distance_to_arm(track.person, reach) - inflation(track, now)};
  };
  return keep_lowest(tracks_, quotas_of(settings_).tracks, rank);
}

/// Whether a new source is listened to: at the quota it takes the place of the one that has been
/// silent for longest.
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
    if (person.age <= settings_.lost_after) person.hands = hands_ahead(track, person, now);
    out.people.push_back(std::move(person));
  }
  std::vector<Coverage> observed;
  for (const auto& [name, source] : sources_)
    if (live(source, now)) observed.push_back(source.coverage);
  out.views = views_of(sources_, now, settings_.max_view_age);
  out.covered = covers(observed, reach);
  const LeftOut left_out = spark::keep_nearest(out.people, quotas_of(settings_).people, reach);
  out.left_out = left_out.count;
  out.covered = out.covered && left_out.nearest >= kFarthest;
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
