#include "components/spark/people_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/human_body.hpp"

namespace handsel::spark {
namespace {

// People move over the floor: the margin is horizontal.
bool contains(const Coverage& box, const Vector3& p, double margin) {
  const Eigen::Array3d m(margin, margin, 0);
  return (p.array() >= box.low.array() + m).all() && (p.array() <= box.high.array() - m).all();
}

std::optional<Vector3> observed_centre(const ObservedPerson& body) {
  Vector3 sum = Vector3::Zero();
  double weight = 0;
  for (const auto& joint : body.joints) {
    const double w = joint.confidence * (joint.name == "torso" || joint.name == "waist" || joint.name == "neck" ? 10.0 : 1.0);
    sum += w * joint.position;
    weight += w;
  }
  if (weight <= 0) return std::nullopt;
  return sum / weight;
}

Vector3 centre(const Person& person) {
  static const int torso = body_joint_index("torso");
  return person.joints[static_cast<std::size_t>(torso)].position;
}

}  // namespace

PeopleTracker::Track* PeopleTracker::associate(const ObservedPerson& body, const std::vector<bool>& taken) {
  const auto where = observed_centre(body);
  if (!where) return nullptr;
  Track* best = nullptr;
  double best_distance = settings_.association_distance();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (taken[i]) continue;
    Track& track = tracks_[i];
    const Vector3 gap = *where - centre(track.person);
    const double distance = std::hypot(gap.x(), gap.y()) - (track.body == body.body ? 0.3 : 0.0);
    if (distance < best_distance) {
      best = &track;
      best_distance = distance;
    }
  }
  if (best != nullptr) return best;
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    if (!taken[i] && !body.body.empty() && tracks_[i].body == body.body) return &tracks_[i];
  return nullptr;
}

void PeopleTracker::update(Track& track, const ObservedPerson& body, TimePoint seen) const {
  Person& person = track.person;
  const bool known = !person.joints.empty();
  const Person previous = person;
  std::vector<BodyJoint> fitted = fit_body(body, known ? &previous : nullptr, person.stature);
  const double dt = to_seconds(seen - track.seen);
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    fitted[i].velocity.setZero();
    if (!known || dt > 0.5) continue;
    if (dt <= 1e-4) {
      fitted[i].velocity = previous.joints[i].velocity;
      continue;
    }
    const Vector3 measured = (fitted[i].position - previous.joints[i].position) / dt;
    const double gain = dt / (dt + settings_.velocity_smoothing());
    fitted[i].velocity = previous.joints[i].velocity + gain * (measured - previous.joints[i].velocity);
  }
  person.joints = std::move(fitted);
  person.gaze_known = body.has_gaze;
  if (body.has_gaze) {
    person.gaze_origin = body.gaze_origin;
    person.gaze_direction = body.gaze_direction;
  }
  track.body = body.body;
  track.seen = seen;
}

void PeopleTracker::forget_seen_empty(const Coverage& coverage, TimePoint seen) {
  std::erase_if(tracks_, [&](const Track& track) {
    const double age = to_seconds(seen - track.seen);
    if (age <= settings_.lost_after()) return false;
    const double margin = settings_.lost_speed() * age;
    const auto& joints = track.person.joints;
    return std::all_of(joints.begin(), joints.end(), [&](const BodyJoint& j) { return contains(coverage, j.position, margin); });
  });
}

void PeopleTracker::observe(const HumanObservation& observation, TimePoint seen) {
  Source& source = sources_[observation.source];
  if (seen < source.seen) return;
  source = {observation.coverage, seen};

  std::vector<bool> taken(tracks_.size(), false);
  for (const auto& body : observation.people) {
    Track* track = associate(body, taken);
    if (track == nullptr) {
      if (!observed_centre(body)) continue;
      Track fresh;
      const bool name_free =
          !body.body.empty() && std::none_of(tracks_.begin(), tracks_.end(), [&](const Track& t) { return t.person.id == body.body; });
      fresh.person.id = name_free ? body.body : "person" + std::to_string(++unnamed_);
      fresh.seen = seen;
      tracks_.push_back(std::move(fresh));
      taken.push_back(false);
      track = &tracks_.back();
    }
    taken[static_cast<std::size_t>(track - tracks_.data())] = true;
    update(*track, body, seen);
  }
  forget_seen_empty(observation.coverage, seen);
}

HumanState PeopleTracker::state(TimePoint now, const Coverage& reach) const {
  HumanState out;
  for (const auto& track : tracks_) {
    Person person = track.person;
    person.age = std::max(0.0, to_seconds(now - track.seen));
    person.inflation = person.age > settings_.lost_after() ? settings_.lost_speed() * person.age : 0.0;
    out.people.push_back(std::move(person));
  }
  for (const auto& [name, source] : sources_) {
    const bool recent = to_seconds(now - source.seen) <= settings_.coverage_memory();
    if (recent && contains(source.coverage, reach.low, 0) && contains(source.coverage, reach.high, 0)) out.covered = true;
  }
  return out;
}

}  // namespace handsel::spark
