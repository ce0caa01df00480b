#include "common/cost/human_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/collision/collision_world.hpp"
#include "common/cost/person_frame.hpp"

namespace handsel {
namespace {

double point_to_cylinder(const SimplifiedBody& body, const Vector3& p) {
  const Vector3 r = p - body.axis_bottom;
  const double outside = std::hypot(r.x(), r.y()) - body.radius;
  const double above = std::max(-r.z(), r.z() - body.height);
  if (outside <= 0 && above <= 0) return std::max(outside, above);
  return std::hypot(std::max(0.0, outside), std::max(0.0, above));
}

/// Golden section: the distance to a convex body is convex along a line.
double segment_to_cylinder(const SimplifiedBody& body, const Vector3& a, const Vector3& b) {
  constexpr double kGolden = 0.6180339887498949;
  double low = 0, high = 1, t1 = 1 - kGolden, t2 = kGolden;
  const auto at = [&](double t) { return point_to_cylinder(body, a + t * (b - a)); };
  double f1 = at(t1), f2 = at(t2), least = std::min({at(0), at(1), f1, f2});
  for (int i = 0; i < 24; ++i) {
    if (f1 < f2) {
      high = t2;
      t2 = t1;
      f2 = f1;
      t1 = high - kGolden * (high - low);
      f1 = at(t1);
    } else {
      low = t1;
      t1 = t2;
      f1 = f2;
      t2 = low + kGolden * (high - low);
      f2 = at(t2);
    }
    least = std::min({least, f1, f2});
  }
  return least;
}

/// A capsule that holds the cylinder: never farther than the cylinder.
double cylinder_bound(const SimplifiedBody& body, const Vector3& a, const Vector3& b) {
  return segment_distance(a, b, body.axis_bottom, body.axis_bottom + Vector3(0, 0, body.height)) - body.radius;
}

double head_distance(const SimplifiedBody& body, const Vector3& a, const Vector3& b) {
  return segment_distance(a, b, body.head, body.head) - body.head_radius;
}

}  // namespace

double safety_cost(double distance, double radius) {
  const double penetration = (radius - distance) / radius;
  if (penetration <= 0) return 0.0;
  return (std::exp(std::min(penetration, 1.0) - 1.0) - std::exp(-1.0)) / (1.0 - std::exp(-1.0));
}

double visibility_cost(const Person& person, const Vector3& p, double cutoff) {
  const BodyJoint* head = find_joint(person, "head");
  if (!person.gaze_known && !head) return 0.0;
  const Vector3 eyes = person.gaze_known ? person.gaze_origin : head->position;
  const Vector3 gaze = person.gaze_known ? person.gaze_direction : Vector3(torso_axes(person).col(0));
  const Vector3 to_p = p - eyes;
  const double distance = to_p.norm();
  if (distance > cutoff || distance < 1e-9) return 0.0;
  return std::acos(std::clamp(gaze.dot(to_p) / (distance * std::max(1e-12, gaze.norm())), -1.0, 1.0)) / M_PI;
}

double simplified_distance(const SimplifiedBody& body, const Vector3& a, const Vector3& b, double radius) {
  return std::min(head_distance(body, a, b), segment_to_cylinder(body, a, b)) - radius;
}

HumanCost::HumanCost(const RobotModel& robot, CostSettings settings) : robot_(&robot), settings_(settings), tool_(robot.tool_link()) {
  std::vector<bool> moves(robot.links().size(), false);
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    const int joint = robot.links()[i].parent_joint;
    if (joint >= 0) moves[i] = moves[robot.joints()[joint].parent] || robot.joints()[joint].dof >= 0;
  }
  for (const LinkCapsule& capsule : robot_capsules(robot))
    if (moves[capsule.link]) capsules_.push_back(capsule);
  if (tool_ < 0) tool_ = static_cast<int>(robot.links().size()) - 1;
}

void HumanCost::set_people(const HumanState& people) {
  people_ = people;
  bodies_.clear();
  for (const Person& person : people_.people) bodies_.push_back(simplified_body(person));
}

double weighted_cost(const CostParts& parts, const CostSettings& settings) {
  const double sum = settings.w_safety + settings.w_visibility + settings.w_comfort;
  return (settings.w_safety * parts.safety + settings.w_visibility * parts.visibility + settings.w_comfort * parts.comfort) / sum;
}

CostParts point_cost(const Person& person, const Vector3& p, const CostSettings& settings) {
  CostParts parts;
  parts.distance = simplified_distance(simplified_body(person), p, p, 0.0);
  parts.safety = safety_cost(parts.distance, settings.safety_radius);
  parts.visibility = visibility_cost(person, p, settings.visibility_cutoff);
  parts.comfort = arm_comfort_cost(person, p);
  return parts;
}

/// Bounds from the capsules' middles first, then exactly those that can be nearest.
double HumanCost::distance_to(const SimplifiedBody& body) const {
  double least = std::numeric_limits<double>::infinity();
  bounds_.resize(placed_.size());
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const PlacedCapsule& capsule = placed_[i];
    const Vector3 middle = 0.5 * (capsule.a + capsule.b);
    const double d = std::min(point_to_cylinder(body, middle), (middle - body.head).norm() - body.head_radius) - capsule.radius;
    least = std::min(least, d);
    bounds_[i] = d - 0.5 * (capsule.b - capsule.a).norm();
  }
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const PlacedCapsule& capsule = placed_[i];
    if (bounds_[i] >= least) continue;
    least = std::min(least, head_distance(body, capsule.a, capsule.b) - capsule.radius);
    if (cylinder_bound(body, capsule.a, capsule.b) - capsule.radius < least)
      least = std::min(least, segment_to_cylinder(body, capsule.a, capsule.b) - capsule.radius);
  }
  return least;
}

CostParts HumanCost::parts(const Vector& q) const {
  CostParts worst;
  worst.distance = std::numeric_limits<double>::infinity();
  if (people_.people.empty()) return worst;
  robot_->forward(q, links_);
  const Vector3 p_tool = T_world_base_ * links_[tool_].translation();
  placed_.resize(capsules_.size());
  for (std::size_t i = 0; i < capsules_.size(); ++i) {
    const LinkCapsule& capsule = capsules_[i];
    const Pose& T_root_link = links_[capsule.link];
    placed_[i] = {T_world_base_ * (T_root_link * capsule.a), T_world_base_ * (T_root_link * capsule.b), capsule.radius};
  }
  double most = -1;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const SimplifiedBody& body = bodies_[i];
    const double least = distance_to(body);
    CostParts now;
    now.distance = least;
    now.safety = safety_cost(least, settings_.safety_radius);
    if (settings_.w_visibility > 0) now.visibility = visibility_cost(people_.people[i], p_tool, settings_.visibility_cutoff);
    if (settings_.w_comfort > 0) now.comfort = arm_comfort_cost(people_.people[i], p_tool);
    if (weighted_cost(now, settings_) > most) {
      most = weighted_cost(now, settings_);
      worst = now;
    }
  }
  return worst;
}

double HumanCost::operator()(const Vector& q) const { return people_.people.empty() ? 0.0 : weighted_cost(parts(q), settings_); }

}  // namespace handsel
