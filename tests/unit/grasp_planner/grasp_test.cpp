// SPDX-License-Identifier: Apache-2.0
// Parts of the grasp planner: orientations, surface points, trees, curvature.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "components/grasp_planner/list/so3_grid.hpp"
#include "components/grasp_planner/object/point_tree.hpp"
#include "components/grasp_planner/object/surface.hpp"
#include "components/grasp_planner/object/triangle_tree.hpp"

namespace handsel::grasp_planner::grasp_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double angle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return 2 * std::acos(std::min(1.0, std::abs(a.dot(b))));
}

// Returns the max rotation angle [deg] from 2000 random orientations to the nearest of the set;
// with `climb` also from local maxima that start at the first 150.
double dispersion(const std::vector<Eigen::Quaterniond>& set, std::uint64_t seed, bool climb) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto nearest = [&](const Eigen::Quaterniond& q) {
    double best = 0;
    for (const auto& s : set) best = std::max(best, std::abs(s.dot(q)));
    return 2 * std::acos(std::min(1.0, best));
  };
  double worst = 0;
  for (int start = 0; start < (climb ? 150 : 2000); ++start) {
    Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    q.normalize();
    double here = nearest(q);
    for (double step = 0.2; climb && step > 1e-4; step *= 0.8) {
      for (int k = 0; k < 6; ++k) {
        Eigen::Quaterniond next(q.coeffs() + step * Eigen::Vector4d(normal(random), normal(random),
                                                                    normal(random),
                                                                    normal(random)));
        next.normalize();
        const double there = nearest(next);
        if (there > here) {
          here = there;
          q = next;
        }
      }
    }
    worst = std::max(worst, here);
  }
  return worst / kDegree;
}

TEST(So3Grid, dispersion_halves_with_each_level) {
  const double sampled[] = {52.9, 24.6, 12.2}, bound[] = {56.3, 27.9, 13.9};
  for (int level = 0; level <= 2; ++level) {
    std::vector<Eigen::Quaterniond> grid;
    for (std::uint64_t i = 0; i < so3_grid_size(level); ++i)
      grid.push_back(so3_grid_cell(level, i));
    EXPECT_NEAR(dispersion(grid, 3, false), sampled[level], 1.2) << "level " << level;
    EXPECT_NEAR(dispersion(grid, 3, true), bound[level], 0.3) << "level " << level;
  }
}

TEST(So3Grid, longer_sequences_begin_with_shorter_ones_and_prefixes_cover_evenly) {
  const auto small = so3_sequence(100), large = so3_sequence(648 + 72);
  ASSERT_EQ(small.size(), 100U);
  ASSERT_EQ(large.size(), 720U);
  for (std::size_t i = 0; i < small.size(); ++i) EXPECT_EQ(small[i].coeffs(), large[i].coeffs());
  for (std::size_t i = 0; i < large.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GT(angle(large[i], large[j]), 1 * kDegree) << i << " " << j;
  }
  const auto some = so3_sequence(24);
  EXPECT_LT(dispersion(some, 5, true), 100);
}

TriangleMesh cylinder(double radius, double height, int around, int along) {
  TriangleMesh m;
  for (int k = 0; k <= along; ++k) {
    for (int i = 0; i < around; ++i) {
      const double a = 2 * std::numbers::pi * i / around;
      m.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), height * k / along);
    }
  }
  for (int k = 0; k < along; ++k) {
    for (int i = 0; i < around; ++i) {
      const int a = k * around + i, b = k * around + (i + 1) % around;
      m.triangles.push_back({a, b, b + around});
      m.triangles.push_back({a, b + around, a + around});
    }
  }
  const int bottom = static_cast<int>(m.vertices.size());
  m.vertices.emplace_back(0, 0, 0);
  m.vertices.emplace_back(0, 0, height);
  for (int i = 0; i < around; ++i) {
    m.triangles.push_back({bottom, (i + 1) % around, i});
    m.triangles.push_back({bottom + 1, along * around + i, along * around + (i + 1) % around});
  }
  return m;
}

