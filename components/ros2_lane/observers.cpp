// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/observers.hpp"

#include <algorithm>

#include "common/model/human/human_body.hpp"
#include "common/model/human/palm.hpp"

namespace handsel::ros2_lane {
namespace {

constexpr std::size_t kMaxBodies = 256;  // bound of an observation; SPARK tracks the nearest
constexpr std::size_t kMinJoints = 3;    // min joints: other frames may be called e.g. "head_tilt"

Vector3 corner(const settings::Vec3& p) { return {p.x, p.y, p.z}; }

/// Returns the names of the joints of a body and of its knuckles.
std::vector<const char*> frame_names() {
  std::vector<const char*> names(kBodyJoints.begin(), kBodyJoints.end());
  for (const Knuckles& hand : kKnuckles) names.insert(names.end(), {hand.index, hand.pinky});
  return names;
}

}  // namespace

std::optional<BodyFrame> body_frame(const std::string& frame) {
  static const std::vector<const char*> names = frame_names();
  for (const char* joint : names) {
    const std::string begin = std::string(joint) + "_";
    if (frame.starts_with(begin) && frame.size() > begin.size())
      return BodyFrame{joint, frame.substr(begin.size())};
  }
  return std::nullopt;
}

void PeopleObserver::on(const ros2::Transform& transform) {
  const auto frame = body_frame(transform.child);
  if (!frame || frame->body.size() > 64) return;
  if (bodies_.size() >= kMaxBodies && !bodies_.contains(frame->body)) return;
  bodies_[frame->body].insert(frame->joint);
}

void PeopleObserver::on(const ros2::Ids& ids, TimePoint arrival) {
  tracked_ = std::set<std::string>(ids.ids.begin(), ids.ids.end());
  tracked_at_ = arrival;
}

std::optional<HumanObservation> PeopleObserver::observe(const TfTree& tree, TimePoint now,
                                                        bool knuckles) {
  HumanObservation out;
  out.source = settings_.people_source;
  out.coverage = {corner(settings_.coverage_low), corner(settings_.coverage_high)};
  const Duration age = from_seconds(settings_.people_age);
  const bool listed = tracked_ && to_seconds(now - tracked_at_) <= settings_.tracked_age;
  for (auto body = bodies_.begin(); body != bodies_.end();) {
    const auto& [id, joints] = *body;
    ObservedPerson person;
    person.body = id;
    bool fresh = false;
    for (const std::string& joint : joints) {
      const auto place = tree.find(joint + "_" + id, settings_.world_frame);
      if (!place || now - place->arrival > age) continue;
      fresh = true;
      if (!knuckles && is_knuckle(joint)) continue;
      const bool shoulders = joint == "torso";  // in ROS4HRI
      if (shoulders && joints.contains("neck")) continue;
      person.joints.push_back({shoulders ? "neck" : joint, place->T_root_frame.translation(), 1.0});
      out.stamp = std::max(out.stamp, place->stamp);
    }
    if (!fresh) {
      body = bodies_.erase(body);
      continue;
    }
    const auto of_hands = std::count_if(joints.begin(), joints.end(), is_knuckle);
    if (joints.size() >= kMinJoints + static_cast<std::size_t>(of_hands) &&
        (!listed || tracked_->contains(id)))
      out.people.push_back(std::move(person));
    ++body;
  }
  if (out.people.empty() && !(listed && tracked_->empty())) return std::nullopt;
  if (!out.people.empty() && out.stamp <= reported_) return std::nullopt;
  reported_ = std::max(reported_, out.stamp);
  return out;
}

std::optional<ObjectObservation> ObjectsObserver::observe(const TfTree& tree, TimePoint now) const {
  ObjectObservation out;
  out.source = settings_.objects_source;
  for (const settings::ObjectFrame& frame : settings_.objects) {
    const auto place = tree.find(frame.frame, settings_.world_frame);
    if (!place || now - place->arrival > from_seconds(settings_.people_age)) continue;
    ObservedObject object;
    object.id = frame.id.empty() ? frame.frame : frame.id;
    object.model = frame.model;
    object.T_world_object = place->T_root_frame;
    object.confidence = 1;
    out.objects.push_back(std::move(object));
    out.stamp = std::max(out.stamp, place->stamp);
  }
  if (out.objects.empty()) return std::nullopt;
  return out;
}

}  // namespace handsel::ros2_lane
