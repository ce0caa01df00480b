#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "common/base/errors.hpp"
#include "common/geometry/segments.hpp"
#include "common/geometry/shape.hpp"
#include "tests/support/temporary_folder.hpp"

namespace handsel {
namespace {

using test::message_of;
using test::TemporaryFolder;

using ::testing::HasSubstr;

const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

double volume(const TriangleMesh& mesh) {
  double v = 0;
  for (const auto& t : mesh.triangles) v += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) / 6;
  return v;
}

TEST(Mesh, ReadsVerticesAndTrianglesInMetres) {
  const TemporaryFolder folder;
  const auto mesh = load_mesh(folder.write("t.obj", kTetrahedron));
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_NEAR(volume(mesh), 1.0 / 6, 1e-9);
}

TEST(Mesh, ScalesAndKeepsOutsideOutside) {
  const TemporaryFolder folder;
  const auto file = folder.write("t.obj", kTetrahedron);
  EXPECT_NEAR(volume(load_mesh(file, Vector3(0.1, 0.1, 0.1))), 1e-3 / 6, 1e-12);
  EXPECT_NEAR(volume(load_mesh(file, Vector3(1, 1, -1))), 1.0 / 6, 1e-9);
}

TEST(Mesh, WeldsEqualVerticesAndDropsTrianglesWithoutArea) {
  const TemporaryFolder folder;
  const auto mesh = load_mesh(folder.write("t.obj",
                                           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 0 0\n"
                                           "f 1 2 3\nf 4 6 5\nf 1 2 7\n"));
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[0][1], mesh.triangles[1][0]);
}

TEST(Mesh, SplitsPolygons) {
  const TemporaryFolder folder;
  EXPECT_EQ(load_mesh(folder.write("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")).triangles.size(), 2u);
}

TEST(Mesh, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of<MissingError>([&] { load_mesh(folder.path() / "none.obj"); }), HasSubstr("none.obj"));
  EXPECT_THAT(message_of<ConfigError>([&] { load_mesh(folder.write("bad.stl", "not a mesh at all")); }), HasSubstr("bad.stl"));
  EXPECT_THAT(message_of<ConfigError>([&] { load_mesh(folder.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")); }),
              HasSubstr("no triangle with an area"));
  EXPECT_THAT(message_of<ConfigError>([&] { load_mesh(folder.write("t.obj", kTetrahedron), Vector3(1, 0, 1)); }), HasSubstr("scale"));
}

TEST(Mesh, OddInputIsNamedAndOpenOnesAreRead) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) { return message_of<ConfigError>([&] { load_mesh(folder.write("odd.obj", text)); }); };
  EXPECT_THAT(refusal(""), HasSubstr("odd.obj"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1 0 0\n"), HasSubstr("not a mesh that can be read"));
  EXPECT_THAT(refusal("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("not finite"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), HasSubstr("out of range"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1200 0 0\nv 0 800 0\nf 1 2 3\n"), HasSubstr("1.2e+03 m large"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1e-6 0 0\nv 0 1e-6 0\nf 1 2 3\n"), HasSubstr("give it a scale"));
  const auto millimetres = folder.write("mm.obj", "v 0 0 0\nv 1200 0 0\nv 0 800 0\nf 1 2 3\n");
  EXPECT_EQ(load_mesh(millimetres, Vector3::Constant(0.001)).triangles.size(), 1u) << "open, and in millimetres";
}

TEST(Mesh, RefusesMoreThanTheCap) {
  const TemporaryFolder folder;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 500'001; ++i) text += "f 1 2 3\n";
  EXPECT_THAT(message_of<ConfigError>([&] { load_mesh(folder.write("big.obj", text)); }), HasSubstr("500000 triangles"));
}

TEST(Segments, NearestPointsMatchAFineSearch) {
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
      const double t = d.squaredNorm() > 0 ? std::clamp((p - b0).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
      best = std::min(best, (p - b0 - t * d).norm());
    }
    EXPECT_LE(found, best + 1e-12) << "trial " << trial;
    EXPECT_GE(found, best - 0.02) << "trial " << trial;
  }
}

}  // namespace
}  // namespace handsel
