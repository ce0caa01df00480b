// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <random>

#include "common/base/errors.hpp"
#include "common/geometry/segments.hpp"
#include "common/geometry/shape.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::geometry_test {
namespace {

using test::message_of;
using test::TemporaryFolder;

using ::testing::HasSubstr;

const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

double volume(const TriangleMesh& mesh) {
  double v = 0;
  for (const auto& t : mesh.triangles)
    v += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) / 6;
  return v;
}

TEST(Mesh, reads_vertices_and_triangles_in_metres) {
  const TemporaryFolder folder;
  const auto mesh = load_mesh(folder.write("t.obj", kTetrahedron));
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_NEAR(volume(mesh), 1.0 / 6, 1e-9);
}

TEST(Mesh, scales_and_keeps_outside_outside) {
  const TemporaryFolder folder;
  const auto file = folder.write("t.obj", kTetrahedron);
  EXPECT_NEAR(volume(load_mesh(file, Vector3(0.1, 0.1, 0.1))), 1e-3 / 6, 1e-12);
  EXPECT_NEAR(volume(load_mesh(file, Vector3(1, 1, -1))), 1.0 / 6, 1e-9);
}

TEST(Mesh, welds_equal_vertices_and_drops_triangles_without_area) {
  const TemporaryFolder folder;
  const auto mesh =
      load_mesh(folder.write("t.obj",
                             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 0 0\n"
                             "f 1 2 3\nf 4 6 5\nf 1 2 7\n"));
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[0][1], mesh.triangles[1][0]);
}

TEST(Mesh, splits_polygons) {
  const TemporaryFolder folder;
  EXPECT_EQ(load_mesh(folder.write("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"))
                .triangles.size(),
            2u);
}

TEST(Mesh, says_what_is_wrong) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of<MissingError>([&] { load_mesh(folder.path() / "none.obj"); }),
              HasSubstr("none.obj"));
  EXPECT_THAT(
      message_of<ConfigError>([&] { load_mesh(folder.write("bad.stl", "not a mesh at all")); }),
      HasSubstr("bad.stl"));
  EXPECT_THAT(message_of<ConfigError>([&] {
                load_mesh(folder.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"));
              }),
              HasSubstr("no triangle with an area"));
  EXPECT_THAT(message_of<ConfigError>(
                  [&] { load_mesh(folder.write("t.obj", kTetrahedron), Vector3(1, 0, 1)); }),
              HasSubstr("scale"));
}

TEST(Mesh, odd_input_is_named_and_open_ones_are_read) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    return message_of<ConfigError>([&] { load_mesh(folder.write("odd.obj", text)); });
  };
  EXPECT_THAT(refusal(""), HasSubstr("odd.obj"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1 0 0\n"), HasSubstr("not a mesh that can be read"));
  EXPECT_THAT(refusal("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("not finite"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), HasSubstr("out of range"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1200 0 0\nv 0 800 0\nf 1 2 3\n"), HasSubstr("1.2e+03 m large"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1e-6 0 0\nv 0 1e-6 0\nf 1 2 3\n"), HasSubstr("give it a scale"));
  const auto millimetres = folder.write("mm.obj", "v 0 0 0\nv 1200 0 0\nv 0 800 0\nf 1 2 3\n");
  EXPECT_EQ(load_mesh(millimetres, Vector3::Constant(0.001)).triangles.size(), 1u)
      << "open, and in millimetres";
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += (mesh.vertices[t[1]] - mesh.vertices[t[0]])
               .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
               .norm() /
           2;
  return sum;
}

TEST(Mesh, polygons_with_reflex_corners_are_split_inside_their_outline) {
  const TemporaryFolder folder;
  const auto star = [](int corners, double inner, bool reversed) {
    std::string text, face = "f";
    for (int i = 0; i < corners; ++i) {
      const double r = i % 2 == 0 ? 1 : inner, angle = 2 * M_PI * i / corners;
      text += "v " + std::to_string(r * std::cos(angle)) + " 0.5 " +
              std::to_string(r * std::sin(angle)) + "\n";
      face += " " + std::to_string(reversed ? corners - i : i + 1);
    }
    return text + face + "\n";
  };
  for (const bool reversed : {false, true})
    for (const int corners : {6, 10, 40, 200}) {
      const TriangleMesh mesh = load_mesh(folder.write("star.obj", star(corners, 0.4, reversed)));
      EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(corners - 2));
      EXPECT_NEAR(area(mesh), corners * 0.5 * 0.4 * std::sin(2 * M_PI / corners), 1e-4) << corners;
      for (const auto& t : mesh.triangles) {
        const double up = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                              .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                              .y();
        EXPECT_GT(reversed ? up : -up, 0) << "each triangle faces as the polygon does";
      }
    }
  const TriangleMesh arrow =
      load_mesh(folder.write("arrow.obj", "v 0 0 0\nv 1 1 0\nv 0 2 0\nv 0.5 1 0\nf 1 2 3 4\n"));
  EXPECT_NEAR(area(arrow), 0.5, 1e-6);
}

TEST(Mesh, a_file_that_the_mesh_names_is_not_opened) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "pipe");
  const std::filesystem::path pipe = folder.path() / "pipe" / "m.mtl";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);  // opening the pipe for reading blocks
  const auto mesh = load_mesh(folder.write(
      "t.obj", "mtllib " + pipe.string() + "\n" + kTetrahedron + "usemtl red\nf 1 2 3\n"));
  EXPECT_EQ(mesh.triangles.size(), 5u);
}

TEST(Mesh, only_files_whose_format_is_checked_are_read) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of<ConfigError>([&] {
                load_mesh(folder.write("t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
              }),
              HasSubstr("its name must end in .obj, .stl, .ply or .dae"));
  EXPECT_THAT(message_of<ConfigError>([&] { load_mesh(folder.path()); }),
              HasSubstr("is not a file"));
}

TEST(Mesh, refuses_more_than_the_cap) {
  const TemporaryFolder folder;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 500'001; ++i) text += "f 1 2 3\n";
  EXPECT_THAT(message_of<ConfigError>([&] { load_mesh(folder.write("big.obj", text)); }),
              HasSubstr("500000 triangles"));
}

TEST(Segments, nearest_points_match_a_fine_search) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto point = [&] { return Vector3(u(engine), u(engine), u(engine)); };
  for (int trial = 0; trial < 300; ++trial) {
    const Vector3 a0 = point(), b0 = point();
    const Vector3 a1 = trial % 5 == 0 ? a0 : point();
    Vector3 b1 = trial % 7 == 0 ? b0 : point();
    if (trial % 3 == 0) b1 = b0 + 0.7 * (a1 - a0);
    Vector3 pa, pb;
    const double found = std::sqrt(nearest_points(a0, a1, b0, b1, pa, pb));
    EXPECT_NEAR((pa - pb).norm(), found, 1e-12);
    double best = 1e9;
    for (int i = 0; i <= 200; ++i) {
      const Vector3 p = a0 + i / 200.0 * (a1 - a0), d = b1 - b0;
      const double t =
          d.squaredNorm() > 0 ? std::clamp((p - b0).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
      best = std::min(best, (p - b0 - t * d).norm());
    }
    EXPECT_LE(found, best + 1e-12) << "trial " << trial;
    EXPECT_GE(found, best - 0.02) << "trial " << trial;
  }
}

}  // namespace
}  // namespace handsel::geometry_test
