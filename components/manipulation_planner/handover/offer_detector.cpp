#include "components/manipulation_planner/handover/offer_detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kNoise = 0.010;             // of the extension of an offer seen before
constexpr double kMinWithdrawn = 0.02;       // by which it falls at least when withdrawn
constexpr double kMaxWithdrawn = 0.05;       // by which it falls at most when not
constexpr double kAcceptedAngle = 0.3;       // likewise of its direction [rad]
constexpr double kNearRange = 0.06;          // beyond near_hand: min_extension applies [m]
constexpr double kLongWaitExtension = 0.10;  // after a long wait, near the robot's hand
constexpr double kLongWaitRest = 1.0;        // for which the object must then be at rest [s]
constexpr double kAnySpeed = std::numeric_limits<double>::infinity();  // [m/s]
constexpr double kMinStature = 0.5;                                    // [m]
constexpr double kMaxRetreat = 0.003;       // of an object at rest, noise [m]
constexpr double kMaxTurningTime = 0.29;    // of a slow motion [s]
constexpr double kMaxDetour = 0.12;         // of that motion, beyond its straight length [m]
constexpr double kRestAfterDetour = 0.4;    // of what was moved about before [s]
constexpr double kMaxAboveSupport = 0.25;   // origin of what is being put down or taken there [m]
constexpr double kRestAboveSupport = 0.5;   // of what is offered there [s]
constexpr double kOtherRange = 1.5;         // people nearer to the object may be meant [m]
constexpr double kMaxOfferGap = 0.2;        // an accepted offer may seem withdrawn so long [s]
constexpr double kWithdrawalTime = 0.6;     // after which it is withdrawn [s]
constexpr double kMaxApproachSpeed = 0.35;  // of giver or object toward the hand [m/s]
constexpr double kMaxGiverDistance = 0.5;   // palm to object while a step of the giver counts [m]
constexpr double kMaxObjectDistance = 0.4;  // palm to object while its own motion counts [m]

Vector3 level(const Vector3& v) { return {v.x(), v.y(), 0}; }

const BodyJoint& torso_of(const Person& person) {
  return person.joints[static_cast<std::size_t>(body_joint_index("torso"))];
}

const Vector3& joint_of(const Person& person, const char* name) {
  return person.joints[static_cast<std::size_t>(body_joint_index(name))].position;
}

double stature_of(const Person& person) { return std::max(kMinStature, person.stature); }

/// Returns the shoulder of the hand that is nearer to the object.
const Vector3& holding_shoulder(const Person& person, const Vector3& p_object) {
  const bool is_left = (joint_of(person, "l_hand") - p_object).norm() <
                       (joint_of(person, "r_hand") - p_object).norm();
  return joint_of(person, is_left ? "l_shoulder" : "r_shoulder");
}

/// Returns the level distance of the object from that shoulder, over the stature.
double extension(const Person& person, const Vector3& p_object) {
  return level(p_object - holding_shoulder(person, p_object)).norm() / stature_of(person);
}

}  // namespace

OfferBounds offer_bounds(const settings::ManipulationPlannerSettings& s) {
  return {.min_extension = s.offer_extension,
          .near_extension = s.offer_near_extension,
          .near_hand = s.offer_near_hand,
          .max_height = s.offer_max_height,
          .max_angle = s.offer_max_angle,
          .max_speed = s.offer_still,
          .rest_time = s.offer_rest};
}

double OfferDetector::min_extension(const Person& person, const SceneObject& object,
                                    const Vector3& p_hand) const {
  const double away = (object.T_world_object.translation() - p_hand).norm();
  const double far = std::clamp((away - bounds_.near_hand) / kNearRange, 0.0, 1.0);
  const bool is_expected = waited_long_ && asked_.giver == person.id;
  const double near = is_expected ? kLongWaitExtension : bounds_.near_extension;
  const double min = near + far * (bounds_.min_extension - near);
  const Offer offer{object.id, person.id};
  if (offer == accepted_)
    return std::max(std::min(min - kNoise, extension_ - kMinWithdrawn), extension_ - kMaxWithdrawn);
  return offer == seen_ ? min - kNoise : min;
}

bool OfferDetector::is_for_robot(const Person& person, const Vector3& p_shoulder,
                                 const Vector3& p_object, const Vector3& p_hand) const {
  const Vector3 out = level(p_object - p_shoulder).stableNormalized();
  const auto aim = [&](const Vector3& p) {
    return out.dot(level(p - p_shoulder).stableNormalized());
  };
  const double aim_robot = std::max(aim(now_.T_world_base().translation()), aim(p_hand));
  const double max_angle =
      bounds_.max_angle + (accepted_.giver == person.id ? kAcceptedAngle : 0.0);
  if (aim_robot < std::cos(max_angle)) return false;
  const auto& people = now_.people().people;
  return std::none_of(people.begin(), people.end(), [&](const Person& other) {
    const Vector3& p_other = torso_of(other).position;
    return other.id != person.id && level(p_other - p_object).norm() < kOtherRange &&
           aim(p_other) > aim_robot;
  });
}

bool OfferDetector::is_offered(const Person& person, const SceneObject& object,
                               const Vector3& p_hand) const {
  if (object.holder != Holder::human || object.holder_id != person.id) return false;
  const Vector3 p_object = object.T_world_object.translation();
  const Vector3 p_shoulder = holding_shoulder(person, p_object);
  if ((p_object - p_shoulder).z() > bounds_.max_height * stature_of(person)) return false;
  return is_for_robot(person, p_shoulder, p_object, p_hand) &&
         extension(person, p_object) >= min_extension(person, object, p_hand);
}

