// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/pictures/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace handsel {
namespace {

constexpr int kFine = 3;  // samples along each side of a pixel
constexpr int kRound = 28;

using Triangles = std::vector<std::array<int, 3>>;

/// Adds a surface of revolution about z: radius and height of each ring; closed at both ends.
void lathe(const std::vector<std::pair<double, double>>& profile, std::vector<Vector3>& vertices,
           Triangles& triangles) {
  for (const auto& [radius, z] : profile) {
    for (int i = 0; i < kRound; ++i) {
      const double angle = 2 * std::numbers::pi * i / kRound;
      vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  for (int k = 0; k + 1 < static_cast<int>(profile.size()); ++k) {
    for (int i = 0; i < kRound; ++i) {
      const int a = k * kRound + i, b = k * kRound + (i + 1) % kRound;
      triangles.push_back({a, b, b + kRound});
      triangles.push_back({a, b + kRound, a + kRound});
    }
  }
}

std::vector<std::pair<double, double>> capsule_profile(double radius, double half) {
  std::vector<std::pair<double, double>> out;
  for (const double side : {-1.0, 1.0}) {
    for (int k = 0; k <= 6; ++k) {
      const double angle = std::numbers::pi / 2 * (side < 0 ? 1 - k / 6.0 : k / 6.0);
      out.emplace_back(radius * std::cos(angle), side * (half + radius * std::sin(angle)));
    }
  }
  return out;
}

Eigen::Vector3f plain(Colour c) {
  return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

Pose along(const Vector3& from, const Vector3& axis) {
  return make_pose(from, Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), axis));
}

Eigen::Matrix3d axes(const Eye& eye) {
  const Vector3 z = eye.from.normalized();
  Vector3 x = eye.up.cross(z);
  if (x.norm() < 1e-6) x = z.unitOrthogonal();
  x.normalize();
  Eigen::Matrix3d rows;
  rows << x.transpose(), z.cross(x).transpose(), z.transpose();
  return rows;
}

}  // namespace

Eye eye_on(const Eigen::AlignedBox3d& box, const Vector3& from) {
  Eye eye;
  eye.target = box.center();
  eye.from = from;
  const Vector3 half = axes(eye).cwiseAbs() * (0.5 * box.sizes());
  eye.height = 2.08 * std::max(half.x(), half.y());
  return eye;
}

Canvas::Canvas(int width, int height, const Eye& eye)
    : width_(width * kFine),
      height_(height * kFine),
      target_(eye.target),
      scale_(height_ / eye.height) {
  R_eye_world_ = axes(eye);
  samples_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                  {Eigen::Vector3f::Constant(255), -std::numeric_limits<float>::infinity()});
}

Eigen::Vector3f Canvas::project(const Vector3& p) const {
  const Vector3 e = R_eye_world_ * (p - target_);
  return Vector3(0.5 * width_ + scale_ * e.x(), 0.5 * height_ - scale_ * e.y(), e.z())
      .cast<float>();
}

double Canvas::light(const Vector3& a, const Vector3& b, const Vector3& c) const {
  const Vector3 n = R_eye_world_ * (b - a).cross(c - a).normalized();
  static const Vector3 lamp = Vector3(-0.4, 0.6, 0.7).normalized();
  return 0.45 + 0.55 * std::abs(n.dot(lamp));
}

void Canvas::triangle(const Vector3& a, const Vector3& b, const Vector3& c, Colour colour,
                      double opacity) {
  const Eigen::Vector3f lit = static_cast<float>(light(a, b, c)) * plain(colour);
  const Piece piece{
      {project(a), project(b), project(c)}, {lit, lit, lit}, static_cast<float>(opacity)};
  if (opacity < 1) {
    seen_through_.push_back(piece);
  } else {
    put(piece, samples_);
  }
}

void Canvas::triangle(const std::array<Vector3, 3>& corners, const std::array<Colour, 3>& colours) {
  const auto lit = static_cast<float>(light(corners[0], corners[1], corners[2]));
  Piece piece{{}, {}, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    piece.corners[k] = project(corners[k]);
    piece.colours[k] = lit * plain(colours[k]);
  }
  put(piece, samples_);
}

void Canvas::put(const Piece& piece, std::vector<Sample>& samples) const {
  const Eigen::Vector3f &p = piece.corners[0], &q = piece.corners[1], &r = piece.corners[2];
  const float area = (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
  if (!(std::abs(area) > 1e-9F)) return;
  const auto min_of = [&](int k) { return std::min({p[k], q[k], r[k]}); };
  const auto max_of = [&](int k) { return std::max({p[k], q[k], r[k]}); };
  const int x0 = std::max(0, static_cast<int>(std::ceil(min_of(0) - 0.5F))),
            x1 = std::min(width_ - 1, static_cast<int>(max_of(0)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(min_of(1) - 0.5F))),
            y1 = std::min(height_ - 1, static_cast<int>(max_of(1)));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const float px = static_cast<float>(x) + 0.5F, py = static_cast<float>(y) + 0.5F;
      const float u = ((q.x() - px) * (r.y() - py) - (q.y() - py) * (r.x() - px)) / area;
      const float v = ((r.x() - px) * (p.y() - py) - (r.y() - py) * (p.x() - px)) / area;
      const float w = 1 - u - v;
      if (u < -1e-5F || v < -1e-5F || w < -1e-5F) continue;
      const float depth = u * p.z() + v * q.z() + w * r.z();
      Sample& s = samples[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                          static_cast<std::size_t>(x)];
      if (depth <= s.depth) continue;
      const Eigen::Vector3f colour =
          u * piece.colours[0] + v * piece.colours[1] + w * piece.colours[2];
      s.colour += piece.opacity * (colour - s.colour);
      if (piece.opacity >= 1) s.depth = depth;
    }
  }
}

