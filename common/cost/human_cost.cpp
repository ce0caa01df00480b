// SPDX-License-Identifier: Apache-2.0
#include "common/cost/human_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/collision/collision_world.hpp"

namespace handsel {
namespace {

constexpr double kProbeSpacing =
    0.1;  // distance of the points of a link at which external layers are sampled [m]

double point_to_cylinder(const SimplifiedBody& body, const Vector3& p) {
  const Vector3 r = p - body.axis_bottom;
  const double outside = std::hypot(r.x(), r.y()) - body.radius;
  const double above = std::max(-r.z(), r.z() - body.height);
  if (outside <= 0 && above <= 0) return std::max(outside, above);
  return std::hypot(std::max(0.0, outside), std::max(0.0, above));
}

/// Returns the distance by golden-section search: the distance to a convex body is convex along a
/// line.
double segment_to_cylinder(const SimplifiedBody& body, const Vector3& a, const Vector3& b) {
  constexpr double kGolden = 0.6180339887498949;
  double low = 0, high = 1, t1 = 1 - kGolden, t2 = kGolden;
  const auto at = [&](double t) { return point_to_cylinder(body, a + t * (b - a)); };
  double f1 = at(t1), f2 = at(t2), min_distance = std::min({at(0), at(1), f1, f2});
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
    min_distance = std::min({min_distance, f1, f2});
  }
  return min_distance;
}

/// Returns a lower bound of the distance, from a capsule that encloses the cylinder.
double cylinder_bound(const SimplifiedBody& body, const Vector3& a, const Vector3& b) {
  return segment_distance(a, b, body.axis_bottom, body.axis_bottom + Vector3(0, 0, body.height)) -
         body.radius;
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

double visibility_cost(const Sight& sight, const Vector3& p, double cutoff) {
  const Vector3 to_p = p - sight.eyes;
  const double distance = to_p.norm();
  if (distance > cutoff || distance < 1e-9) return 0.0;
  return std::acos(std::clamp(sight.direction.dot(to_p) / distance, -1.0, 1.0)) / M_PI;
}

double visibility_cost(const Person& person, const Vector3& p, double cutoff) {
  const std::optional<Sight> sight = sight_of(person);
  return sight ? visibility_cost(*sight, p, cutoff) : 0.0;
}

double simplified_distance(const SimplifiedBody& body, const Vector3& a, const Vector3& b,
                           double radius) {
  return std::min(head_distance(body, a, b), segment_to_cylinder(body, a, b)) - radius;
}

HumanCost::HumanCost(const RobotModel& robot, CostSettings settings)
    : robot_(&robot), settings_(settings), tool_(robot.tool_link()) {
  std::vector<bool> moves(robot.links().size(), false);
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    const int joint = robot.links()[i].parent_joint;
    if (joint >= 0)
      moves[i] = moves[robot.joints()[joint].parent] || robot.joints()[joint].dof >= 0;
  }
  for (const LinkCapsule& capsule : robot_capsules(robot))
    if (moves[capsule.link]) capsules_.push_back(capsule);
  if (tool_ < 0) tool_ = static_cast<int>(robot.links().size()) - 1;
  probes_.push_back({tool_, Vector3::Zero()});
  for (const LinkCapsule& capsule : capsules_) {
    const int parts =
        std::max(1, static_cast<int>(std::ceil((capsule.b - capsule.a).norm() / kProbeSpacing)));
    for (int i = 0; i <= parts; ++i)
      probes_.push_back(
          {capsule.link, capsule.a + (capsule.b - capsule.a) * (static_cast<double>(i) / parts)});
  }
}

void HumanCost::set_people(const HumanState& people) {
  people_ = people;
  someone_.clear();
  for (const Person& person : people_.people)
    someone_.push_back({simplified_body(person), sight_of(person), placed_arms(person), nullptr});
  find_comfort_layers();
  set_batch_people();
}

void HumanCost::set_base(const Pose& T_world_base) {
  T_world_base_ = T_world_base;
  if (batch_) batch_->set_base(T_world_base);
}

void HumanCost::set_moving_axes(const std::vector<int>& axes) {
  if (axes.empty()) {
    batch_.reset();
    return;
  }
  if (!batch_) batch_ = std::make_unique<BatchCost>(*robot_, capsules_, probes_);
  batch_->set_axes(axes);
  batch_->set_base(T_world_base_);
  set_batch_people();
}

void HumanCost::set_batch_people() {
  if (!batch_) return;
  std::vector<BatchCost::Someone> people;
  for (const Someone& one : someone_) people.push_back({one.body, one.sight});
  batch_->set_people(std::move(people), settings_.safety_radius, settings_.visibility_cutoff);
}

void HumanCost::set_layers(LayersNow layers) {
  layers_ = std::move(layers);
  forbids_ = std::any_of(layers_.outside.begin(), layers_.outside.end(),
                         [](const auto& grid) { return grid->forbids(); });
  find_comfort_layers();
}

void HumanCost::find_comfort_layers() {
  for (std::size_t i = 0; i < someone_.size(); ++i)
    someone_[i].comfort = layers_.comfort_of(people_.people[i].id);
}

double weighted_cost(const CostParts& parts, const CostSettings& settings) {
  const double sum = settings.w_safety + settings.w_visibility + settings.w_comfort;
  return (settings.w_safety * parts.safety + settings.w_visibility * parts.visibility +
          settings.w_comfort * parts.comfort) /
             sum +
         parts.outside;
}

CostParts point_cost(const Person& person, const Vector3& p, const CostSettings& settings) {
  CostParts parts;
  parts.distance = simplified_distance(simplified_body(person), p, p, 0.0);
  parts.safety = safety_cost(parts.distance, settings.safety_radius);
  parts.visibility = visibility_cost(person, p, settings.visibility_cutoff);
  parts.comfort = arm_comfort_cost(person, p);
  return parts;
}

/// Computes bounds from the middles of the capsules, then exact distances where they can be the
/// min.
double HumanCost::distance_to(const SimplifiedBody& body) const {
  double min_distance = std::numeric_limits<double>::infinity();
  bounds_.resize(placed_.size());
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const PlacedCapsule& capsule = placed_[i];
    const Vector3 middle = 0.5 * (capsule.a + capsule.b);
    const double d =
        std::min(point_to_cylinder(body, middle), (middle - body.head).norm() - body.head_radius) -
        capsule.radius;
    min_distance = std::min(min_distance, d);
    bounds_[i] = d - 0.5 * (capsule.b - capsule.a).norm();
  }
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const PlacedCapsule& capsule = placed_[i];
    if (bounds_[i] >= min_distance) continue;
    min_distance =
        std::min(min_distance, head_distance(body, capsule.a, capsule.b) - capsule.radius);
    if (cylinder_bound(body, capsule.a, capsule.b) - capsule.radius < min_distance)
      min_distance =
          std::min(min_distance, segment_to_cylinder(body, capsule.a, capsule.b) - capsule.radius);
  }
  return min_distance;
}

