#include "components/manipulation_planner/handover/offer_detector.hpp"

#include <algorithm>

#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kBentArmMargin = 0.02;     // farther than the bound, of who was asked for it [m]
constexpr double kLongWaitMargin = 0.03;    // nearer than the bound, after a long wait [m]
constexpr double kAcceptedMargin = 0.015;   // nearer than the bound, of an accepted offer [m]
constexpr double kFarFromBody = 0.4;        // from the torso: nothing asked for is kept there [m]
constexpr double kMinTowardRobot = 0.7;     // cosine of the direction to the robot or its hand
constexpr double kMaxOfferGap = 0.2;        // an accepted offer may seem withdrawn so long [s]
constexpr double kWithdrawalTime = 0.6;     // after which it is withdrawn [s]
constexpr double kMaxApproachSpeed = 0.35;  // of giver or object toward the hand [m/s]
constexpr double kMaxGiverDistance = 0.5;   // palm to object while a step of the giver counts [m]
constexpr double kMaxObjectDistance = 0.4;  // palm to object while its own motion counts [m]

Vector3 level(const Vector3& v) { return {v.x(), v.y(), 0}; }

const BodyJoint& torso_of(const Person& person) {
  return person.joints[static_cast<std::size_t>(body_joint_index("torso"))];
}

}  // namespace

double OfferDetector::min_distance(const Person& person, const SceneObject& object,
                                   bool is_fact) const {
  const bool is_accepted = accepted_.object == object.id && accepted_.giver == person.id;
  const double margin = waited_long_  ? -kLongWaitMargin
                        : is_accepted ? -kAcceptedMargin
                        : is_fact     ? 0.0
                                      : kBentArmMargin;
  return bounds_.min_distance + margin;
}

bool OfferDetector::is_offered(const Person& person, const SceneObject& object,
                               const Vector3& p_hand) const {
  if (object.holder != Holder::human || object.holder_id != person.id) return false;
  const Vector3 p_torso = torso_of(person).position;
  const Vector3 out = level(object.T_world_object.translation() - p_torso);
  const auto& facts = now_.facts().facts;
  const bool is_fact = std::any_of(facts.begin(), facts.end(), [&](const Fact& f) {
    return f.kind == FactKind::offering && f.subject == person.id && f.object == object.id;
  });
  const double min = min_distance(person, object, is_fact);
  if (is_fact) return out.norm() >= min;
  const bool is_asked = asked_.giver == person.id && asked_.object == object.id;
  const auto is_toward = [&](const Vector3& p) {
    const Vector3 direction = level(p - p_torso);
    return out.dot(direction) > kMinTowardRobot * out.norm() * direction.norm();
  };
  if (is_asked && out.norm() > kFarFromBody) return true;
  const Vector3 p_base = now_.T_world_base().translation();
  return is_asked && out.norm() >= min && (is_toward(p_base) || is_toward(p_hand));
}

std::optional<Offer> OfferDetector::find(const std::string& object, const std::string& giver,
                                         const Vector3& p_hand) const {
  for (const SceneObject& held : now_.scene().objects) {
    if (!object.empty() && held.id != object) continue;
    for (const Person& person : now_.people().people) {
      if (!giver.empty() && person.id != giver) continue;
      if (held.velocity.norm() > bounds_.max_speed || !is_offered(person, held, p_hand)) continue;
      return Offer{held.id, person.id};
    }
  }
  return std::nullopt;
}

void OfferDetector::accept(const Offer& offer) {
  accepted_ = offer;
  offered_at_ = now_.time();
}

void OfferDetector::update(const Vector3& p_hand) {
  const SceneObject* object = now_.object(accepted_.object);
  const Person* person = object == nullptr ? nullptr : now_.person(accepted_.giver);
  if (person != nullptr && is_offered(*person, *object, p_hand)) offered_at_ = now_.time();
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
