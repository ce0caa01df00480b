#include "components/spark/scene/holder_assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/human/human_body.hpp"
#include "common/model/object_extent.hpp"
#include "components/spark/directed.hpp"

namespace handsel::spark {
namespace {

// What a loaded hand has lifted so far does not stand there any more [m].
constexpr double kClearOfSupport = 0.01;

/// Returns the distance of a palm from an object, as from the centre of one that is as long as it
/// is wide: from the box around it, plus half the smallest side of that box [m]. The centre of a
/// long object may be far from the hand that holds one end.
double palm_distance(const Vector3& p_palm, const ObjectModel& model, const Pose& T_world_object) {
  const Eigen::AlignedBox3d box = object_extent(&model, {});
  return box.exteriorDistance(T_world_object.inverse() * p_palm) + box.sizes().minCoeff() / 2;
}

}  // namespace

/// Returns the box under the object, its bottom no more than `gap` [m] from the top; nullptr: none.
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

// A sensor feels the hand that is nearest.
void HolderAssignment::attribute_grips(ObjectTrack& track) const {
  track.object.grips.clear();
  for (const ObservedGrip& felt : track.grips) {
    ObjectGrip grip{"", felt.force};
    double nearest = in_.settings.grip_distance;
    const auto claim = [&](const std::string& person, const Vector3& hand) {
      const double distance = (hand - felt.position).norm();
      if (distance >= nearest) return;
      nearest = distance;
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

/// Decides by the force sensors of the object: whoever had it keeps it until their grip is lost,
/// then the strongest grip counts. Returns false when nobody grips it.
bool HolderAssignment::keep_gripped(SceneObject& object) const {
  const ObjectGrip* strongest = nullptr;
  const std::string now = object.holder == Holder::robot ? kRobotName : object.holder_id;
  for (const ObjectGrip& grip : object.grips) {
    if (grip.person.empty()) continue;
    const bool keeps =
        object.holder >= Holder::robot && grip.person == now && grip.force > in_.settings.grip_lost;
    if (keeps) return true;
    if (grip.force > in_.settings.grip_force &&
        (strongest == nullptr || grip.force > strongest->force))
      strongest = &grip;
  }
  if (strongest == nullptr) return false;
  object.holder = strongest->person == kRobotName ? Holder::robot : Holder::human;
  object.holder_id = strongest->person == kRobotName ? "" : strongest->person;
  return true;
}

/// Returns, of the robot's hands that feel the object together, the one that holds it: the hand
/// that had it while that feels some of the load, else the one with the largest load.
std::optional<std::size_t> HolderAssignment::loaded_hand(const ObjectTrack& track) const {
  constexpr double kReach = 0.35;     // [m] from the palm
  constexpr double kTaken = 0.30;     // [m] and so near to come to be held: what only leans on the
                                      // fingertips is not in the hand
  constexpr double kHeldRatio = 0.4;  // of its weight that is felt when it is held
  constexpr double kKeptRatio = 0.2;  // and that the hand that had it feels at least
  const ObjectModel* model = in_.library ? in_.library(track.object.model) : nullptr;
  if (model == nullptr || !in_.robot.known()) return std::nullopt;
  std::optional<std::size_t> strongest;
  double together = 0;
  for (std::size_t i = 0; i < in_.robot.hands().size(); ++i) {
    const RobotPlacement::Hand& hand = in_.robot.hands()[i];
    const double reach = track.object.holder == Holder::robot ? kReach : kTaken;
    if (!(palm_distance(hand.T_world_palm.translation(), *model, track.object.T_world_object) <
          reach))
      continue;
    together += hand.payload;
    if (!strongest || hand.payload > in_.robot.hands()[*strongest].payload) strongest = i;
  }
  if (!strongest || !(together > kHeldRatio * model->mass)) return std::nullopt;
  const RobotPlacement::Hand& before = in_.robot.hands()[track.robot_hand];
  const bool kept =
      track.object.holder == Holder::robot && before.payload > kKeptRatio * model->mass;
  return kept ? track.robot_hand : *strongest;
}

/// Returns whether the person who has held the object still has a hand at it; the object may touch
/// a surface meanwhile.
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

/// Returns whether the hand of the robot that has held the object still has the fingers around it,
/// though it feels no load: a person carries the object with it.
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
  if (keep_gripped(object)) return;
  const Vector3 where = object.T_world_object.translation();
  const std::optional<std::size_t> by = loaded_hand(track);
  const bool robot_may = by.has_value();
  if (robot_may && *by != track.robot_hand) {
    track.robot_hand = *by;
    track.T_palm_object = in_.robot.hands()[*by].T_world_palm.inverse() * object.T_world_object;
  }
  if (!robot_may && is_in_hand_of_holder(object)) return;
  if (const SceneBox* box =
          support_under(object, robot_may ? kClearOfSupport : in_.settings.support_gap)) {
    object.holder = Holder::surface;
    object.holder_id = box->id;
    return;
  }
  if (robot_may) {
    const RobotPlacement::Hand& hand = in_.robot.hands()[*by];
    object.holder = Holder::robot;
    object.holder_id = hand.name;
    track.robot_grip = RobotGrip{hand.fingers, hand.T_world_palm.inverse() * where};
    return;
  }
  if (is_in_closed_hand(track)) return;
  double nearest = in_.settings.near_distance;
  for (const auto& person : in_.people.people) {
    if (!object.grips.empty()) break;  // nobody grips it
    for (const char* hand : {"l_hand", "r_hand"}) {
      const double distance = (joint_of(person, hand).position - where).norm();
      if (distance > nearest) continue;
      nearest = distance;
      object.holder = Holder::human;
      object.holder_id = person.id;
    }
  }
  const bool human_went = object.holder == Holder::human && nearest >= in_.settings.near_distance;
  const bool robot_went = object.holder == Holder::robot || object.holder == Holder::surface;
  if (nearest >= in_.settings.near_distance && (human_went || robot_went)) {
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
  if (track.object.age <= kFollowHandAfter) {
    if (track.hand_offset_time == track.seen) return false;
    track.hand_offset_time = track.seen;
    double nearest = std::numeric_limits<double>::infinity();
    for (const char* hand : {"l_hand", "r_hand"}) {
      const Vector3 p = object.T_world_object.translation() - joint_of(*person, hand).position;
      if (p.norm() >= nearest) continue;
      nearest = p.norm();
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