template <class PointAt>
double HumanCost::outside_cost(PointAt&& point_at) const {
  double sum = 0;
  for (const auto& grid : layers_.outside) {
    double worst = 0;
    for (std::size_t i = 0; i < probes_.size(); ++i) {
      const GridValue value = grid->value(point_at(i));
      worst = std::max(worst, value.forbidden ? 1.0 : value.cost);
    }
    sum += grid->weight() * worst;
  }
  return sum;
}

double HumanCost::outside(const Vector& q) const {
  if (layers_.outside.empty()) return 0;
  robot_->forward(q, links_);
  return outside_cost([this](std::size_t i) {
    return T_world_base_ * (links_[probes_[i].link] * probes_[i].p_link);
  });
}

ForbiddenPlace HumanCost::forbidden(const Vector& q) const {
  if (!forbids_) return {};
  robot_->forward(q, links_);
  for (const auto& grid : layers_.outside) {
    if (!grid->forbids()) continue;
    for (const LinkPoint& probe : probes_)
      if (grid->value(T_world_base_ * (links_[probe.link] * probe.p_link)).forbidden)
        return {grid.get(), probe.link};
  }
  return {};
}

CostParts HumanCost::parts(const Vector& q) const {
  CostParts worst;
  worst.distance = std::numeric_limits<double>::infinity();
  if (!concerned()) return worst;
  robot_->forward(q, links_);
  const double outside = outside_cost([this](std::size_t i) {
    return T_world_base_ * (links_[probes_[i].link] * probes_[i].p_link);
  });
  const Vector3 p_tool = T_world_base_ * links_[tool_].translation();
  placed_.resize(capsules_.size());
  for (std::size_t i = 0; anyone() && i < capsules_.size(); ++i) {
    const LinkCapsule& capsule = capsules_[i];
    const Pose& T_root_link = links_[capsule.link];
    placed_[i] = {T_world_base_ * (T_root_link * capsule.a),
                  T_world_base_ * (T_root_link * capsule.b), capsule.radius};
  }
  double max_cost = -1;
  for (const Someone& one : someone_) {
    CostParts now;
    now.distance = distance_to(one.body);
    now.safety = safety_cost(now.distance, settings_.safety_radius);
    if (settings_.w_visibility > 0 && one.sight)
      now.visibility = visibility_cost(*one.sight, p_tool, settings_.visibility_cutoff);
    if (settings_.w_comfort > 0) now.comfort = arm_comfort_cost(one.comfort, one.arms, p_tool);
    if (weighted_cost(now, settings_) > max_cost) {
      max_cost = weighted_cost(now, settings_);
      worst = now;
    }
  }
  worst.outside = outside;
  return worst;
}

double HumanCost::operator()(const Vector& q) const {
  constexpr double kHere = 0;
  double cost = 0;
  on_line(q, q, &kHere, 1, &cost);
  return cost;
}

void HumanCost::on_line(const Vector& from, const Vector& to, const double* at, int count,
                        double* cost) const {
  if (!concerned()) {
    std::fill_n(cost, count, 0.0);
    return;
  }
  for (int first = 0; first < count; first += BatchCost::kStates) {
    const int here = std::min(BatchCost::kStates, count - first);
    if (!batch_ ||
        !batch_->run(from, to, at + first, here, layers_.outside.empty() ? 1 : probes_.size())) {
      for (int i = first; i < first + here; ++i) {
        CostParts now = parts(from + at[i] * (to - from));
        const double outside = std::exchange(now.outside, 0.0);
        cost[i] = gain_ * weighted_cost(now, settings_) + outside;
      }
      continue;
    }
    for (int slot = 0; slot < here; ++slot) {
      const Vector3 p_tool = batch_->point(0, slot);
      double max_cost = 0;
      for (std::size_t k = 0; k < someone_.size(); ++k) {
        CostParts now;
        now.safety = batch_->safety(k, slot);
        now.visibility = batch_->visibility(k, slot);
        if (settings_.w_comfort > 0)
          now.comfort = arm_comfort_cost(someone_[k].comfort, someone_[k].arms, p_tool);
        max_cost = std::max(max_cost, weighted_cost(now, settings_));
      }
      cost[first + slot] =
          gain_ * max_cost + outside_cost([&](std::size_t i) { return batch_->point(i, slot); });
    }
  }
}

}  // namespace handsel