TEST(Surface, points_lie_on_their_triangles_and_cover_the_surface) {
  TriangleMesh m = cylinder(0.04, 0.1, 48, 10);
  EXPECT_EQ(orient(m).turned, 0U);
  SurfaceSettings s;
  const auto points = sample_surface(m, s);
  ASSERT_GT(points.size(), 200U);
  for (const SurfacePoint& p : points) {
    const auto& t = m.triangles[p.triangle];
    const Vector3 on = p.barycentric[0] * m.vertices[static_cast<std::size_t>(t[0])] +
                       p.barycentric[1] * m.vertices[static_cast<std::size_t>(t[1])] +
                       p.barycentric[2] * m.vertices[static_cast<std::size_t>(t[2])];
    EXPECT_LT((on - p.position).norm(), 1e-12);
    EXPECT_GE(p.barycentric.minCoeff(), 0);
    EXPECT_NEAR(p.normal.norm(), 1, 1e-12);
    EXPECT_GT(p.normal.dot(p.position - Vector3(0, 0, 0.05)), 0);
  }
  std::mt19937_64 random(9);
  for (int i = 0; i < 500; ++i) {
    const double a = 2 * std::numbers::pi * static_cast<double>(random() % 1000) / 1000,
                 z = 0.1 * static_cast<double>(random() % 1000) / 1000;
    double nearest = 1;
    for (const SurfacePoint& p : points)
      nearest = std::min(nearest,
                         (p.position - Vector3(0.04 * std::cos(a), 0.04 * std::sin(a), z)).norm());
    EXPECT_LT(nearest, 1.3 * s.step);
  }
  const auto again = sample_surface(m, s);
  ASSERT_EQ(again.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(again[i].position, points[i].position);
}

TEST(Surface, mean_curvature_of_a_cylinder_is_half_its_inverse_radius) {
  const TriangleMesh m = cylinder(0.05, 0.4, 200, 60);
  const auto h = mean_curvature(m, {{0.05, 0, 0.2}, {0, 0.05, 0.15}, {0.01, 0, 0.4}},
                                {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 0.013);
  EXPECT_NEAR(h[0], 1 / (2 * 0.05), 1);
  EXPECT_NEAR(h[1], 1 / (2 * 0.05), 1);
  EXPECT_NEAR(h[2], 0, 1e-9);
}

TEST(Surface, the_other_side_of_a_thin_wall_does_not_hide_an_edge) {
  // A cup with a wall of 3 mm: the inner edge at the bottom bends opposite to the outer one.
  TriangleMesh outer = cylinder(0.05, 0.1, 100, 20), inner = cylinder(0.047, 0.097, 100, 20);
  orient(outer);
  orient(inner);
  const auto shift = static_cast<int>(outer.vertices.size());
  for (const Vector3& v : inner.vertices) outer.vertices.push_back(v + Vector3(0, 0, 0.0015));
  for (const auto& t : inner.triangles)
    outer.triangles.push_back({t[0] + shift, t[2] + shift, t[1] + shift});
  const auto h = mean_curvature(outer, {{0.05, 0, 0.002}}, {{1, 0, 0}}, 0.013);
  EXPECT_GT(normalised_curvature(h[0], 0.013), 0.7);
}

TEST(Surface, turned_triangles_are_mended) {
  TriangleMesh m = cylinder(0.04, 0.1, 24, 4);
  for (std::size_t i = 0; i < m.triangles.size(); i += 3)
    std::swap(m.triangles[i][0], m.triangles[i][1]);
  const MeshFindings f = orient(m);
  EXPECT_EQ(f.components, 1U);
  EXPECT_EQ(f.open_edges, 0U);
  EXPECT_EQ(f.turned, (m.triangles.size() + 2) / 3);
  for (const SurfacePoint& p : sample_surface(m, {}))
    EXPECT_GT(p.normal.dot(p.position - Vector3(0, 0, 0.05)), 0);
}

TEST(Surface, what_is_wrong_with_a_mesh_is_mended_and_said) {
  TriangleMesh m = cylinder(0.04, 0.1, 24, 4);
  const std::size_t triangles = m.triangles.size(), vertices = m.vertices.size();
  m.vertices.push_back(m.vertices[5]);    // twice
  m.vertices.emplace_back(9, 9, 9);       // unused
  m.triangles.push_back(m.triangles[7]);  // twice
  m.triangles.push_back({3, 3, 8});       // without area
  const auto copy = static_cast<int>(vertices);
  for (auto& t : m.triangles) {
    for (int& v : t) {
      if (v == 5 && &t > &m.triangles[9]) v = copy;
    }
  }
  const MeshFindings f = mend(m);
  EXPECT_EQ(f.welded, 1U);
  EXPECT_EQ(f.dropped, 2U);
  EXPECT_EQ(f.open_edges, 0U);
  EXPECT_EQ(f.components, 1U);
  EXPECT_EQ(m.triangles.size(), triangles);
  EXPECT_EQ(m.vertices.size(), vertices);
  EXPECT_EQ(sentences(f).size(), 2U);
  EXPECT_TRUE(sentences(mend(m)).empty());
  m.triangles.pop_back();
  ASSERT_EQ(sentences(mend(m)).size(), 1U);
  EXPECT_NE(sentences(mend(m)).front().find("3 edges are borders of holes"), std::string::npos);
}

TEST(PointTree, finds_what_a_scan_finds) {
  std::mt19937_64 random(4);
  const auto uniform = [&] { return static_cast<double>(random() % 10000) / 10000; };
  std::vector<Vector3> points;
  for (int i = 0; i < 700; ++i) points.emplace_back(uniform(), uniform(), 0.2 * uniform());
  points.push_back(points.front());
  const PointTree tree(points);
  for (int i = 0; i < 300; ++i) {
    const Vector3 c(uniform(), uniform(), uniform());
    const double r = 0.4 * uniform();
    std::vector<std::uint32_t> found, expected;
    tree.inside_ball(c, r, found);
    for (std::uint32_t k = 0; k < points.size(); ++k) {
      if ((points[k] - c).squaredNorm() <= r * r) expected.push_back(k);
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  }
}

TEST(TriangleTree, nearest_is_what_a_scan_of_dense_samples_finds) {
  const TriangleMesh mesh = cylinder(0.04, 0.1, 30, 3);
  const TriangleTree tree(mesh);
  SurfaceSettings dense;
  dense.step = 0.001;
  dense.max_points = 100000;
  const auto samples = sample_surface(mesh, dense);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> at(-0.08, 0.15);
  for (int i = 0; i < 200; ++i) {
    const Vector3 p(at(random), at(random), at(random));
    const SurfaceHit hit = tree.nearest(p);
    const auto& t = mesh.triangles[hit.triangle];
    Vector3 on = Vector3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      on += hit.barycentric[static_cast<Eigen::Index>(k)] *
            mesh.vertices[static_cast<std::size_t>(t[k])];
    EXPECT_LT((on - hit.position).norm(), 1e-12);
    EXPECT_GE(hit.barycentric.minCoeff(), -1e-12);
    EXPECT_NEAR((p - hit.position).norm(), hit.along, 1e-12);
    double best = 1;
    for (const SurfacePoint& s : samples) best = std::min(best, (s.position - p).norm());
    EXPECT_LE(hit.along, best + 1e-12);
    EXPECT_GT(hit.along, best - 0.001);
  }
}

TEST(TriangleTree, distance_to_a_cylinder_and_inside) {
  const TriangleTree tree(cylinder(0.04, 0.1, 400, 5));
  EXPECT_NEAR(tree.distance({0.1, 0, 0.02}, {0.1, 0, 0.3}, 1), 0.06, 1e-5);
  EXPECT_NEAR(tree.distance({0, 0, 0.2}, {0, 0.3, 0.2}, 1), 0.1, 1e-9);
  EXPECT_EQ(tree.distance({0, 0, 0.2}, {0, 0.3, 0.2}, 0.05), 0.05);
  EXPECT_TRUE(tree.nearer_than({0.1, 0, 0.05}, {0.2, 0, 0.05}, 0.0601));
  EXPECT_FALSE(tree.nearer_than({0.1, 0, 0.05}, {0.2, 0, 0.05}, 0.0599));
  EXPECT_EQ(tree.distance({-0.1, 0, 0.05}, {0.1, 0, 0.05}, 1), 0);
  EXPECT_TRUE(tree.contains({0.01, 0.02, 0.05}));
  EXPECT_FALSE(tree.contains({0.035, 0.035, 0.05}));
  EXPECT_FALSE(tree.contains({0, 0, 0.11}));
}

}  // namespace
}  // namespace handsel::grasp_planner::grasp_test