std::optional<Offer> OfferDetector::find(const std::string& object, const std::string& giver,
                                         const Vector3& p_hand, double max_speed) const {
  for (const SceneObject& held : now_.scene().objects) {
    if (!object.empty() && held.id != object) continue;
    for (const Person& person : now_.people().people) {
      if (!giver.empty() && person.id != giver) continue;
      if (held.velocity.norm() > max_speed || !is_offered(person, held, p_hand)) continue;
      return Offer{held.id, person.id};
    }
  }
  return std::nullopt;
}

std::optional<Offer> OfferDetector::find(const std::string& object, const std::string& giver,
                                         const Vector3& p_hand) const {
  return find(object, giver, p_hand, bounds_.max_speed);
}

void OfferDetector::accept(const Offer& offer) {
  accepted_ = offer;
  offered_at_ = now_.time();
  const SceneObject* object = now_.object(offer.object);
  const Person* person = now_.person(offer.giver);
  const bool is_known = object != nullptr && person != nullptr;
  extension_ =
      is_known ? extension(*person, object->T_world_object.translation()) : bounds_.min_extension;
}

void OfferDetector::await() {
  accepted_ = {};
  waited_long_ = false;
  seen_.reset();
}

void OfferDetector::update(const Vector3& p_hand) {
  follow_objects();
  if (!has_accepted()) {
    const bool waited_long = std::exchange(waited_long_, false);
    std::optional<Offer> seen = find(asked_.object, asked_.giver, p_hand, kAnySpeed);
    waited_long_ = waited_long;
    is_seen_weakly_ = !seen && waited_long;
    if (is_seen_weakly_) seen = find(asked_.object, asked_.giver, p_hand, kAnySpeed);
    if (!seen || seen != seen_) seen_since_ = now_.time();
    seen_ = seen;
    return;
  }
  const SceneObject* object = now_.object(accepted_.object);
  const Person* person = object == nullptr ? nullptr : now_.person(accepted_.giver);
  if (person != nullptr && is_offered(*person, *object, p_hand)) offered_at_ = now_.time();
}

void OfferDetector::follow_objects() {
  const auto& objects = now_.scene().objects;
  for (const SceneObject& object : objects)
    if (object.holder == Holder::human)
      trails_[object.id].add(now_.time(), object.T_world_object.translation());
  std::erase_if(trails_, [&](const auto& entry) {
    const SceneObject* object = now_.object(entry.first);
    return object == nullptr || object->holder != Holder::human;
  });
}

std::optional<Offer> OfferDetector::made() const {
  const auto found = seen_ ? trails_.find(seen_->object) : trails_.end();
  if (found == trails_.end()) return std::nullopt;
  const ObjectTrail& trail = found->second;
  double rest_time = is_seen_weakly_ ? kLongWaitRest : bounds_.rest_time;
  if (is_above_support(*seen_)) rest_time = std::max(rest_time, kRestAboveSupport);
  if (trail.detour() > kMaxDetour) rest_time = std::max(rest_time, kRestAfterDetour);
  const double turning_time = std::min(trail.turning_time(), kMaxTurningTime);
  const double rest = std::min(trail.rest(), to_seconds(now_.time() - seen_since_));
  if (rest < std::max(rest_time, turning_time) || trail.retreat() > kMaxRetreat)
    return std::nullopt;
  return seen_;
}

/// Returns whether the object may be about to stand on a support.
bool OfferDetector::is_above_support(const Offer& offer) const {
  const SceneObject* object = now_.object(offer.object);
  if (object == nullptr) return false;
  const auto& boxes = now_.scene().boxes;
  return std::any_of(boxes.begin(), boxes.end(), [&](const SceneBox& box) {
    const Vector3 p = box.T_world_box.inverse() * object->T_world_object.translation();
    const Vector3 half = box.size / 2;
    return box.supports && std::abs(p.x()) < half.x() && std::abs(p.y()) < half.y() &&
           p.z() > half.z() && p.z() < half.z() + kMaxAboveSupport;
  });
}

bool OfferDetector::is_still_offered() const {
  return to_seconds(now_.time() - offered_at_) < kMaxOfferGap;
}

bool OfferDetector::is_withdrawn() const {
  return to_seconds(now_.time() - offered_at_) > kWithdrawalTime;
}

bool OfferDetector::is_giver_approaching(const Vector3& p_hand) const {
  const Person* person = now_.person(accepted_.giver);
  const SceneObject* object = now_.object(accepted_.object);
  if (person == nullptr || object == nullptr) return false;
  const Vector3 p_object = object->T_world_object.translation();
  const auto is_fast = [&p_hand](const Vector3& p, const Vector3& v) {
    return v.dot((p_hand - p).stableNormalized()) > kMaxApproachSpeed;
  };
  const BodyJoint& torso = torso_of(*person);
  const double distance = (p_object - p_hand).norm();
  return (distance < kMaxGiverDistance && is_fast(torso.position, torso.velocity)) ||
         (distance < kMaxObjectDistance && is_fast(p_object, object->velocity));
}

}  // namespace handsel::manipulation_planner
