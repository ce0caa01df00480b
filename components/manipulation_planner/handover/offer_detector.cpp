// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/offer_detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kAnySpeed = std::numeric_limits<double>::infinity();  // [m/s]
constexpr double kMinStature = 0.5;                                    // [m]

Vector3 level(const Vector3& v) { return {v.x(), v.y(), 0}; }

const BodyJoint& torso_of(const Person& person) {
  return person.joints[static_cast<std::size_t>(body_joint_index("torso"))];
}

const Vector3& joint_of(const Person& person, const char* name) {
  return person.joints[static_cast<std::size_t>(body_joint_index(name))].position;
}

double stature_of(const Person& person) { return std::max(kMinStature, person.stature); }

/// Returns the distance of the object from the nearer hand [m].
double hand_distance(const Person& person, const Vector3& p_object) {
  return std::min((joint_of(person, "l_hand") - p_object).norm(),
                  (joint_of(person, "r_hand") - p_object).norm());
}

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

/// Returns the height of the highest furniture that a point is over, or at most `beside` [m] beside
/// its top [m]; nullopt: of none.
std::optional<double> furniture_below(const Scene& scene, const Vector3& p, double beside) {
  std::optional<double> highest;
  for (const SceneBox& box : scene.boxes) {
    const Vector3 p_box = box.T_world_box.inverse() * p, half = 0.5 * box.size;
    const double top = box.T_world_box.translation().z() + half.z();
    const bool is_over =
        (p_box.cwiseAbs() - half).head<2>().maxCoeff() < beside && p_box.z() > half.z();
    if (is_over && (!highest || top > *highest)) highest = top;
  }
  return highest;
}

}  // namespace

double OfferDetector::min_extension(const Person& person, const SceneObject& object,
                                    const Vector3& p_hand) const {
  const double away = (object.T_world_object.translation() - p_hand).norm();
  const double far =
      std::clamp((away - settings_.offer_near_hand) / settings_.offer_near_range, 0.0, 1.0);
  const double near_extension =
      settings_.offer_near_extension -
      (is_extended_at_rest(person, object) ? settings_.offer_long_rest_extension : 0.0);
  const double min = near_extension + far * (settings_.offer_extension - near_extension);
  const Offer offer{object.id, person.id};
  if (offer == accepted_)
    return std::max(
        std::min(min - settings_.offer_noise, max_extension_ - settings_.offer_min_withdrawal),
        max_extension_ - settings_.offer_max_withdrawal);
  return offer == seen_ ? min - settings_.offer_noise : min;
}

bool OfferDetector::is_extended_at_rest(const Person& person, const SceneObject& object) const {
  const auto found = followed_.find(object.id);
  if (found == followed_.end() || found->second.holder != person.id) return false;
  const double rise =
      extension(person, object.T_world_object.translation()) - found->second.min_extension;
  return rise >= settings_.offer_long_rest_rise &&
         found->second.trail.rest() >= settings_.offer_long_rest;
}

bool OfferDetector::is_for_robot(const Person& person, const Vector3& p_shoulder,
                                 const Vector3& p_object, const Vector3& p_hand) const {
  const Vector3 out = level(p_object - p_shoulder).stableNormalized();
  const auto aim = [&](const Vector3& p) {
    return out.dot(level(p - p_shoulder).stableNormalized());
  };
  const double aim_robot = std::max(aim(T_world_platform(now_).translation()), aim(p_hand));
  const double max_angle = settings_.offer_max_angle +
                           (accepted_.giver == person.id ? settings_.offer_accepted_angle : 0.0);
  if (aim_robot < std::cos(max_angle)) return false;
  const auto& people = now_.people().people;
  return std::none_of(people.begin(), people.end(), [&](const Person& other) {
    if (other.id == person.id) return false;
    const Vector3& p_other = torso_of(other).position;
    return hand_distance(other, p_object) < settings_.offer_taking_range ||
           (level(p_other - p_object).norm() < settings_.offer_other_range &&
            aim(p_other) > aim_robot);
  });
}

bool OfferDetector::is_offered(const Person& person, const SceneObject& object,
                               const Vector3& p_hand) const {
  if (object.holder != Holder::human || object.holder_id != person.id) return false;
  const Vector3 p_object = object.T_world_object.translation();
  const Vector3 p_shoulder = holding_shoulder(person, p_object);
  const double height = (p_object - p_shoulder).z() / stature_of(person);
  const double extended = extension(person, p_object);
  const bool held_out = is_extended_at_rest(person, object);
  const double min_height =
      settings_.offer_min_height - (held_out ? settings_.offer_long_rest_height : 0.0);
  const double gain = settings_.offer_height_gain * (held_out ? settings_.offer_long_rest_gain : 1);
  double max_height =
      settings_.offer_max_height + gain * std::max(0.0, extended - settings_.offer_extension);
  if (const auto top = furniture_below(now_.scene(), p_object, settings_.offer_beside_furniture);
      held_out && top)
    max_height = std::max(
        max_height, (*top + settings_.offer_over_furniture - p_shoulder.z()) / stature_of(person));
  return height >= min_height && height <= max_height &&
         is_for_robot(person, p_shoulder, p_object, p_hand) &&
         extended >= min_extension(person, object, p_hand);
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
  return find(object, giver, p_hand, settings_.offer_still);
}

