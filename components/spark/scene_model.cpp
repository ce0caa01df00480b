// SPDX-License-Identifier: Apache-2.0
#include "components/spark/scene_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "components/spark/scene/holder_assignment.hpp"

namespace handsel::spark {
namespace {

bool differs(const Scene& a, const Scene& b, const settings::SparkSettings& settings) {
  if (a.objects.size() != b.objects.size() || a.boxes.size() != b.boxes.size() ||
      a.robot_known != b.robot_known)
    return true;
  for (std::size_t i = 0; i < a.boxes.size(); ++i)
    if (a.boxes[i].id != b.boxes[i].id) return true;
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    const auto &x = a.objects[i], &y = b.objects[i];
    if (x.id != y.id || x.model != y.model || x.holder != y.holder || x.holder_id != y.holder_id)
      return true;
    if (x.primitive.kind != y.primitive.kind || x.primitive.size != y.primitive.size) return true;
    if (std::abs(x.uncertainty - y.uncertainty) > settings.revision_uncertainty) return true;
    const bool carried = x.holder == Holder::robot;  // the pose follows from the hand's
    if (!carried && (x.T_world_object.translation() - y.T_world_object.translation()).norm() >
                        settings.revision_move)
      return true;
  }
  return false;
}

}  // namespace

SceneModel::SceneModel(const settings::SparkSettings& settings,
                       std::shared_ptr<const RobotModel> robot, ObjectLibrary objects,
                       std::vector<SceneBox> boxes)
    : settings_(settings),
      library_(std::move(objects)),
      boxes_(std::move(boxes)),
      robot_(std::move(robot)) {}

void SceneModel::observe(const ObjectObservation& observation, TimePoint seen) {
  robot_.locate();
  std::vector<ObservedObject> samples;
  for (ObservedObject observed : observation.objects) {
    if (select_shape(observed, library_)) {
      samples.push_back(std::move(observed));
      continue;
    }
    ++refused_;
    refused_at_ = seen;
    refusal_ = "object " + observed.id + " of source " + observation.source +
               (observed.model.empty() ? " has neither a model nor a primitive"
                                       : " is of model " + observed.model +
                                             ", which is not described, and has no primitive") +
               " with a size above 0";
  }
  apply_quota(samples);
  correct_swapped_ids(samples, objects_, seen, settings_);
  for (const ObservedObject& observed : samples) {
    ObjectTrack& track = objects_[observed.id];
    if (seen < track.seen || !accept_source(track, observed, observation.source, seen, settings_))
      continue;
    add_sample(track, observed, seen, settings_);
    if (robot_.known())
      track.T_palm_object =
          robot_.hands()[track.robot_hand].T_world_palm.inverse() * observed.T_world_object;
  }
  forget_least_relevant();
}

void SceneModel::request(const std::string& object) {
  constexpr std::size_t kMaxRequests = 8;
  if (object.empty() || std::find(requested_.begin(), requested_.end(), object) != requested_.end())
    return;
  requested_.push_back(object);
  if (requested_.size() > kMaxRequests) requested_.pop_front();
}

Rank SceneModel::rank(const SceneObject& object) const {
  return rank_of(object,
                 std::find(requested_.begin(), requested_.end(), object.id) != requested_.end(),
                 reach());
}

/// Reduces an observation to the quota of remembered objects.
void SceneModel::apply_quota(std::vector<ObservedObject>& seen) {
  const LeftOut left_out =
      keep_lowest(seen, quotas_of(settings_).known_objects, [&](const ObservedObject& observed) {
        SceneObject object;
        if (const auto known = objects_.find(observed.id); known != objects_.end())
          object.holder = known->second.object.holder;
        object.id = observed.id;
        object.T_world_object = observed.T_world_object;
        return rank(object);
      });
  forgotten_ += left_out.count;
}

