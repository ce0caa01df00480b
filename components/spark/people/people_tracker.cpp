#include "components/spark/people/people_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "common/cost/human_cost.hpp"

namespace handsel::spark {
namespace {

constexpr double kSameId = 0.15;     // a body with the id they had is preferred by this [m]
constexpr double kPause = 0.3;       // under another id a person comes back no farther than they walk in this time [s]
constexpr double kFresh = 0.1;       // sights of joints this much apart are one body [s]
constexpr double kFastest = 2.2;     // [m/s]
constexpr double kSettled = 0.08;    // a body moves by this between two looks without a doubt [m]
constexpr double kConfirmed = 0.15;  // where a lost person may have been counts so long after the first look [s]
constexpr double kGapOfHand = 0.5;   // beyond this a hand's motion is found anew [s]
constexpr double kLeastConfidence = 0.05;
constexpr double kGuessed = 3;          // a joint that was not seen is this much noisier
constexpr double kGrid = 0.3;           // places of a lost person are tried this far apart [m]
constexpr double kFarthest = 5;         // and no farther than this [m]
constexpr double kWidest = 4;           // no joints of a body are farther apart: beyond, two bodies need not be compared joint by joint [m]
constexpr double kMaxInflation = 1000;  // farther than any robot; HumanState has room for 10 km [m]
constexpr int kAheads = 5;              // looks ahead at a hand
constexpr double kAhead = 0.1;          // this far apart [s]

int index(const char* name) { return body_joint_index(name); }
const int kHead = index("head"), kTorso = index("torso");
const std::array kHands = {index("l_hand"), index("r_hand")}, kWrists = {index("l_wrist"), index("r_wrist")},
                 kShoulders = {index("l_shoulder"), index("r_shoulder")};
const std::array kTrunkMiddle = {index("neck"), index("torso"), index("waist"), index("l_shoulder"), index("r_shoulder")};
const std::vector<const char*> kLimbs[] = {{"l_shoulder", "l_elbow", "l_wrist", "l_hand"},
                                           {"r_shoulder", "r_elbow", "r_wrist", "r_hand"},
                                           {"l_hip", "l_knee", "l_ankle"},
                                           {"r_hip", "r_knee", "r_ankle"}};

const Vector3& position(const Person& person, int joint) { return person.joints[static_cast<std::size_t>(joint)].position; }

bool same(const std::vector<ObservedPerson>& a, const std::vector<ObservedPerson>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ObservedPerson& x, const ObservedPerson& y) {
    return x.gaze_direction == y.gaze_direction &&
           std::equal(x.joints.begin(), x.joints.end(), y.joints.begin(), y.joints.end(),
                      [](const ObservedJoint& j, const ObservedJoint& k) { return j.name == k.name && j.position == k.position; });
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

double PeopleTracker::distance(const Track& track, const ObservedPerson& body) const {
  Vector3 sum = Vector3::Zero();
  double weight = 0;
  for (const ObservedJoint& joint : body.joints) {
    const int i = body_joint_index(joint.name);
    if (i < 0 || !joint.position.allFinite()) continue;
    const double w = joint.confidence * (of_trunk(static_cast<std::size_t>(i)) ? 5 : 1);
    sum += w * (joint.position - position(track.person, i));
    weight += w;
  }
  return weight > 0 ? std::hypot(sum.x(), sum.y()) / weight : std::numeric_limits<double>::infinity();
}

/// For every body of the observation the track it is of, or -1: the nearest pairs first.
std::vector<int> PeopleTracker::associate(const HumanObservation& observation, TimePoint seen) const {
  std::vector<std::tuple<double, int, int>> pairs;
  for (std::size_t b = 0; b < observation.people.size(); ++b) {
    const ObservedPerson body = with_head(observation.people[b]);
    const Vector3 middle = middle_of(body);
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      const Track& track = tracks_[t];
      const auto known = track.bodies.find(observation.source);
      const bool same_id = known != track.bodies.end() && known->second == body.body;
      const double gap = std::max(0.0, age(track, seen));
      const double reach = settings_.association_distance() + settings_.lost_speed() * (same_id ? gap : std::min(gap, kPause));
      if ((middle - position(track.person, kTorso)).head<2>().norm() > reach + kWidest) continue;
      const double d = distance(track, body);
      if (d <= reach) pairs.emplace_back(d - (same_id ? kSameId : 0.0), static_cast<int>(b), static_cast<int>(t));
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

/// What was never seen of a body: as it hangs from what was, once that tells which way the body faces. The first look may have told it
/// wrong.
void PeopleTracker::guess_unseen(const Track& track, std::vector<BodyJoint>& body) const {
  const auto seen = [&](const char* joint) { return track.joint_seen[static_cast<std::size_t>(index(joint))].has_value(); };
  const auto at = [&](const std::vector<BodyJoint>& b, const char* joint) -> Vector3 {
    return b[static_cast<std::size_t>(index(joint))].position;
  };
  const bool shoulders = seen("l_shoulder") && seen("r_shoulder");
  if (!shoulders && !(seen("l_hip") && seen("r_hip"))) return;
  const Vector3 left = shoulders ? at(body, "l_shoulder") - at(body, "r_shoulder") : at(body, "l_hip") - at(body, "r_hip");
  const auto model = standing_body(Vector3::Zero(), std::atan2(-left.x(), left.y()), track.person.stature);
  const Vector3 trunk = shoulders ? at(body, "l_shoulder") + at(body, "r_shoulder") - at(model, "l_shoulder") - at(model, "r_shoulder")
                                  : at(body, "l_hip") + at(body, "r_hip") - at(model, "l_hip") - at(model, "r_hip");
  for (const char* joint : {"head", "neck", "torso", "waist", "l_shoulder", "r_shoulder", "l_hip", "r_hip"})
    if (!seen(joint)) body[static_cast<std::size_t>(index(joint))].position = at(model, joint) + trunk / 2;
  for (const auto& limb : kLimbs) {
    if (std::any_of(limb.begin() + 1, limb.end(), seen)) continue;
    for (auto joint = limb.begin() + 1; joint != limb.end(); ++joint)
      body[static_cast<std::size_t>(index(*joint))].position = at(body, limb.front()) + at(model, *joint) - at(model, limb.front());
  }
}

void PeopleTracker::update(Track& track, const ObservedPerson& body, TimePoint seen, double jump) const {
  if (body.has_gaze && (!track.gaze_seen || seen >= *track.gaze_seen)) {
    track.person.gaze_origin = body.gaze_origin;
    track.person.gaze_direction = body.gaze_direction;
    track.gaze_seen = seen;
  }
  Person& person = track.person;
  const bool known = !person.joints.empty();
  if (body.joints.empty()) return;

  // A slower source tells of an earlier instant: what nobody saw since counts, moved on to now.
  const TimePoint at = known ? std::max(seen, track.seen) : seen;
  const double behind = to_seconds(at - seen);
  if (behind > kFresh) return;
  ObservedPerson merged = body;
  merged.joints.clear();
  std::array<bool, kJoints> told{};
  for (const ObservedJoint& joint : body.joints) {
    const int i = body_joint_index(joint.name);
    if (i < 0 || !(joint.confidence >= kLeastConfidence)) continue;
    const auto k = static_cast<std::size_t>(i);
    if (track.joint_seen[k] && *track.joint_seen[k] > seen) continue;
    merged.joints.push_back(joint);
    if (behind > 0) merged.joints.back().position += behind * person.joints[k].velocity;
    track.joint_seen[k] = seen;
    told[k] = true;
  }
  if (merged.joints.empty()) return;
  const double dt = known ? to_seconds(at - track.seen) : 0.0;
  std::array<bool, kJoints> lately{};  // told by another look
  for (std::size_t i = 0; known && i < kJoints; ++i) {
    if (told[i] || !track.joint_seen[i] || to_seconds(at - *track.joint_seen[i]) > kFresh) continue;
    merged.joints.push_back({kBodyJoints[i], person.joints[i].position + dt * person.joints[i].velocity, 0.5});
    lately[i] = true;
  }
  track.size.see(body);
  const double known_height = height(person.id);
  person.stature = known_height > 0 ? known_height : track.size.stature();
  const Person previous = person;
  std::vector<BodyJoint> fitted = fit_body(merged, known ? &previous : nullptr, person.stature);
  if (fitted.empty()) return;
  guess_unseen(track, fitted);
  std::array<double, kJoints> noise{};
  for (std::size_t i = 0; i < kJoints; ++i) noise[i] = lately[i] ? 0.0 : settings_.joint_noise() * (told[i] ? 1.0 : kGuessed);
  track.motion.update(fitted, noise, at);
  const auto doubt = [&](double by, double time) {
    track.doubt = seen < track.doubted_until ? track.doubt + by : by;
    track.doubted_until = std::max(track.doubted_until, seen + from_seconds(time));
  };
  if (known && dt > settings_.lost_after())
    doubt(settings_.lost_speed() * dt + jump, kConfirmed);
  else if (known && jump > kFastest * (dt + behind) + kSettled)
    doubt(jump, settings_.doubt_time());
  person.joints = std::move(fitted);
  follow_hands(track, told, at);
  track.seen = at;
  track.empty_since.reset();
  track.left_by.clear();
  track.adopted = false;
}

/// A wrist tells where the hand is as well.
void PeopleTracker::follow_hands(Track& track, const std::array<bool, kJoints>& told, TimePoint at) const {
  Vector3 trunk = Vector3::Zero();
  for (const int joint : kTrunkMiddle) trunk += position(track.person, joint) / static_cast<double>(kTrunkMiddle.size());
  for (std::size_t side = 0; side < kHands.size(); ++side) {
    if (!told[static_cast<std::size_t>(kHands[side])] && !told[static_cast<std::size_t>(kWrists[side])]) continue;
    const Vector3& hand = position(track.person, kHands[side]);
    std::optional<TimePoint>& last = track.hand_seen[side];
    const double dt = last ? to_seconds(at - *last) : kGapOfHand;
    if (dt >= kGapOfHand)
      track.hands[side].reset(hand, trunk, settings_.joint_noise());
    else if (dt > 1e-4)
      track.hands[side].update(hand, trunk, dt, settings_.joint_noise());
    else
      continue;
    last = at;
  }
}

/// The balls reach no farther from the shoulder than the arm, wherever that may have gone.
std::vector<HandPrediction> PeopleTracker::hands_ahead(const Track& track, const Person& person, TimePoint now) const {
  std::vector<HandPrediction> out;
  for (std::size_t side = 0; side < kHands.size(); ++side) {
    if (!track.hand_seen[side]) continue;
    const double since = std::max(0.0, to_seconds(now - *track.hand_seen[side]));
    HandPrediction hand{kBodyJoints[static_cast<std::size_t>(kHands[side])], {}};
    for (int k = 1; k <= kAheads; ++k) {
      const HandPredictor::Ball ball = track.hands[side].at(since + k * kAhead);
      const double arm = (ball.centre - position(person, kShoulders[side])).norm() + arm_length(person) + kFastest * (since + k * kAhead);
      hand.ahead.push_back({k * kAhead, ball.centre, std::min(ball.radius, arm) + person.inflation});
    }
    out.push_back(std::move(hand));
  }
  return out;
}

void PeopleTracker::add(const ObservedPerson& body, const std::string& source, TimePoint seen) {
  if (body.joints.empty()) return;
  Track fresh;
  const bool name_free =
      !body.body.empty() && std::none_of(tracks_.begin(), tracks_.end(), [&](const Track& t) { return t.person.id == body.body; });
  fresh.person.id = name_free ? body.body : "person" + std::to_string(++unnamed_);
  fresh.born = fresh.seen = seen;
  fresh.bodies[source] = body.body;
  const auto from = sources_.find(source);
  update(fresh, body, seen, 0);
  if (fresh.person.joints.empty()) return;
  fresh.came_in = from != sources_.end() && at_edge(from->second, position(fresh.person, kTorso));
  tracks_.push_back(std::move(fresh));
}

/// By the profile; 0: it says nothing.
double PeopleTracker::height(const std::string& id) const {
  for (const config::PersonProfile& one : settings_.people())
    if (one.id() == id) return one.height();
  return 0;
}

/// Whether a person anywhere in the grown volume would show head or chest to a source.
bool PeopleTracker::seen_empty(const Track& track, TimePoint now, const Obstacles& obstacles) const {
  const double radius = settings_.lost_speed() * age(track, now);
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

bool PeopleTracker::at_edge(const Source& source, const Vector3& place) const {
  const bool looks = (source.coverage.low.array() < source.coverage.high.array()).all();
  return looks && !contains(source.coverage, place, settings_.edge());
}

/// Who was lost near the edge of a source's coverage, or beyond, and it has looked on since. When it looks again after a gap, what it looks
/// at is seen empty of them after empty_after.
void PeopleTracker::confine(Track& track, TimePoint now) const {
  for (const auto& [name, source] : sources_) {
    if (!track.left_by.empty()) break;
    // Who was adopted was lost before this process began to look: a look of empty_after without a gap stands for the time before.
    const bool looked_on =
        source.unbroken <= track.seen || (track.adopted && to_seconds(source.seen - source.unbroken) >= settings_.empty_after());
    const bool watched = recent(source, now) && source.seen > track.seen && looked_on;
    if (watched && at_edge(source, position(track.person, kTorso))) track.left_by = name, track.confined = source.seen;
  }
  const auto found = sources_.find(track.left_by);
  if (found == sources_.end()) return;
  const Source& source = found->second;
  if (source.unbroken <= track.confined || to_seconds(source.seen - source.unbroken) >= settings_.empty_after())
    track.confined = std::max(track.confined, source.seen);
}

/// Who appeared since, as near as the lost one may have come or with the id they had.
PeopleTracker::Track* PeopleTracker::heir(const Track& gone, TimePoint now) {
  Track* out = nullptr;
  const double walked = settings_.association_distance() + settings_.lost_speed() * age(gone, now);
  double least = std::numeric_limits<double>::infinity();
  for (Track& other : tracks_) {
    const double d = (position(other.person, kTorso) - position(gone.person, kTorso)).norm();
    const bool called_so = std::any_of(other.bodies.begin(), other.bodies.end(), [&](const auto& body) {
      const auto before = gone.bodies.find(body.first);
      return before != gone.bodies.end() && before->second == body.second;
    });
    if (&other == &gone || other.born <= gone.seen || d >= least || (d > walked && !called_so)) continue;
    out = &other;
    least = d;
  }
  return out;
}

/// Who came in through an edge since, as near as the one who left may have come by then.
PeopleTracker::Track* PeopleTracker::comer(const Track& gone, TimePoint now) {
  if (gone.left_by.empty() || age(gone, now) <= settings_.doubt_time()) return nullptr;
  Track* other = heir(gone, now);
  if (other == nullptr || !other->came_in) return nullptr;
  const double walked = settings_.association_distance() + settings_.lost_speed() * age(gone, now);
  return (position(other->person, kTorso) - position(gone.person, kTorso)).norm() <= walked ? other : nullptr;
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
    if (age(track, now) <= settings_.lost_after()) continue;
    confine(track, now);
    const bool empty = seen_empty(track, now, obstacles);
    if (!empty) track.empty_since.reset();
    if (empty && !track.empty_since) track.empty_since = now;
    if (empty && to_seconds(now - *track.empty_since) >= settings_.empty_after())
      erase(i, heir(track, now));
    else if (Track* other = comer(track, now))
      erase(i, other);
  }
}

/// The source of the observation, known from now on; nullptr: there is no room for it.
Source* PeopleTracker::find_source(const HumanObservation& observation, TimePoint seen) {
  if (!sources_.contains(observation.source) && !room_for_source(seen)) return nullptr;
  const auto [entry, first] = sources_.try_emplace(observation.source);
  if (!first) return &entry->second;
  entry->second.coverage = observation.coverage;
  if (const auto eye = eyes_.find(observation.source); eye != eyes_.end()) entry->second.eye = eye->second;
  return &entry->second;
}

void PeopleTracker::refuse(const HumanObservation& observation, const std::string& why, TimePoint now) {
  if (Source* source = find_source(observation, now)) source->unknown_age = why;
}

std::uint32_t PeopleTracker::observe(const HumanObservation& observation, TimePoint seen, const Obstacles& obstacles, const Coverage* reach,
                                     double latency) {
  Source* const found = find_source(observation, seen);
  if (found == nullptr) return 0;
  Source& source = *found;
  const bool first = !std::exchange(source.ever, true);
  source.unknown_age.clear();
  const bool same_stamp = observation.stamp != 0 && observation.stamp == source.stamp;
  if (!same_stamp && !first && seen < source.seen) return 0;
  source.repeats = !first && (same_stamp || (!observation.people.empty() && same(observation.people, source.people)));
  if (source.repeats) return 0;
  source.stamp = observation.stamp;
  source.latency = latency;
  const bool moved = source.coverage.low != observation.coverage.low || source.coverage.high != observation.coverage.high;
  if (first || moved || to_seconds(seen - source.seen) > settings_.coverage_memory()) source.unbroken = seen;
  source.coverage = observation.coverage;
  source.seen = seen;
  source.people = observation.people;

  const std::vector<int> of = associate(observation, seen);
  for (std::size_t b = 0; b < of.size(); ++b) {
    if (of[b] < 0) continue;
    Track& track = tracks_[static_cast<std::size_t>(of[b])];
    const ObservedPerson& body = observation.people[b];
    track.bodies[observation.source] = body.body;
    update(track, body, seen, body.joints.empty() ? 0.0 : distance(track, body));
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
  return std::erase_if(
      tracks_, [&](const Track& track) { return age(track, now) > settings_.lost_after() && (id.empty() || track.person.id == id); });
}

/// How far a lost or doubted person may be from the last body [m].
double PeopleTracker::inflation(const Track& track, TimePoint now) const {
  double out = 0;
  const double unseen = std::max(0.0, age(track, now));
  if (unseen > settings_.lost_after()) {
    out = std::min(kMaxInflation, settings_.lost_speed() * unseen);
    if (!track.left_by.empty())
      out = std::min(out, settings_.edge() + settings_.lost_speed() * std::max(0.0, to_seconds(now - track.confined)));
  }
  return now < track.doubted_until ? std::max(out, track.doubt) : out;
}

LeftOut PeopleTracker::keep_nearest(TimePoint now, const Coverage& reach) {
  const auto rank = [&](const Track& track) { return Rank{0, distance_to_arm(track.person, reach) - inflation(track, now)}; };
  return keep_lowest(tracks_, quotas_of(settings_).tracks, rank);
}

/// Whether a new source is listened to: at the quota it takes the place of the one that has been silent for longest.
bool PeopleTracker::room_for_source(TimePoint seen) {
  if (sources_.size() < quotas_of(settings_).sources) return true;
  const auto oldest =
      std::min_element(sources_.begin(), sources_.end(), [](const auto& a, const auto& b) { return a.second.seen < b.second.seen; });
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
    person.age = std::max(0.0, age(track, now));
    person.gaze_known = track.gaze_seen && to_seconds(now - *track.gaze_seen) <= settings_.gaze_memory();
    person.inflation = inflation(track, now);
    if (person.age <= settings_.lost_after()) person.hands = hands_ahead(track, person, now);
    out.people.push_back(std::move(person));
  }
  std::vector<Coverage> looked_at;
  for (const auto& [name, source] : sources_)
    if (live(source, now)) looked_at.push_back(source.coverage);
  out.views = views(now);
  out.covered = covers(looked_at, reach);
  const LeftOut left_out = spark::keep_nearest(out.people, quotas_of(settings_).people, reach);
  out.left_out = left_out.count;
  out.covered = out.covered && left_out.nearest >= kFarthest;
  if (report != nullptr) *report = left_out;
  return out;
}

std::vector<SourceView> PeopleTracker::views(TimePoint now) const {
  constexpr double kMaxAge = 1e9;  // HumanState has room for [s]
  std::vector<SourceView> out;
  for (const auto& [name, source] : sources_) {
    const std::string why = why_not_live(source, now, settings_.max_view_age());
    out.push_back({name, source.coverage.low, source.coverage.high, std::clamp(source.age(now), 0.0, kMaxAge), why.empty(), why});
  }
  return out;
}

std::string PeopleTracker::trouble(TimePoint now) const {
  std::string out;
  for (const auto& [name, source] : sources_) {
    const std::string why = why_not_live(source, now, settings_.max_view_age());
    if (!why.empty()) out += (out.empty() ? "source " : "; source ") + name + " " + why;
  }
  return out;
}

}  // namespace handsel::spark
