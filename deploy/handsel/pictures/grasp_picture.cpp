// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/pictures/grasp_picture.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "components/grasp_planner/list/frame_search.hpp"

namespace handsel {
namespace {

using namespace grasp_planner;

constexpr double kConeLength = 0.03;  // length of a cone [m]
constexpr Colour kObject = {200, 196, 182}, kLine = {60, 60, 60};
constexpr double kFinest = 0.0025;  // min edge of triangles coloured by curvature [m]

Colour curvature_colour(double c) {
  const auto part = [](double v) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
  };
  return {part(1 - 2 * c), part(1 - std::abs(2 * c - 1)), part(2 * c - 1)};
}

/// Halves the longest edge until none exceeds `max_edge` [m].
void cut(const Vector3& a, const Vector3& b, const Vector3& c, double longest,
         std::vector<std::array<Vector3, 3>>& out) {
  const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
  if (std::max({ab, bc, ca}) <= longest) {
    out.push_back({a, b, c});
  } else if (ab >= bc && ab >= ca) {
    const Vector3 m = 0.5 * (a + b);
    cut(a, m, c, longest, out);
    cut(m, b, c, longest, out);
  } else if (bc >= ca) {
    cut(b, c, a, longest, out);
  } else {
    cut(c, a, b, longest, out);
  }
}

}  // namespace

Colour finger_colour(std::size_t finger) {
  static constexpr std::array<Colour, 5> kColours = {
      {{214, 39, 40}, {44, 160, 44}, {31, 90, 200}, {208, 60, 208}, {255, 150, 20}}};
  return kColours[finger % kColours.size()];
}

void draw_object(Canvas& canvas, const Graspable& object, double opacity) {
  canvas.shape(std::make_shared<const TriangleMesh>(object.mesh()), Pose::Identity(), kObject,
               opacity);
}

void draw_hand(Canvas& canvas, const HandGeometry& hand_geometry, const Vector& q,
               const Pose& T_object_hand, Colour colour, double opacity) {
  std::vector<Pose> T_hand_link;
  const RobotModel& model = hand_geometry.hand.model();
  model.forward(q, T_hand_link);
  for (std::size_t l = 0; l < model.links().size(); ++l) {
    for (const PlacedShape& s : model.links()[l].collision)
      canvas.shape(s.shape, T_object_hand * T_hand_link[l] * s.T_parent_shape, colour, opacity);
  }
  for (std::size_t f = 0; f < hand_geometry.hand.fingers().size(); ++f) {
    const Finger& finger = hand_geometry.hand.fingers()[f];
    if (finger.pad) continue;
    const auto tip = static_cast<std::size_t>(model.link_index(finger.tip_link));
    canvas.ball((T_object_hand * T_hand_link[tip]).translation(), 1.02 * finger.tip_radius,
                finger_colour(f), opacity);
  }
}

void draw_contacts(Canvas& canvas, const Grasp& grasp) {
  for (const Contact& c : grasp.contacts) {
    canvas.ball(c.position, 0.003, finger_colour(c.finger));
    canvas.cone(c.position, c.normal, kConeLength, kConeLength * c.friction,
                finger_colour(c.finger), 0.45);
  }
}

void draw_force_ellipsoids(Canvas& canvas, const HandGeometry& hand_geometry, const Grasp& grasp) {
  std::vector<std::vector<Pose>> T_hand_step;
  hand_geometry.forward(grasp.hand_joints, T_hand_step);
  for (const Contact& c : grasp.contacts) {
    const Eigen::Matrix3Xd J = hand_geometry.chains[c.finger].jacobian(T_hand_step[c.finger]);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(Eigen::Matrix3d(J * J.transpose()));
    // Ellipsoid of the forces of unit efforts: semi-axes 1 / sqrt(eigenvalue), limited to eight
    // times the min, as a direction without motion has an infinite one.
    const Vector3 force =
        eigen.eigenvalues().cwiseMax(eigen.eigenvalues()[2] / 64).cwiseSqrt().cwiseInverse();
    const Eigen::Matrix3d R = grasp.T_object_hand.linear() * eigen.eigenvectors();
    const Colour colour = finger_colour(c.finger);
    canvas.ellipsoid(c.position, R * (kConeLength / force.maxCoeff() * force).asDiagonal(), colour,
                     0.4);
    const Vector3 main = kConeLength * R.col(0);
    canvas.stick(c.position - main, c.position + main, 0.0008, colour);
    canvas.stick(c.position, c.position + 1.4 * kConeLength * c.normal, 0.0008, kLine);
  }
}

