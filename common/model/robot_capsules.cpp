// SPDX-License-Identifier: Apache-2.0
#include "common/model/robot_capsules.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/segments.hpp"

namespace handsel {
namespace {

using Points = std::vector<Vector3>;

struct Fit {
  Vector3 a, b;
  double radius{};
  double volume() const { return M_PI * radius * radius * ((a - b).norm() + 4.0 / 3.0 * radius); }
};

/// Returns the capsule along `axis`, through the middle of the points, that contains all of them.
Fit fit_along(const Points& points, const Vector3& axis) {
  const Vector3 u = axis.unitOrthogonal(), v = axis.cross(u);
  Eigen::Array3d low = Eigen::Array3d::Constant(1e300), high = -low;
  for (const auto& p : points) {
    const Eigen::Array3d c(p.dot(axis), p.dot(u), p.dot(v));
    low = low.min(c);
    high = high.max(c);
  }
  const Eigen::Array3d c = (low + high) / 2;
  const Vector3 centre = c[0] * axis + c[1] * u + c[2] * v;
  double radius = 0;
  for (const auto& p : points) radius = std::max(radius, axis.cross(p - centre).norm());
  radius = radius * 1.03 + 1e-9;
  double top = 0, bottom = 0;
  for (const auto& p : points) {
    const double along = axis.dot(p - centre),
                 cap = std::sqrt(
                     std::max(radius * radius - axis.cross(p - centre).squaredNorm(), 0.0));
    top = std::max(top, along - cap);
    bottom = std::min(bottom, along + cap);
  }
  return {centre + bottom * axis, centre + top * axis, radius};
}

Fit fit(const Points& points) {
  Vector3 mean = Vector3::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& p : points) covariance += (p - mean) * (p - mean).transpose();
  const Eigen::Matrix3d main =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  Fit best = fit_along(points, Vector3::UnitX());
  for (const Vector3& axis : {Vector3(Vector3::UnitY()), Vector3(Vector3::UnitZ()),
                              Vector3(main.col(0)), Vector3(main.col(1)), Vector3(main.col(2))})
    if (const Fit other = fit_along(points, axis); other.volume() < best.volume()) best = other;
  return best;
}

/// Divides flat boxes into strips side by side.
void fit_box(const Vector3& size, std::vector<Fit>& out) {
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int i, int k) { return size[i] > size[k]; });
  const int strips = std::clamp(
      static_cast<int>(std::ceil(size[order[1]] / std::max(size[order[2]], 0.05))), 1, 4);
  for (int s = 0; s < strips; ++s) {
    const double width = size[order[1]] / strips;
    Points corners;
    for (int c = 0; c < 8; ++c) {
      Vector3 p;
      p[order[0]] = (c & 1 ? 0.5 : -0.5) * size[order[0]];
      p[order[1]] = -0.5 * size[order[1]] + (s + (c & 2 ? 1 : 0)) * width;
      p[order[2]] = (c & 4 ? 0.5 : -0.5) * size[order[2]];
      corners.push_back(p);
    }
    out.push_back(fit_along(corners, Vector3::Unit(order[0])));
  }
}

struct Fitter {
  std::vector<Fit>& out;
  void operator()(const Sphere& s) const {
    out.push_back({Vector3::Zero(), Vector3::Zero(), s.radius});
  }
  void operator()(const Box& b) const { fit_box(b.size, out); }
  void operator()(const Cylinder& c) const {
    const double radius = std::max(
        c.radius * 1.08, c.length / 2 < 0.4 * c.radius ? std::hypot(c.radius, c.length / 2) : 0.0);
    const double half =
        std::max(c.length / 2 - std::sqrt(radius * radius - c.radius * c.radius), 0.0);
    out.push_back({{0, 0, -half}, {0, 0, half}, radius});
  }
  void operator()(const Capsule& c) const {
    out.push_back({{0, 0, -c.length / 2}, {0, 0, c.length / 2}, c.radius});
  }
  void operator()(const MeshPtr& m) const { out.push_back(fit(m->vertices)); }
};

bool excepted(const SeparationExemption& exception, const std::string& person, BodyPart part) {
  if (exception.person.empty() || exception.person != person) return false;
  const bool right = part == BodyPart::forearm_right || part == BodyPart::hand_right;
  const bool left = part == BodyPart::forearm_left || part == BodyPart::hand_left;
  return (right && (exception.both_sides || exception.side == Side::right)) ||
         (left && (exception.both_sides || exception.side == Side::left));
}

}  // namespace

std::vector<LinkCapsule> robot_capsules(const RobotModel& robot) {
  std::vector<LinkCapsule> capsules;
  for (std::size_t link = 0; link < robot.links().size(); ++link)
    for (const auto& placed : robot.links()[link].collision) {
      std::vector<Fit> fits;
      std::visit(Fitter{fits}, placed.shape);
      for (const auto& f : fits)
        capsules.push_back({static_cast<int>(link), placed.T_parent_shape * f.a,
                            placed.T_parent_shape * f.b, f.radius});
    }
  return capsules;
}

Separation separation(const std::vector<LinkCapsule>& robot, const std::vector<Pose>& T_root_link,
                      const Pose& T_world_base, const HumanState& people,
                      const SeparationExemption& exception) {
  Separation best;
  best.distance = std::numeric_limits<double>::infinity();
  const Person* nearest = nullptr;
  Vector3 axis = Vector3::Zero();
  std::array<BodyCapsule, kBodyCapsules> body;
  for (const auto& person : people.people) {
    if (person.joints.empty()) continue;
    body_capsules(person, body);
    std::array<Vector3, kBodyCapsules> middle;
    std::array<double, kBodyCapsules> size;
    std::array<bool, kBodyCapsules> skip;
    for (std::size_t i = 0; i < body.size(); ++i) {
      middle[i] = (body[i].a + body[i].b) / 2;
      size[i] = (body[i].a - body[i].b).norm() / 2 + body[i].radius;
      skip[i] = excepted(exception, person.id, body[i].part);
    }
    for (const auto& capsule : robot) {
      const Pose& T = T_root_link[capsule.link];
      const Vector3 a = T_world_base * (T * capsule.a), b = T_world_base * (T * capsule.b),
                    m = (a + b) / 2;
      const double extent = (a - b).norm() / 2 + capsule.radius;
      for (std::size_t i = 0; i < body.size(); ++i) {
        const double bound = best.distance + extent + size[i];
        if (skip[i] || (bound > 0 && (m - middle[i]).squaredNorm() > bound * bound)) continue;
        Vector3 on_robot, on_person;
        const double axes_apart =
            std::sqrt(nearest_points(a, b, body[i].a, body[i].b, on_robot, on_person));
        const double distance = axes_apart - capsule.radius - body[i].radius;
        if (distance >= best.distance) continue;
        best.distance = distance;
        best.link = capsule.link;
        best.part = body[i].part;
        axis = axes_apart > 1e-9 ? Vector3((on_person - on_robot) / axes_apart) : Vector3::UnitX();
        best.on_robot = on_robot + capsule.radius * axis;
        best.on_person = on_person - body[i].radius * axis;
        nearest = &person;
      }
    }
  }
  if (nearest != nullptr) best.person = nearest->id;
  return best;
}

}  // namespace handsel
