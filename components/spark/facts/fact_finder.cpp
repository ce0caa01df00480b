// SPDX-License-Identifier: Apache-2.0
#include "components/spark/facts/fact_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/cost/human_cost.hpp"
#include "common/cost/person_frame.hpp"
#include "common/model/manipulator.hpp"
#include "common/model/object_extent.hpp"
#include "common/model/platform.hpp"
#include "components/spark/directed.hpp"
#include "components/spark/quotas.hpp"
#include "components/spark/scene_model.hpp"

namespace handsel::spark {
namespace {

constexpr std::array kZoneFacts = {FactKind::in_contact_zone, FactKind::in_danger_zone,
                                   FactKind::in_interaction_zone, FactKind::in_social_zone};

double degrees(double angle) { return angle * 180 / std::numbers::pi; }

/// Returns the reach of each arm with a hand.
std::vector<ArmReach> reaches_of(const RobotModel& robot) {
  std::vector<ArmReach> out;
  for (const Manipulator& hand : hands_of(robot)) {
    const ArmReach reach = arm_reach(robot, hand.arm, hand.palm);
    if (reach.shoulder >= 0) out.push_back(reach);
  }
  return out;
}

double angle_to(const Person& person, const Vector3& p) {
  const Vector3 from = person.gaze_known ? person.gaze_origin : joint_of(person, "head").position;
  const Vector3 along =
      person.gaze_known ? person.gaze_direction : Vector3(torso_axes(person).col(0));
  return std::acos(std::clamp((p - from).normalized().dot(along), -1.0, 1.0));
}

}  // namespace

FactFinder::FactFinder(const settings::SparkSettings& settings,
                       std::shared_ptr<const RobotModel> robot, ObjectLibrary objects)
    : settings_(settings),
      robot_(std::move(robot)),
      library_(std::move(objects)),
      capsules_(robot_capsules(*robot_)),
      arms_(reaches_of(*robot_)),
      zone_limits_{settings.contact_zone, settings.danger_zone, settings.interaction_zone,
                   settings.social_zone},
      handover_(settings),
      lasting_(settings.fact_dwell),
      instant_(0) {}

int FactFinder::zone_level(Zone& zone, double distance, TimePoint now) const {
  int level = 0;
  while (level < 4 && distance > zone_limits_[static_cast<std::size_t>(level)]) ++level;
  if (level <= zone.level) {
    zone.level = level;
    zone.last_inside = now;
    return level;
  }
  const bool beyond =
      distance > zone_limits_[static_cast<std::size_t>(zone.level)] + settings_.zone_hysteresis;
  if (!beyond) zone.last_inside = now;
  if (beyond && to_seconds(now - zone.last_inside) >= settings_.zone_dwell) zone.level = level;
  return zone.level;
}

Vector3 FactFinder::p_world_robot(const Scene& scene) const {
  return T_world_platform(*robot_, scene).translation();
}

RobotPartner FactFinder::partner(const Scene& scene) const {
  const Vector3 base = p_world_robot(scene);
  RobotPartner robot{base + Vector3(0, 0, 1.0), base};
  if (scene.robot_known && robot_->tool_link() >= 0)
    robot.tool =
        (scene.T_world_base * links_[static_cast<std::size_t>(robot_->tool_link())]).translation();
  return robot;
}

void FactFinder::robot_facts(const Scene& scene, const Person& person, const RobotPartner& robot,
                             TimePoint now, std::vector<Candidate>& out) {
  HumanState one_person;
  one_person.people = {person};
  const Separation gap = separation(capsules_, links_, scene.T_world_base, one_person);
  const double approach = speed_toward(joint_of(person, "torso").position,
                                       joint_of(person, "torso").velocity, gap.on_robot);
  const double limit = settings_.approach_speed;
  out.push_back({FactKind::approaching, person.id, "", approach, approach > limit,
                 approach > limit / settings_.fact_hysteresis,
                 evidence("%.2f m/s toward the robot, %.2f m away", approach, gap.distance)});
  if (person.gaze_known) {
    const double angle = std::min(angle_to(person, robot.tool), angle_to(person, robot.body));
    out.push_back({FactKind::attentive, person.id, "", angle, angle < settings_.attentive_angle,
                   angle < settings_.fact_hysteresis * settings_.attentive_angle,
                   evidence("gaze %.0f degrees off the robot", degrees(angle))});
  }
  const int level = zone_level(zones_[person.id], gap.distance, now);
  if (level < 4)
    out.push_back({kZoneFacts[static_cast<std::size_t>(level)], person.id, "", gap.distance, true,
                   true, evidence("%.2f m from the robot", gap.distance)});
}

void FactFinder::gaze_facts(const Scene& scene, const HumanState& people, const Person& person,
                            const RobotPartner& robot, std::vector<Candidate>& out) const {
  if (!person.gaze_known) return;
  const auto add_gaze_fact = [&](const std::string& at, const Vector3& p_world, double radius) {
    const double distance = (p_world - person.gaze_origin).norm();
    const double beside = angle_to(person, p_world) - std::atan2(radius, distance);
    out.push_back({FactKind::looking_at, person.id, at, std::max(0.0, beside),
                   beside < settings_.looking_angle,
                   beside < settings_.fact_hysteresis * settings_.looking_angle,
                   evidence("gaze %.0f degrees beside it, %.1f m away",
                            degrees(std::max(0.0, beside)), distance)});
  };
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    add_gaze_fact(scene.objects[i].id, extents_[i].box.center(), extents_[i].radius);
  for (const Person& other : people.people)
    if (other.id != person.id) add_gaze_fact(other.id, joint_of(other, "head").position, 0.12);
  if (scene.robot_known) add_gaze_fact(kRobotName, robot.tool, 0.1);
}

void FactFinder::hand_facts(const Scene& scene, const Person& person,
                            std::vector<Candidate>& out) const {
  const double torso = joint_of(person, "torso").velocity.norm();
  out.push_back({FactKind::moving, person.id, "", torso, torso > 2 * settings_.moving_speed,
                 torso > settings_.moving_speed, evidence("body at %.2f m/s", torso)});
  for (const SceneObject& object : scene.objects) {
    double min_distance = 1e9;
    for (const char* hand : {"l_hand", "r_hand"})
      min_distance =
          std::min(min_distance,
                   (object.T_world_object.translation() - joint_of(person, hand).position).norm());
    out.push_back({FactKind::hand_near_object, person.id, object.id, min_distance,
                   min_distance < settings_.near_distance,
                   min_distance < settings_.fact_hysteresis * settings_.near_distance,
                   evidence("hand %.2f m from its middle", min_distance)});
  }
}

FactFinder::Extent FactFinder::extent(const SceneObject& object) const {
  const ObjectModel* model = library_ ? library_(object.model) : nullptr;
  Extent e;
  if (model != nullptr && !model->mesh.vertices.empty()) {
    for (const Vector3& v : model->mesh.vertices) e.box.extend(object.T_world_object * v);
  } else {
    e.box = object_extent(nullptr, object.primitive);
    if (e.box.isEmpty())
      e.box = Eigen::AlignedBox3d(Vector3::Constant(-settings_.unknown_size / 2),
                                  Vector3::Constant(settings_.unknown_size / 2));
    e.box.transform(object.T_world_object);
  }
  e.radius = e.box.diagonal().norm() / 2;
  return e;
}

void FactFinder::pair_facts(const Scene& scene, std::size_t i, std::size_t k,
                            std::vector<Candidate>& out) const {
  const SceneObject &a = scene.objects[i], &b = scene.objects[k];
  const Extent &ea = extents_[i], &eb = extents_[k];
  const double apart = ea.box.exteriorDistance(eb.box);
  const auto inside = [&](const SceneObject& small, const Extent& es, const SceneObject& large,
                          const Extent& el) {
    const bool larger =
        el.box.sizes().x() > es.box.sizes().x() && el.box.sizes().y() > es.box.sizes().y();
    const Vector3 low(es.box.center().x(), es.box.center().y(), es.box.min().z());
    const bool within = larger && el.box.contains(low) && el.box.contains(es.box.center());
    const double depth = el.box.max().z() - low.z();
    out.push_back({FactKind::inside, small.id, large.id, depth, within, within,
                   evidence("its bottom %.2f m below the rim", depth)});
    return within;
  };
  const bool nested = inside(a, ea, b, eb) | inside(b, eb, a, ea);
  const double limit = settings_.next_distance;
  out.push_back({FactKind::next_to, a.id, b.id, apart, !nested && apart < limit,
                 !nested && apart < settings_.fact_hysteresis * limit,
                 evidence("%.2f m apart", apart)});
}

Candidate FactFinder::reach_fact(const Scene& scene, const SceneObject& object) const {
  // Values of the arm with the min ratio of distance to length.
  double distance_to_shoulder = 0, length = 0;
  for (const ArmReach& arm : arms_) {
    const Vector3 p_shoulder =
        scene.T_world_base * links_[static_cast<std::size_t>(arm.shoulder)].translation();
    const double distance = (object.T_world_object.translation() - p_shoulder).norm();
    if (length > 0 && distance / arm.length >= distance_to_shoulder / length) continue;
    distance_to_shoulder = distance;
    length = arm.length;
  }
  return {FactKind::reachable_by_robot,
          object.id,
          "",
          distance_to_shoulder,
          distance_to_shoulder < length,
          distance_to_shoulder < settings_.reach_hysteresis * length,
          evidence("%.2f m from the shoulder of an arm of %.2f m", distance_to_shoulder, length)};
}

void FactFinder::thing_facts(const Scene& scene, const HumanState& people,
                             std::vector<Candidate>& out) const {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    const Vector3 middle = extents_[i].box.center();
    const Vector3 p_world = object.T_world_object.translation();
    const double speed = object.velocity.norm();
    out.push_back({FactKind::moving, object.id, "", speed, speed > settings_.moving_speed,
                   speed > settings_.moving_speed / 2, evidence("at %.2f m/s", speed)});
    if (object.holder == Holder::surface)
      out.push_back({FactKind::on_surface, object.id, object.holder_id, 1, true, true,
                     "its bottom on the top of " + object.holder_id});
    if (scene.robot_known && !arms_.empty()) out.push_back(reach_fact(scene, object));
    for (const Person& person : people.people) {
      const bool reach = within_reach(person, p_world);
      out.push_back({FactKind::reachable_by_human, object.id, person.id, 1, reach, reach,
                     evidence("%.2f m from the shoulders' middle",
                              (p_world - joint_of(person, "neck").position).norm())});
      const Vector3 eyes =
          person.gaze_known ? person.gaze_origin : joint_of(person, "head").position;
      const double aside = angle_to(person, middle);
      bool hidden = std::any_of(scene.boxes.begin(), scene.boxes.end(), [&](const SceneBox& box) {
        return hides(SightBox{box.T_world_box, box.size}, eyes, middle);
      });
      for (const LinkCapsule& c : capsules_) {
        if (hidden || !scene.robot_known || object.holder == Holder::robot) break;
        const Pose T = scene.T_world_base * links_[static_cast<std::size_t>(c.link)];
        hidden = hides(SightCapsule{T * c.a, T * c.b, c.radius}, eyes, middle);
      }
      out.push_back({FactKind::visible_to, object.id, person.id, aside,
                     !hidden && aside < settings_.field_of_view,
                     !hidden && aside < settings_.fact_hysteresis * settings_.field_of_view,
                     evidence("%.0f degrees from where they look", degrees(aside))});
    }
    for (std::size_t k = i + 1; k < scene.objects.size(); ++k) pair_facts(scene, i, k, out);
  }
}

