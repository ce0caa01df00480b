// SPDX-License-Identifier: Apache-2.0
#include "common/cost/navigation_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/segments.hpp"
#include "common/model/platform.hpp"

namespace handsel {
namespace {

using Eigen::Vector2d;

constexpr double kNear = 0.6;  // range in the chapter's cost function [m]

double square(double x) { return x * x; }

/// Decreases from 1 to 0 over `range` [m].
double fade(double x, double range) {
  return x >= range ? 0.0 : square(std::cos(std::max(0.0, x) * M_PI / (2 * range)));
}

double point_to_segment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double ratio = along.squaredNorm() > 0
                           ? std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0)
                           : 0.0;
  return (p - a - ratio * along).norm();
}

double segment_to_segment(const Vector2d& a, const Vector2d& b, const Vector2d& c,
                          const Vector2d& d) {
  Vector3 on_first, on_second;
  const auto level = [](const Vector2d& p) { return Vector3(p.x(), p.y(), 0); };
  return std::sqrt(nearest_points(level(a), level(b), level(c), level(d), on_first, on_second));
}

double angle(const Vector2d& a, const Vector2d& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

}  // namespace

double platform_safety_cost(double gap, double radius) {
  const double d = std::max(0.0, gap);
  if (d >= radius) return 0.0;
  const double base = std::cos(d * M_PI / (2 * radius)) * kNear / (kNear + d);
  return base * base * base;
}

NavigationCost::NavigationCost(const RobotModel& robot, const CostSettings& weights,
                               const NavigationSettings& settings)
    : settings_(settings), w_safety_(weights.w_safety), w_visibility_(weights.w_visibility) {
  const int root = robot.require_group(kPlatformGroup).tip;
  std::vector<Pose> T_world_link;
  Vector q = Vector::Zero(robot.dof());
  robot.forward(q, T_world_link);
  std::vector<bool> rigid(robot.links().size(), false);
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    const int joint = robot.links()[i].parent_joint;
    rigid[i] =
        static_cast<int>(i) == root ||
        (joint >= 0 &&
         rigid[static_cast<std::size_t>(robot.joints()[static_cast<std::size_t>(joint)].parent)] &&
         robot.joints()[static_cast<std::size_t>(joint)].kind == JointKind::fixed);
  }
  for (const LinkCapsule& capsule : robot_capsules(robot)) {
    const auto link = static_cast<std::size_t>(capsule.link);
    if (!rigid[link]) continue;
    outline_.push_back({(T_world_link[link] * capsule.a).head<2>(),
                        (T_world_link[link] * capsule.b).head<2>(), capsule.radius});
  }
}

void NavigationCost::set_people(const HumanState& people, const Pose& T_world_root) {
  const Pose T_root_world = T_world_root.inverse();
  const auto turned = [&](const Vector3& v) {
    return Vector2d((T_root_world.linear() * v).head<2>());
  };
  someone_.clear();
  for (const Person& person : people.people) {
    const SimplifiedBody body = simplified_body(person);
    Someone one{};
    one.place = (T_root_world * body.axis_bottom).head<2>();
    one.body = body.radius;
    const auto sight = sight_of(person);
    one.gaze = sight && sight->direction.head<2>().norm() > 1e-6
                   ? turned(sight->direction).normalized()
                   : Vector2d::Zero();
    one.velocity.setZero();
    for (const char* name : {"waist", "torso", "head"})
      if (const BodyJoint* joint = find_joint(person, name)) {
        one.velocity = turned(joint->velocity);
        break;
      }
    one.speed = one.velocity.norm();
    one.radius = one.speed > settings_.moving ? settings_.radius_moving : settings_.radius;
    someone_.push_back(one);
  }
  find_conversations();
}

void NavigationCost::find_conversations() {
  conversations_.clear();
  const auto faces = [this](const Someone& one, const Someone& other) {
    return !one.gaze.isZero() && angle(one.gaze, other.place - one.place) < settings_.facing;
  };
  for (std::size_t i = 0; i < someone_.size(); ++i)
    for (std::size_t k = i + 1; k < someone_.size(); ++k) {
      const Someone &a = someone_[i], &b = someone_[k];
      if ((a.place - b.place).norm() < settings_.conversation && faces(a, b) && faces(b, a))
        conversations_.emplace_back(a.place, b.place);
    }
}

/// Returns the cost of a platform between two people who talk: max on the line between them.
double NavigationCost::between_people(const Eigen::Rotation2Dd& turn, const Vector2d& place) const {
  double worst = 0;
  for (const auto& [a, b] : conversations_) {
    double gap = std::numeric_limits<double>::infinity();
    for (const Disc& part : outline_)
      gap = std::min(gap, segment_to_segment(place + turn * part.a, place + turn * part.b, a, b) -
                              part.radius);
    worst = std::max(worst, fade(gap, settings_.between));
  }
  return worst;
}

double NavigationCost::of(const Someone& one, double gap, const Vector2d& to_platform) const {
  double safety = platform_safety_cost(gap, one.radius), visibility = 0;
  if (one.speed > settings_.moving)
    safety = std::max(safety, fade(angle(one.velocity, to_platform), settings_.cone) *
                                  fade(gap, one.radius + settings_.cone_time * one.speed));
  if (!one.gaze.isZero()) {
    const double beside = angle(one.gaze, to_platform) - settings_.field;
    visibility = std::max(0.0, beside) / (M_PI - settings_.field) * fade(gap, one.radius);
  }
  return (w_safety_ * safety + w_visibility_ * visibility) /
         std::max(1e-9, w_safety_ + w_visibility_);
}

double NavigationCost::operator()(double x, double y, double heading) const {
  const Eigen::Rotation2Dd turn(heading);
  const Vector2d place(x, y);
  double worst = between_people(turn, place);
  for (const Someone& one : someone_) {
    const Vector2d seen = turn.inverse() * (one.place - place);
    double gap = std::numeric_limits<double>::infinity();
    for (const Disc& part : outline_)
      gap = std::min(gap, point_to_segment(seen, part.a, part.b) - part.radius);
    worst = std::max(worst, of(one, gap - one.body, place - one.place));
  }
  return worst;
}

}  // namespace handsel
