// People whom a SPARK before this one had lost from sight.
#include <algorithm>

#include "components/spark/people/people_tracker.hpp"

namespace handsel::spark {
namespace {

bool is_complete(const Person& person) {
  return std::equal(person.joints.begin(), person.joints.end(), kBodyJoints.begin(),
                    kBodyJoints.end(),
                    [](const BodyJoint& joint, const auto& name) { return joint.name == name; });
}

}  // namespace

/// Returns the track of the same person: the same id, or a body seen where they were last seen;
/// nullptr: there is none.
Track* PeopleTracker::same_as(const Person& lost) {
  ObservedPerson body;
  for (const BodyJoint& joint : lost.joints)
    body.joints.push_back({joint.name, joint.position, 1.0});
  Track* nearest = nullptr;
  double min_distance = settings_.association_distance;
  for (Track& track : tracks_) {
    if (track.person.joints.empty()) continue;
    const double away = distance(track, body);
    const double walked = settings_.association_distance + settings_.lost_speed * lost.age;
    if (track.person.id == lost.id && away <= walked) return &track;
    const bool taken =
        track.adopted || std::any_of(tracks_.begin(), tracks_.end(),
                                     [&](const Track& t) { return t.person.id == lost.id; });
    if (taken || away > min_distance) continue;
    nearest = &track;
    min_distance = away;
  }
  return nearest;
}

void PeopleTracker::adopt(const std::vector<Person>& lost, TimePoint now, TimePoint started) {
  for (const Person& person : lost) {
    const bool own = now - from_seconds(person.age) > started;  // this process has seen them
    if (own || !is_complete(person) || !adopted_.insert(person.id).second) continue;
    if (Track* track = same_as(person)) {
      if (!track->adopted) track->person.id = person.id;
      continue;
    }
    Track gone;
    gone.person = person;
    gone.person.hands.clear();
    gone.person.gaze_known = false;
    if (std::any_of(tracks_.begin(), tracks_.end(),
                    [&](const Track& t) { return t.person.id == person.id; }))
      gone.person.id = "person" + std::to_string(++unnamed_);  // somebody else is called so by now
    gone.born = gone.seen = now - from_seconds(person.age);
    gone.adopted = true;
    tracks_.push_back(std::move(gone));
  }
}

}  // namespace handsel::spark
