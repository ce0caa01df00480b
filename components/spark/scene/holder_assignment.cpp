// SPDX-License-Identifier: Apache-2.0
#include "components/spark/scene/holder_assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/human/human_body.hpp"
#include "common/model/object_extent.hpp"
#include "components/spark/directed.hpp"

namespace handsel::spark {
namespace {

/// Returns the distance of a palm from an object [m]: from its bounding box, plus half the smallest
/// side of the box. The centre of a long object may be far from a hand that holds one end.
double palm_distance(const Vector3& p_palm, const ObjectModel& model, const Pose& T_world_object) {
  const Eigen::AlignedBox3d box = object_extent(&model, {});
  return box.exteriorDistance(T_world_object.inverse() * p_palm) + box.sizes().minCoeff() / 2;
}

}  // namespace

/// Returns the box under the object with at most `gap` [m] between top and bottom; nullptr: none.
const SceneBox* HolderAssignment::support_under(const SceneObject& object, double gap) const {
  const ObjectModel* model = in_.library ? in_.library(object.model) : nullptr;
  const Eigen::AlignedBox3d box = object_extent(nullptr, object.primitive);
  if (model == nullptr && box.isEmpty()) return nullptr;
  double bottom = std::numeric_limits<double>::max();
  const auto reach = [&](const Vector3& v) {
    bottom = std::min(bottom, (object.T_world_object * v).z());
  };
  if (model != nullptr)
    for (const auto& v : model->mesh.vertices) reach(v);
  else
    for (int i = 0; i < 8; ++i) reach(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  for (const auto& support : in_.boxes) {
    if (!support.supports) continue;
    const Vector3 p = support.T_world_box.inverse() * object.T_world_object.translation();
    const double top = support.T_world_box.translation().z() + support.size.z() / 2;
    if (std::abs(bottom - top) <= gap && std::abs(p.x()) <= support.size.x() / 2 &&
        std::abs(p.y()) <= support.size.y() / 2)
      return &support;
  }
  return nullptr;
}

// The nearest hand causes a measured grip.
void HolderAssignment::attribute_grips(ObjectTrack& track) const {
  track.object.grips.clear();
  for (const ObservedGrip& measured : track.grips) {
    ObjectGrip grip{"", measured.force};
    double min_distance = in_.settings.grip_distance;
    const auto claim = [&](const std::string& person, const Vector3& hand) {
      const double distance = (hand - measured.position).norm();
      if (distance >= min_distance) return;
      min_distance = distance;
      grip.person = person;
    };
    for (const Person& person : in_.people.people)
      for (const char* hand : {"l_hand", "r_hand"})
        claim(person.id, person.joints[static_cast<std::size_t>(body_joint_index(hand))].position);
    for (const RobotPlacement::Hand& hand : in_.robot.hands())
      if (in_.robot.known()) claim(kRobotName, hand.T_world_palm.translation());
    track.object.grips.push_back(std::move(grip));
  }
}

/// Assigns the holder by the object's force sensors: the holder remains until the grip is lost,
/// then the max grip force decides. Returns false if nobody grips the object.
bool HolderAssignment::assign_by_grip(SceneObject& object) const {
  const ObjectGrip* strongest = nullptr;
  const std::string now = object.holder == Holder::robot ? kRobotName : object.holder_id;
  for (const ObjectGrip& grip : object.grips) {
    if (grip.person.empty()) continue;
    const bool is_holder =
        object.holder >= Holder::robot && grip.person == now && grip.force > in_.settings.grip_lost;
    if (is_holder) return true;
    if (grip.force > in_.settings.grip_force &&
        (strongest == nullptr || grip.force > strongest->force))
      strongest = &grip;
  }
  if (strongest == nullptr) return false;
  object.holder = strongest->person == kRobotName ? Holder::robot : Holder::human;
  object.holder_id = strongest->person == kRobotName ? "" : strongest->person;
  return true;
}

/// Returns the robot hand that holds the object: the present holder while it measures some of the
/// load, else the hand with the max load.
std::optional<std::size_t> HolderAssignment::loaded_hand(const ObjectTrack& track) const {
  const ObjectModel* model = in_.library ? in_.library(track.object.model) : nullptr;
  if (model == nullptr || !in_.robot.known()) return std::nullopt;
  std::optional<std::size_t> strongest;
  double total_load = 0;
  for (std::size_t i = 0; i < in_.robot.hands().size(); ++i) {
    const RobotPlacement::Hand& hand = in_.robot.hands()[i];
    const double reach = track.object.holder == Holder::robot ? in_.settings.robot_hold_range
                                                              : in_.settings.robot_take_range;
    if (!(palm_distance(hand.T_world_palm.translation(), *model, track.object.T_world_object) <
          reach))
      continue;
    total_load += hand.payload;
    if (!strongest || hand.payload > in_.robot.hands()[*strongest].payload) strongest = i;
  }
  if (!strongest || !(total_load > in_.settings.held_load_ratio * model->mass)) return std::nullopt;
  const RobotPlacement::Hand& before = in_.robot.hands()[track.robot_hand];
  const bool is_same_holder = track.object.holder == Holder::robot &&
                              before.payload > in_.settings.kept_load_ratio * model->mass;
  return is_same_holder ? track.robot_hand : *strongest;
}

/// Returns whether a hand of the person who holds the object is still on it; the object may touch a
/// surface.
bool HolderAssignment::is_in_hand_of_holder(const SceneObject& object) const {
  if (object.holder != Holder::human || !object.grips.empty()) return false;
  const ObjectModel* model = in_.library ? in_.library(object.model) : nullptr;
  const Eigen::AlignedBox3d box = object_extent(model, object.primitive);
  if (box.isEmpty()) return false;
  const auto distance = [&](const Person& person, const char* hand) {
    return box.exteriorDistance(object.T_world_object.inverse() * joint_of(person, hand).position);
  };
  return std::any_of(in_.people.people.begin(), in_.people.people.end(), [&](const Person& person) {
    return person.id == object.holder_id &&
           std::min(distance(person, "l_hand"), distance(person, "r_hand")) <=
               in_.settings.holding_distance;
  });
}

/// Returns whether the fingers of the robot hand that held the object still enclose it without a
/// measured load, because a person also carries the object.
bool HolderAssignment::is_in_closed_hand(const ObjectTrack& track) const {
  if (track.object.holder != Holder::robot || !track.robot_grip) return false;
  const RobotPlacement::Hand& hand = in_.robot.hands()[track.robot_hand];
  const RobotGrip& grip = *track.robot_grip;
  if (hand.fingers.size() == 0 || hand.fingers.size() != grip.fingers.size()) return false;
  const Vector3 p_palm_object =
      hand.T_world_palm.inverse() * track.object.T_world_object.translation();
  return (hand.fingers - grip.fingers).cwiseAbs().maxCoeff() < in_.settings.hand_opened &&
         (p_palm_object - grip.p_palm_object).norm() < in_.settings.holding_distance;
}

void HolderAssignment::assign(ObjectTrack& track) const {
  SceneObject& object = track.object;
  if (assign_by_grip(object)) return;
  const Vector3 p_world = object.T_world_object.translation();
  const std::optional<std::size_t> by = loaded_hand(track);
  const bool robot_holds = by.has_value();
  if (robot_holds && *by != track.robot_hand) {
    track.robot_hand = *by;
    track.T_palm_object = in_.robot.hands()[*by].T_world_palm.inverse() * object.T_world_object;
  }
  if (!robot_holds && is_in_hand_of_holder(object)) return;
  if (const SceneBox* box = support_under(
          object, robot_holds ? in_.settings.min_lift_gap : in_.settings.support_gap)) {
    object.holder = Holder::surface;
    object.holder_id = box->id;
    return;
  }
  if (robot_holds) {
    const RobotPlacement::Hand& hand = in_.robot.hands()[*by];
    object.holder = Holder::robot;
    object.holder_id = hand.name;
    track.robot_grip = RobotGrip{hand.fingers, hand.T_world_palm.inverse() * p_world};
    return;
  }
  if (is_in_closed_hand(track)) return;
  const ObjectModel* model = in_.library ? in_.library(object.model) : nullptr;
  const Eigen::AlignedBox3d box = object_extent(model, object.primitive);
  // A hand at the end of a long object is far from the origin, but near to the box.
  const auto distance_of = [&](const Vector3& p_hand) {
    const double from_origin = (p_hand - p_world).norm();
    if (box.isEmpty()) return from_origin;
    const double from_box = box.exteriorDistance(object.T_world_object.inverse() * p_hand);
    return std::min(from_origin,
                    from_box + in_.settings.near_distance - in_.settings.holding_distance);
  };
  double min_distance = in_.settings.near_distance;
  for (const auto& person : in_.people.people) {
    if (!object.grips.empty()) break;  // the rest applies only without measured grips
    for (const char* hand : {"l_hand", "r_hand"}) {
      const double distance = distance_of(joint_of(person, hand).position);
      if (distance > min_distance) continue;
      min_distance = distance;
      object.holder = Holder::human;
      object.holder_id = person.id;
    }
  }
  const bool human_released =
      object.holder == Holder::human && min_distance >= in_.settings.near_distance;
  const bool robot_released = object.holder == Holder::robot || object.holder == Holder::surface;
  if (min_distance >= in_.settings.near_distance && (human_released || robot_released)) {
    object.holder = Holder::nobody;
    object.holder_id.clear();
  }
}

bool HolderAssignment::carry(ObjectTrack& track) const {
  SceneObject& object = track.object;
  if (object.holder != Holder::human) return false;
  const auto person = std::find_if(in_.people.people.begin(), in_.people.people.end(),
                                   [&](const Person& p) { return p.id == object.holder_id; });
  if (person == in_.people.people.end()) return false;
  if (track.object.age <= in_.settings.follow_hand_after) {
    if (track.hand_offset_time == track.seen) return false;
    track.hand_offset_time = track.seen;
    double min_distance = std::numeric_limits<double>::infinity();
    for (const char* hand : {"l_hand", "r_hand"}) {
      const Vector3 p = object.T_world_object.translation() - joint_of(*person, hand).position;
      if (p.norm() >= min_distance) continue;
      min_distance = p.norm();
      track.hand = body_joint_index(hand);
      track.p_hand_object = p;
    }
    return false;
  }
  object.T_world_object.translation() =
      person->joints[static_cast<std::size_t>(track.hand)].position + track.p_hand_object;
  object.velocity = person->joints[static_cast<std::size_t>(track.hand)].velocity;
  return true;
}

}  // namespace handsel::spark
