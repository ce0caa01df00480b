#include "components/spark/fact_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/cost/human_cost.hpp"
#include "common/model/human_body.hpp"

namespace handsel::spark {
namespace {

constexpr std::array kZoneLimits = {0.1, 0.45, 1.2, 3.6};  // contact, danger, interaction, social [m]
constexpr std::array kZoneFacts = {FactKind::in_contact_zone, FactKind::in_danger_zone, FactKind::in_interaction_zone,
                                   FactKind::in_social_zone};

const BodyJoint& joint(const Person& person, const char* name) { return person.joints[static_cast<std::size_t>(body_joint_index(name))]; }

double speed_toward(const BodyJoint& joint, const Vector3& target) {
  const Vector3 gap = target - joint.position;
  const double distance = gap.norm();
  return distance > 1e-6 ? joint.velocity.dot(gap) / distance : 0.0;
}

}  // namespace

FactFinder::FactFinder(const config::SparkSettings& settings, std::shared_ptr<const RobotModel> robot)
    : settings_(settings), robot_(std::move(robot)), capsules_(robot_capsules(*robot_)) {}

int FactFinder::zone_level(Zone& zone, double distance, TimePoint now) const {
  int level = 0;
  while (level < 4 && distance > kZoneLimits[static_cast<std::size_t>(level)]) ++level;
  if (level <= zone.level) {
    zone.level = level;
    zone.last_inside = now;
    return level;
  }
  const bool beyond = distance > kZoneLimits[static_cast<std::size_t>(zone.level)] + settings_.zone_hysteresis();
  if (!beyond) zone.last_inside = now;
  if (beyond && to_seconds(now - zone.last_inside) >= settings_.zone_dwell()) zone.level = level;
  return zone.level;
}

void FactFinder::person_facts(const Scene& scene, const Person& person, TimePoint now, std::vector<Fact>& out) {
  HumanState alone;
  alone.people = {person};
  const Separation gap = separation(capsules_, links_, scene.T_world_base, alone);
  const int level = zone_level(zones_[person.id], gap.distance, now);
  if (level < 4) out.push_back({kZoneFacts[static_cast<std::size_t>(level)], person.id, "", gap.distance, 0});

  const Vector3 robot = gap.on_robot;
  const double approach = speed_toward(joint(person, "torso"), robot);
  if (approach > settings_.approach_speed()) out.push_back({FactKind::approaching, person.id, "", approach, 0});

  const Vector3 tool = robot_->tool_link() >= 0
                           ? Vector3((scene.T_world_base * links_[static_cast<std::size_t>(robot_->tool_link())]).translation())
                           : scene.T_world_base.translation();
  if (person.gaze_known) {
    const auto angle_to = [&](const Vector3& p) {
      const Vector3 d = p - person.gaze_origin;
      return std::acos(std::clamp(d.normalized().dot(person.gaze_direction), -1.0, 1.0));
    };
    const Vector3 body = scene.T_world_base.translation() + Vector3(0, 0, 1.0);
    const double angle = std::min(angle_to(tool), angle_to(body));
    if (angle < settings_.attentive_angle()) out.push_back({FactKind::attentive, person.id, "", angle, 0});
  }
  for (const char* hand : {"l_hand", "r_hand"}) {
    const BodyJoint& h = joint(person, hand);
    const double toward_tool = speed_toward(h, tool);
    if (toward_tool > settings_.reach_speed()) out.push_back({FactKind::reaching, person.id, "robot", toward_tool, 0});
    for (const auto& object : scene.objects) {
      const double distance = (object.T_world_object.translation() - h.position).norm();
      if (distance < settings_.near_distance()) out.push_back({FactKind::hand_near_object, person.id, object.id, distance, 0});
      const double toward = speed_toward(h, object.T_world_object.translation());
      if (toward > settings_.reach_speed() && distance < 0.8) out.push_back({FactKind::reaching, person.id, object.id, toward, 0});
    }
  }
}

void FactFinder::object_facts(const Scene& scene, const HumanState& people, std::vector<Fact>& out) const {
  for (const auto& object : scene.objects) {
    switch (object.holder) {
      case Holder::surface:
        out.push_back({FactKind::on_surface, object.id, object.holder_id, 1, 0});
        break;
      case Holder::robot:
        out.push_back({FactKind::held_by_robot, object.id, "", 1, 0});
        break;
      case Holder::human:
        out.push_back({FactKind::held_by_human, object.id, object.holder_id, 1, 0});
        break;
      case Holder::nobody:
        break;
    }
    for (const auto& person : people.people)
      if (within_reach(person, object.T_world_object.translation()))
        out.push_back({FactKind::reachable_by_human, object.id, person.id, 1, 0});
  }
}

Facts FactFinder::find(const Scene& scene, const HumanState& people, TimePoint now) {
  Facts out;
  if (!scene.robot_known) return out;
  robot_->forward(scene.robot_position, links_);
  for (const auto& person : people.people) person_facts(scene, person, now, out.facts);
  object_facts(scene, people, out.facts);

  std::map<Key, TimePoint> still;
  for (auto& fact : out.facts) {
    const Key key{fact.kind, fact.subject, fact.object};
    const auto before = since_.find(key);
    const TimePoint since = before != since_.end() ? before->second : now;
    still[key] = since;
    fact.since = to_seconds(now - since);
  }
  since_ = std::move(still);
  return out;
}

}  // namespace handsel::spark