void Canvas::mesh(const std::vector<Vector3>& vertices, const Triangles& triangles, const Pose& T,
                  Colour colour, double opacity) {
  for (const auto& t : triangles) {
    const auto at = [&](std::size_t k) {
      return Vector3(T * vertices[static_cast<std::size_t>(t[k])]);
    };
    triangle(at(0), at(1), at(2), colour, opacity);
  }
}

void Canvas::shape(const Shape& shape, const Pose& T, Colour colour, double opacity) {
  std::vector<Vector3> vertices;
  Triangles triangles;
  if (const auto* s = std::get_if<Sphere>(&shape))
    lathe(capsule_profile(s->radius, 0), vertices, triangles);
  if (const auto* c = std::get_if<Capsule>(&shape))
    lathe(capsule_profile(c->radius, c->length / 2), vertices, triangles);
  if (const auto* c = std::get_if<Cylinder>(&shape))
    lathe({{0, -c->length / 2},
           {c->radius, -c->length / 2},
           {c->radius, c->length / 2},
           {0, c->length / 2}},
          vertices, triangles);
  if (const auto* b = std::get_if<Box>(&shape)) {
    for (int i = 0; i < 8; ++i)
      vertices.emplace_back(
          0.5 * b->size.cwiseProduct(Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
    triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  }
  if (const auto* m = std::get_if<MeshPtr>(&shape)) {
    mesh((*m)->vertices, (*m)->triangles, T, colour, opacity);
  } else {
    mesh(vertices, triangles, T, colour, opacity);
  }
}

void Canvas::ball(const Vector3& centre, double radius, Colour colour, double opacity) {
  shape(Sphere{radius}, make_pose(centre), colour, opacity);
}

void Canvas::ellipsoid(const Vector3& centre, const Eigen::Matrix3d& axes, Colour colour,
                       double opacity) {
  std::vector<Vector3> vertices;
  Triangles triangles;
  lathe(capsule_profile(1, 0), vertices, triangles);
  for (Vector3& v : vertices) v = axes * v;
  mesh(vertices, triangles, make_pose(centre), colour, opacity);
}

void Canvas::stick(const Vector3& a, const Vector3& b, double radius, Colour colour) {
  const double length = (b - a).norm();
  if (length > 0) shape(Capsule{radius, length}, along(0.5 * (a + b), (b - a) / length), colour);
}

void Canvas::cone(const Vector3& apex, const Vector3& axis, double length, double radius,
                  Colour colour, double opacity) {
  std::vector<Vector3> vertices;
  Triangles triangles;
  lathe({{0, 0}, {radius, length}}, vertices, triangles);
  mesh(vertices, triangles, along(apex, axis), colour, opacity);
}

void Canvas::box_edges(const Eigen::AlignedBox3d& box, const Pose& T, double radius,
                       Colour colour) {
  for (int i = 0; i < 8; ++i) {
    for (const int bit : {1, 2, 4}) {
      if (i & bit) continue;
      const auto corner = [&](int k) {
        return Vector3(T * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)));
      };
      stick(corner(i), corner(i | bit), radius, colour);
    }
  }
}

Picture Canvas::picture() const {
  std::vector<Sample> samples = samples_;
  std::vector<Piece> order = seen_through_;
  const auto depth = [](const Piece& p) {
    return p.corners[0].z() + p.corners[1].z() + p.corners[2].z();
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const Piece& a, const Piece& b) { return depth(a) < depth(b); });
  for (const Piece& p : order) put(p, samples);
  Picture out(width_ / kFine, height_ / kFine, {255, 255, 255});
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (int k = 0; k < kFine * kFine; ++k)
        sum += samples[static_cast<std::size_t>((y * kFine + k / kFine) * width_ + x * kFine +
                                                k % kFine)]
                   .colour;
      Colour colour{};
      for (int c = 0; c < 3; ++c)
        colour[static_cast<std::size_t>(c)] =
            static_cast<std::uint8_t>(std::clamp(sum[c] / (kFine * kFine), 0.0F, 255.0F));
      out.dot(x, y, colour);
    }
  }
  return out;
}

Picture from_sides(const Eigen::AlignedBox3d& box, const std::vector<Vector3>& directions, int size,
                   const std::function<void(Canvas&, std::size_t side)>& draw) {
  Picture out(size * static_cast<int>(directions.size()), size, {255, 255, 255});
  for (std::size_t side = 0; side < directions.size(); ++side) {
    Canvas canvas(size, size, eye_on(box, directions[side]));
    draw(canvas, side);
    const Picture one = canvas.picture();
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) out.dot(static_cast<int>(side) * size + x, y, one.at(x, y));
    }
  }
  return out;
}

}  // namespace handsel