void OfferDetector::accept(const Offer& offer) {
  accepted_ = offer;
  offered_at_ = now_.time();
  const SceneObject* object = now_.object(offer.object);
  const Person* person = now_.person(offer.giver);
  const bool is_known = object != nullptr && person != nullptr;
  mean_extension_ = is_known ? extension(*person, object->T_world_object.translation())
                             : settings_.offer_extension;
  max_extension_ = mean_extension_;
}

void OfferDetector::await() {
  accepted_ = {};
  seen_.reset();
}

void OfferDetector::update(const Vector3& p_hand) {
  if (scenes_followed_ != now_.scene_count()) {
    scenes_followed_ = now_.scene_count();
    follow_objects();
    follow_extension();
  }
  if (!has_accepted()) {
    const std::optional<Offer> seen = find(asked_.object, asked_.giver, p_hand, kAnySpeed);
    if (!seen || seen != seen_) seen_since_ = now_.time();
    seen_ = seen;
    return;
  }
  const SceneObject* object = now_.object(accepted_.object);
  const Person* person = object == nullptr ? nullptr : now_.person(accepted_.giver);
  if (person != nullptr && is_offered(*person, *object, p_hand)) offered_at_ = now_.time();
}

void OfferDetector::follow_objects() {
  for (const SceneObject& object : now_.scene().objects) {
    FollowedObject& followed = followed_.try_emplace(object.id, settings_).first->second;
    const Vector3 p_object = object.T_world_object.translation();
    followed.trail.add(now_.time() - from_seconds(object.age), p_object);
    if (object.holder_id != followed.holder) {
      followed.holder = object.holder_id;
      followed.min_extension = std::numeric_limits<double>::infinity();
    }
    const Person* holder = object.holder == Holder::human ? now_.person(object.holder_id) : nullptr;
    if (holder != nullptr)
      followed.min_extension = std::min(followed.min_extension, extension(*holder, p_object));
  }
  std::erase_if(followed_, [&](const auto& entry) { return now_.object(entry.first) == nullptr; });
}

/// Extends the max extension of the accepted offer by a mean, which noise hardly exceeds.
void OfferDetector::follow_extension() {
  const SceneObject* object = has_accepted() ? now_.object(accepted_.object) : nullptr;
  const Person* person = object == nullptr ? nullptr : now_.person(accepted_.giver);
  if (person == nullptr) return;
  const double observed = extension(*person, object->T_world_object.translation());
  mean_extension_ += settings_.offer_extension_fraction * (observed - mean_extension_);
  max_extension_ = std::max(max_extension_, mean_extension_);
}

std::optional<Offer> OfferDetector::made() const {
  const auto found = seen_ ? followed_.find(seen_->object) : followed_.end();
  if (found == followed_.end()) return std::nullopt;
  const ObjectTrail& trail = found->second.trail;
  double rest_time = settings_.offer_rest;
  if (trail.detour() > settings_.offer_max_detour)
    rest_time = std::max(rest_time, settings_.offer_detour_rest);
  const double turning_time = std::min(trail.turning_time(), settings_.offer_max_turn_time);
  const double rest = std::min(trail.rest(), to_seconds(now_.time() - seen_since_));
  if (rest < std::max(rest_time, turning_time) ||
      trail.retreat() >
          std::max(settings_.offer_max_retreat, settings_.offer_retreat_noise * trail.noise()))
    return std::nullopt;
  return seen_;
}

bool OfferDetector::is_still_offered() const {
  return to_seconds(now_.time() - offered_at_) < settings_.offer_gap;
}

bool OfferDetector::is_withdrawn() const {
  return to_seconds(now_.time() - offered_at_) > settings_.offer_withdrawal_time;
}

bool OfferDetector::is_giver_approaching(const Vector3& p_hand) const {
  const Person* person = now_.person(accepted_.giver);
  const SceneObject* object = now_.object(accepted_.object);
  if (person == nullptr || object == nullptr) return false;
  const Vector3 p_object = object->T_world_object.translation();
  const auto is_fast = [&](const Vector3& p, const Vector3& v) {
    return v.dot((p_hand - p).stableNormalized()) > settings_.giver_speed;
  };
  const BodyJoint& torso = torso_of(*person);
  const double distance = (p_object - p_hand).norm();
  return (distance < settings_.giver_step_range && is_fast(torso.position, torso.velocity)) ||
         (distance < settings_.giver_object_range && is_fast(p_object, object->velocity));
}

}  // namespace handsel::manipulation_planner
