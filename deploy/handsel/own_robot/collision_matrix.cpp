// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/collision_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "common/collision/collision_shape.hpp"
#include "common/geometry/segments.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {
namespace {

/// The collision shapes of the links, prepared for tests.
class LinkShapes {
 public:
  explicit LinkShapes(const RobotModel& robot) : robot_(robot), shapes_(robot.links().size()) {
    for (std::size_t l = 0; l < shapes_.size(); ++l)
      for (const PlacedShape& placed : robot.links()[l].collision)
        shapes_[l].push_back({CollisionShape::make(placed.shape), placed.T_parent_shape});
  }

  void move(const Vector& q) { robot_.forward(q, T_root_link_); }

  bool have(std::size_t link) const { return !shapes_[link].empty(); }

  bool touch(const LinkPair& pair) const {
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    for (const Placed& x : shapes_[a])
      for (const Placed& y : shapes_[b]) {
        const Pose T_x = T_root_link_[a] * x.T_link_shape, T_y = T_root_link_[b] * y.T_link_shape;
        if (may_touch(*x.shape, T_x, *y.shape, T_y) && handsel::touch(*x.shape, T_x, *y.shape, T_y))
          return true;
      }
    return false;
  }

 private:
  struct Placed {
    CollisionShapePtr shape;
    Pose T_link_shape;
  };
  const RobotModel& robot_;
  std::vector<std::vector<Placed>> shapes_;  // by link
  std::vector<Pose> T_root_link_;
};

class Configurations {
 public:
  Configurations(const RobotModel& robot, std::uint64_t seed) : robot_(robot), random_(seed) {}

  Vector next() {
    Vector q(robot_.dof());
    for (int i = 0; i < robot_.dof(); ++i) {
      const Axis& axis = robot_.axes()[static_cast<std::size_t>(i)];
      q[i] = std::uniform_real_distribution<double>(axis.lower, axis.upper)(random_);
    }
    return q;
  }

 private:
  const RobotModel& robot_;
  std::mt19937_64 random_;
};

}  // namespace

const char* name_of(PairKind kind) {
  switch (kind) {
    case PairKind::sometimes:
      return "Sometimes";
    case PairKind::never:
      return "Never";
    case PairKind::always:
      return "Always";
  }
  return "Sometimes";
}

std::vector<LinkPair> sample_pairs(const RobotModel& robot, const MatrixSettings& settings,
                                   const std::function<bool(double)>& progress) {
  constexpr int kProgress = 250;  // configurations between two reports of progress
  LinkShapes shapes(robot);
  std::vector<LinkPair> pairs;
  for (int b = 0; b < static_cast<int>(robot.links().size()); ++b)
    for (int a = 0; a < b; ++a)
      if (shapes.have(static_cast<std::size_t>(a)) && shapes.have(static_cast<std::size_t>(b)) &&
          !robot.pair_disabled(a, b))
        pairs.push_back({a, b, PairKind::never, 0});
  Configurations random(robot, settings.seed);
  for (int n = 0; n < settings.first; ++n) {
    if (n % kProgress == 0) progress(static_cast<double>(n) / settings.configurations);
    shapes.move(random.next());
    for (LinkPair& pair : pairs)
      if (shapes.touch(pair)) pair.touched += 1.0 / settings.first;
  }
  std::vector<LinkPair*> untouched;
  for (LinkPair& pair : pairs) {
    if (pair.touched >= settings.always)
      pair.kind = PairKind::always;
    else if (pair.touched > 0)
      pair.kind = PairKind::sometimes;
    else
      untouched.push_back(&pair);
  }
  for (int n = settings.first; n < settings.configurations && !untouched.empty(); ++n) {
    if (n % kProgress == 0 && !progress(static_cast<double>(n) / settings.configurations)) break;
    shapes.move(random.next());
    std::erase_if(untouched, [&](LinkPair* pair) {
      if (!shapes.touch(*pair)) return false;
      pair->kind = PairKind::sometimes;
      return true;
    });
  }
  return pairs;
}

std::vector<std::pair<int, int>> overlapping_hulls(const RobotModel& robot, const Vector& q) {
  const auto capsules = robot_capsules(robot);
  std::vector<Pose> T;
  robot.forward(q, T);
  std::vector<std::pair<int, int>> seen;
  Vector3 on_a, on_b;
  for (std::size_t i = 0; i < capsules.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const LinkCapsule &a = capsules[i], &b = capsules[k];
      if (a.link == b.link || robot.pair_disabled(a.link, b.link)) continue;
      const auto la = static_cast<std::size_t>(a.link), lb = static_cast<std::size_t>(b.link);
      const double apart =
          std::sqrt(nearest_points(T[la] * a.a, T[la] * a.b, T[lb] * b.a, T[lb] * b.b, on_a, on_b));
      const std::pair pair(b.link, a.link);
      if (apart < a.radius + b.radius && std::find(seen.begin(), seen.end(), pair) == seen.end())
        seen.push_back(pair);
    }
  return seen;
}

}  // namespace handsel