void draw_curvature(Canvas& canvas, const Graspable& object, double radius) {
  std::vector<std::array<Vector3, 3>> pieces;
  const double longest = std::max(kFinest, object.box().sizes().maxCoeff() / 60);
  for (const auto& t : object.mesh().triangles) {
    const auto at = [&](std::size_t k) -> const Vector3& {
      return object.mesh().vertices[static_cast<std::size_t>(t[k])];
    };
    cut(at(0), at(1), at(2), longest, pieces);
  }
  std::vector<Vector3> corners, normals;
  for (const auto& p : pieces) {
    corners.insert(corners.end(), p.begin(), p.end());
    normals.insert(normals.end(), 3, (p[1] - p[0]).cross(p[2] - p[0]).normalized());
  }
  const std::vector<double> curvature = mean_curvature(object.mesh(), corners, normals, radius);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    std::array<Colour, 3> colours{};
    for (std::size_t k = 0; k < 3; ++k)
      colours[k] = curvature_colour(normalised_curvature(curvature[3 * i + k], radius));
    canvas.triangle(pieces[i], colours);
  }
}

void draw_points(Canvas& canvas, const Graspable& object, int depth) {
  const double size = object.box().sizes().maxCoeff() / 180;
  for (const SurfacePoint& p : object.points()) canvas.ball(p.position, size, {31, 90, 200});
  if (depth < 0) return;
  std::size_t n = 0;
  for (const Eigen::AlignedBox3d& box : PointTree([&] {
                                          std::vector<Vector3> positions;
                                          for (const SurfacePoint& p : object.points())
                                            positions.push_back(p.position);
                                          return positions;
                                        }())
                                            .boxes(depth))
    canvas.box_edges(box, Pose::Identity(), size / 4, finger_colour(n++));
}

void draw_workspace(Canvas& canvas, const FingerWorkspace& workspace, Colour colour, bool spheres) {
  if (spheres) {
    for (const WorkspaceSphere& s : workspace.spheres())
      canvas.ball(s.centre, s.radius, colour, 0.6);
  } else {
    for (const Vector3& p : workspace.cells()) canvas.ball(p, 0.0009, colour);
  }
}

void draw_candidates(Canvas& canvas, const HandGeometry& hand_geometry,
                     const FingerWorkspaces& workspaces, const Graspable& object,
                     const Pose& T_object_hand) {
  const GraspListSettings settings;
  FrameSearch search(hand_geometry, workspaces, object, settings);
  const double size = object.box().sizes().maxCoeff() / 90;
  std::vector<std::uint32_t> points;
  for (std::size_t f = 0; f < hand_geometry.chains.size(); ++f) {
    search.candidates(static_cast<int>(f), T_object_hand, points);
    // A point covered by several fingers shows their colours side by side.
    for (const std::uint32_t i : points) {
      const SurfacePoint& p = object.points()[i];
      const double turn = 1.5707963 * static_cast<double>(f);
      const Vector3 u = p.normal.unitOrthogonal();
      canvas.ball(
          p.position + 0.7 * size * (std::cos(turn) * u + std::sin(turn) * p.normal.cross(u)), size,
          finger_colour(f));
    }
  }
}

}  // namespace handsel
