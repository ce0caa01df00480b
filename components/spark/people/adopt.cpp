// SPDX-License-Identifier: Apache-2.0
// Adopts people who were lost by a previous SPARK process.
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

/// Returns the track of the same person: with the same id, or at the person's last position;
/// nullptr: none.
Track* PeopleTracker::same_as(const Person& lost) {
  ObservedPerson body;
  for (const BodyJoint& joint : lost.joints)
    body.joints.push_back({joint.name, joint.position, 1.0});
  Track* nearest = nullptr;
  double min_distance = settings_.association_distance;
  for (Track& track : tracks_) {
    if (track.person.joints.empty()) continue;
    const double d = distance(track, body);
    const double max_walk = settings_.association_distance + settings_.lost_speed * lost.age;
    if (track.person.id == lost.id && d <= max_walk) return &track;
    const bool is_assigned =
        track.adopted || std::any_of(tracks_.begin(), tracks_.end(),
                                     [&](const Track& t) { return t.person.id == lost.id; });
    if (is_assigned || d > min_distance) continue;
    nearest = &track;
    min_distance = d;
  }
  return nearest;
}

void PeopleTracker::adopt(const std::vector<Person>& lost, TimePoint now, TimePoint started) {
  for (const Person& person : lost) {
    // This process has observed the person.
    const bool is_observed_here = now - from_seconds(person.age) > started;
    if (is_observed_here || !is_complete(person) || !adopted_.insert(person.id).second) continue;
    if (Track* track = same_as(person)) {
      if (!track->adopted) track->person.id = person.id;
      continue;
    }
    Track lost_track;
    lost_track.person = person;
    lost_track.person.hands.clear();
    lost_track.person.gaze_known = false;
    if (std::any_of(tracks_.begin(), tracks_.end(),
                    [&](const Track& t) { return t.person.id == person.id; }))
      lost_track.person.id = "person" + std::to_string(++unnamed_);  // the id is in use
    lost_track.born = lost_track.seen = now - from_seconds(person.age);
    lost_track.adopted = true;
    tracks_.push_back(std::move(lost_track));
  }
}

}  // namespace handsel::spark