Facts FactFinder::find(const Scene& scene, const HumanState& people, TimePoint now) {
  if (scene.robot_known) robot_->forward(scene.robot_position, links_);
  extents_.clear();
  for (const SceneObject& object : scene.objects) extents_.push_back(extent(object));
  std::erase_if(zones_, [&](const auto& zone) {
    return std::none_of(people.people.begin(), people.people.end(),
                        [&](const Person& person) { return person.id == zone.first; });
  });
  const RobotPartner robot = partner(scene);
  std::vector<Candidate> candidates, remembered;
  for (const Person& person : people.people) {
    if (scene.robot_known) robot_facts(scene, person, robot, now, candidates);
    gaze_facts(scene, people, person, robot, candidates);
    hand_facts(scene, person, candidates);
  }
  thing_facts(scene, people, candidates);
  handover_.find(scene, people, robot, now, candidates);

  // Zones, holders, supports and recent events have their own hysteresis.
  const auto has_own_hysteresis = [](const Candidate& c) {
    switch (c.kind) {
      case FactKind::in_contact_zone:
      case FactKind::in_danger_zone:
      case FactKind::in_interaction_zone:
      case FactKind::in_social_zone:
      case FactKind::on_surface:
      case FactKind::held_by_robot:
      case FactKind::held_by_human:
      case FactKind::released:
      case FactKind::withdrawn:
        return true;
      default:
        return false;
    }
  };
  const auto middle =
      std::stable_partition(candidates.begin(), candidates.end(),
                            [&](const Candidate& c) { return !has_own_hysteresis(c); });
  remembered.assign(std::make_move_iterator(middle), std::make_move_iterator(candidates.end()));
  candidates.erase(middle, candidates.end());
  Facts out{0, lasting_.update(candidates, now)};
  for (Fact& fact : instant_.update(remembered, now)) out.facts.push_back(std::move(fact));
  const Coverage reach = reach_of(*robot_, p_world_robot(scene));
  out.left_out =
      keep_most_relevant(out.facts, quotas_of(settings_).facts, scene, people, reach).count;
  return out;
}

}  // namespace handsel::spark
