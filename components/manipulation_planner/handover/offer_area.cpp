// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/offer_area.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kBack[] = {0.0, 0.1, 0.2, 0.3};  // from rest, away from the person [m]
constexpr double kOfferAside[] = {0.0, 0.15, -0.15, 0.3, -0.3, 0.45, -0.45};  // from rest [m]
constexpr double kSwing[] = {0.4, -0.4, 0.8, -0.8, 1.2, -1.2};  // from rest, at the shoulder [rad]

Vector3 horizontal(const Vector3& v) { return {v.x(), v.y(), 0}; }

/// Returns where a person would comfortably offer something with that arm: held out toward the
/// robot's hand, turned at the shoulder by at most `max_turn` [rad].
Vector3 offer_toward(const Person& person, Side side, const Vector3& p_hand, double max_turn) {
  const char* name = side == Side::left ? "l_shoulder" : "r_shoulder";
  const Vector3& p_shoulder =
      person.joints[static_cast<std::size_t>(body_joint_index(name))].position;
  const Vector3 arm = comfortable_reach(person, side) - p_shoulder, to_hand = p_hand - p_shoulder;
  const double turn = std::remainder(
      std::atan2(to_hand.y(), to_hand.x()) - std::atan2(arm.y(), arm.x()), 2 * std::numbers::pi);
  return p_shoulder +
         Eigen::AngleAxisd(std::clamp(turn, -max_turn, max_turn), Vector3::UnitZ()) * arm;
}

}  // namespace

double OfferArea::clearance(const Person& person, const Vector& q) const {
  double room = std::numeric_limits<double>::infinity();
  const Vector3 p_hand = now_.T_world_base() * arm_.robot().link_pose(q, arm_.palm()).translation();
  const auto leave_room_at = [&](const Vector3& p_offer) {
    const double hand = horizontal(p_hand - p_offer).norm() - settings_.offer_area_hand;
    const double arm =
        retreat_.distance(q, now_.T_world_base(), p_offer) - settings_.offer_area_arm;
    room = std::min({room, hand, arm});
  };
  for (const Side side : {Side::left, Side::right})
    leave_room_at(offer_toward(person, side, p_hand, settings_.offer_max_angle));
  for (const SceneObject& object : now_.scene().objects)
    if (object.holder == Holder::human && object.holder_id == person.id)
      leave_room_at(object.T_world_object.translation());
  return room;
}

bool OfferArea::is_occupied(const Person& person, const Vector& q) const {
  return clearance(person, q) < -settings_.offer_area_intrusion;
}

bool OfferArea::is_occupied(const std::string& id) const {
  const Person* person = now_.person(id);
  return person != nullptr && is_occupied(*person, arm_.configuration());
}

std::vector<Vector> OfferArea::clear_configurations(const Person& person) const {
  struct Place {
    Vector joints;
    double clearance, from_rest;
  };
  const Vector q_rest = arm_.robot().rest_configuration();
  const Pose T_rest = now_.T_world_base() * arm_.robot().link_pose(q_rest, arm_.palm());
  const Vector3 p_torso =
      person.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  const Vector3 away =
      horizontal(T_world_platform(now_).translation() - p_torso).stableNormalized();
  const Vector3 aside = Vector3::UnitZ().cross(away);
  std::vector<Place> places;
  IkOptions options;
  options.restarts = 0;
  const auto add = [&](const Pose& T) {
    const auto joints =
        arm_.robot().inverse(arm_.group(), now_.T_world_base().inverse() * T, q_rest, options);
    if (!joints) return;
    const Vector q = RobotModel::with(arm_.configuration(), arm_.group(), *joints);
    const double from_rest = (T.translation() - T_rest.translation()).norm();
    places.push_back({*joints, clearance(person, q), from_rest});
  };
  for (const double back : kBack)
    for (const double beside : kOfferAside)
      add(Eigen::Translation3d(back * away + beside * aside) * T_rest);
  // An arm that is folded at rest moves no farther back, but it turns at the shoulder.
  const Eigen::Translation3d T_shoulder(arm_.p_world_shoulder());
  for (const double angle : kSwing)
    add(T_shoulder * Eigen::AngleAxisd(angle, Vector3::UnitZ()) * T_shoulder.inverse() * T_rest);
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    const bool is_clear = a.clearance >= 0;
    if (is_clear != (b.clearance >= 0)) return is_clear;
    return is_clear ? a.from_rest < b.from_rest : a.clearance > b.clearance;
  });
  places.resize(std::min<std::size_t>(places.size(), settings_.offer_area_goals));
  std::vector<Vector> out;
  out.reserve(places.size());
  for (Place& place : places) out.push_back(std::move(place.joints));
  return out;
}

}  // namespace handsel::manipulation_planner