void SceneModel::forget_least_relevant() {
  const std::size_t max = quotas_of(settings_).known_objects;
  if (objects_.size() <= max) return;
  std::vector<std::pair<Rank, std::string>> ranked;
  for (const auto& [id, known] : objects_) ranked.emplace_back(rank(known.object), id);
  std::sort(ranked.begin(), ranked.end());
  for (std::size_t i = max; i < ranked.size(); ++i) objects_.erase(ranked[i].second);
  forgotten_ += ranked.size() - max;
}

std::string SceneModel::left_out_in_reach() const {
  std::string out;
  for (const auto& [left_out, what] :
       {std::pair{&objects_left_out_, "objects"}, std::pair{&boxes_left_out_, "boxes"}}) {
    if (left_out->count == 0 || left_out->nearest > arm_radius(reach())) continue;
    char text[160];
    std::snprintf(
        text, sizeof text,
        "%u %s are left out of the scene, the nearest %.2f m from the robot and within its reach",
        left_out->count, what, left_out->nearest);
    out += (out.empty() ? "" : "; ") + std::string(text);
  }
  return out;
}

std::string SceneModel::trouble(TimePoint now) const {
  std::string left_out = left_out_in_reach();
  if (refused_ == 0 || to_seconds(now - refused_at_) > settings_.refusal_time) return left_out;
  return refusal_ + ": refused, " + std::to_string(refused_) + " so far" +
         (left_out.empty() ? "" : "; ") + left_out;
}

Scene SceneModel::scene(TimePoint now, const HumanState& people) {
  robot_.locate();
  std::erase_if(objects_, [&](const auto& entry) {
    const ObjectTrack& track = entry.second;
    return track.samples > 0 && track.object.holder == Holder::human &&
           to_seconds(now - track.seen) > settings_.unseen_after &&
           std::none_of(people.people.begin(), people.people.end(),
                        [&](const Person& p) { return p.id == track.object.holder_id; });
  });
  Scene out;
  out.robot_known = robot_.known();
  out.T_world_base = robot_.T_world_base();
  out.robot_position = robot_.position();
  out.boxes = boxes_;
  const HolderAssignment holders({settings_, library_, boxes_, robot_, people});
  for (auto& [id, track] : objects_) {
    track.object.age = std::max(0.0, to_seconds(now - track.seen));
    holders.attribute_grips(track);
    if (track.object.age > settings_.object_velocity_gap) track.object.velocity.setZero();
    if (!holders.carry(track)) holders.assign(track);
    update_uncertainty(track, people, now, settings_);
    SceneObject object = track.object;
    if (object.holder == Holder::robot && object.age > settings_.follow_hand_after)
      object.T_world_object = robot_.hands()[track.robot_hand].T_world_palm * track.T_palm_object;
    out.objects.push_back(std::move(object));
  }
  const Quotas quotas = quotas_of(settings_);
  objects_left_out_ = keep_lowest(out.objects, quotas.objects,
                                  [&](const SceneObject& object) { return rank(object); });
  boxes_left_out_ = keep_lowest(out.boxes, quotas.boxes, [&](const SceneBox& box) {
    return Rank{0, distance_to_arm(box, reach())};
  });
  out.left_out = objects_left_out_.count + boxes_left_out_.count;
  if (revision_ == 0 || differs(out, last_, settings_)) {
    ++revision_;
    last_ = out;
  }
  out.revision = revision_;
  return out;
}

const Obstacles& SceneModel::obstacles() {
  robot_.locate();
  if (capsules_.empty()) {
    capsules_ = robot_capsules(robot_.model());
    for (const SceneBox& box : boxes_) obstacles_.boxes.push_back({box.T_world_box, box.size});
  }
  obstacles_.robot.clear();
  for (const LinkCapsule& c : capsules_) {
    if (robot_.links().empty()) break;
    const Pose T = robot_.T_world_base() * robot_.links()[static_cast<std::size_t>(c.link)];
    obstacles_.robot.push_back({T * c.a, T * c.b, c.radius});
  }
  return obstacles_;
}

}  // namespace handsel::spark
