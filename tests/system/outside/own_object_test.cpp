// SPDX-License-Identifier: Apache-2.0
// A user's object outside the tree, from a mesh in millimetres written by this test: described,
// grasped and given.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::own_object_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

/// Facets of an STL text.
class Stl {
 public:
  void facet(const std::array<std::array<double, 3>, 3>& corners) {
    text_ += "facet normal 0 0 0\nouter loop\n";
    for (const auto& c : corners)
      text_ += "vertex " + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " +
               std::to_string(c[2]) + "\n";
    text_ += "endloop\nendfacet\n";
  }
  std::string text() const { return "solid own\n" + text_ + "endsolid own\n"; }

 private:
  std::string text_;
};

/// A prism with `sides` sides, standing on the plane z = 0, the top cut at a slant of a few
/// millimetres: no shape of the project. Lengths in millimetres. Without its top when open.
std::string prism(int sides, double radius, double height, bool open = false) {
  Stl stl;
  const auto at = [&](int k, bool top) -> std::array<double, 3> {
    const double a = 2 * std::numbers::pi * k / sides, x = radius * std::cos(a);
    return {x, radius * std::sin(a), top ? height + 0.05 * x : 0};
  };
  for (int k = 0; k < sides; ++k) {
    stl.facet({at(k, false), at(k + 1, false), at(k + 1, true)});
    stl.facet({at(k, false), at(k + 1, true), at(k, true)});
    stl.facet({std::array<double, 3>{0, 0, 0}, at(k + 1, false), at(k, false)});
    if (!open) stl.facet({std::array<double, 3>{0, 0, height}, at(k, true), at(k + 1, true)});
  }
  return stl.text();
}

/// Returns a scenario like give_mug with an object of model `model`.
std::string scenario_of(const std::string& model) {
  return "name: \"mine\"\nrobot: \"jido\"\n"
         "boxes { id: \"table\" pose { xyz { x: 0.85 y: -0.62 z: 0.36 } }\n"
         "  size { x: 0.7 y: 0.7 z: 0.72 } supports: true }\n"
         "objects { id: \"thing\" model: \"" +
         model +
         "\" on: \"table\" pose { xyz { x: 0.68 y: -0.42 } } }\n"
         "people { id: \"anna\" x: 1.40 y: -0.05 yaw: 3.1416 stature: 1.72 behaviour: TAKER }\n"
         "human_sensors { source: \"kinect\" rate: 30 latency: 0.04 noise: 0.004 }\n"
         "object_sensors { source: \"object_tracker\" rate: 30 latency: 0.04 noise: 0.001 }\n"
         "tasks { kind: \"give\" object: \"thing\" human: \"anna\" }\ntimeout: 90\n";
}

class OwnObject : public testing::Test {
 protected:
  test::Outcome handsel(const std::string& arguments) const {
    return test::shell("cd " + folder.path().string() + " && " + HANDSEL_COMMAND + " " + arguments);
  }
  std::string refusal(const std::string& arguments, int exit_code = 2) const {
    const test::Outcome outcome = handsel("object new " + arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.out << outcome.err;
    return outcome.err;
  }
  test::TemporaryFolder folder;
};

TEST_F(OwnObject, from_a_mesh_in_millimetres_is_grasped_and_given) {
  folder.write("jar.stl", prism(10, 30, 115));
  const test::Outcome made = handsel("object new jar.stl --mass 0.25 --hand sah");
  ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
  EXPECT_THAT(made.err, HasSubstr("taken as millimetres"));
  EXPECT_THAT(made.out, HasSubstr("jar: 0.06"));
  EXPECT_THAT(made.out, HasSubstr("mass 0.25 kg"));
  EXPECT_THAT(made.out, HasSubstr("with z up it tips at"));
  ASSERT_TRUE(std::filesystem::exists(folder.path() / "jar.txtpb"));
  EXPECT_EQ(handsel("grasp placements --object jar").exit_code, 0);

  folder.write("my.scenario", scenario_of("jar"));
  const test::Outcome given = handsel("eval --scenario my.scenario --trials 1 --jobs 1");
  ASSERT_EQ(given.exit_code, 0) << given.err;
  const Json line = Json::parse(given.out);
  EXPECT_TRUE(line["success"].get<bool>()) << given.out;
  EXPECT_EQ(line["ssm_violations"], 0);
}

TEST_F(OwnObject, is_given_by_the_running_processes) {
  folder.write("jar.stl", prism(10, 30, 115));
  ASSERT_EQ(handsel("object new jar.stl --mass 0.25").exit_code, 0);
  folder.write("my.scenario", scenario_of("jar"));
  const test::Outcome run =
      test::shell("cd / && " + std::string(HANDSEL_COMMAND) +
                  " run --headless --port 0 --domain 217 --json --path " + folder.path().string() +
                  " --scenario my.scenario --set spark.grip_force=2.5");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("1 value differs from the shipped settings, as spark.grip_force"));
  EXPECT_THAT(run.err, HasSubstr("thing carried by human"));
  EXPECT_TRUE(Json::parse(run.out)["success"].get<bool>()) << run.out;
}

TEST_F(OwnObject, found_by_its_folder_from_anywhere) {
  folder.write("jar.stl", prism(10, 30, 115));
  ASSERT_EQ(handsel("object new jar.stl").exit_code, 0);
  const std::string placements = std::string(HANDSEL_COMMAND) + " grasp placements --object jar";
  EXPECT_EQ(test::shell("cd / && " + placements + " --path " + folder.path().string()).exit_code,
            0);
  EXPECT_EQ(
      test::shell("cd / && HANDSEL_PATH=" + folder.path().string() + " " + placements).exit_code,
      0);
  const test::Outcome unknown = test::shell("cd / && " + placements + "s");
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_THAT(unknown.err, HasSubstr("no object \"jars\"; there is: "));
  EXPECT_THAT(unknown.err, HasSubstr("searched in /, "));
}

TEST_F(OwnObject, that_is_a_container_is_seen_as_one) {
  // An outer and an inner wall, joined at the rim: millimetres, y up.
  Stl stl;
  const auto at = [](double r, double y, int k) -> std::array<double, 3> {
    const double a = 2 * std::numbers::pi * k / 24;
    return {r * std::cos(a), y, -r * std::sin(a)};
  };
  const std::vector<std::pair<double, double>> rows{{0, 0},   {35, 0}, {35, 90},
                                                    {30, 90}, {30, 5}, {0, 5}};
  for (std::size_t i = 0; i + 1 < rows.size(); ++i)
    for (int k = 0; k < 24; ++k) {
      const auto [r, y] = rows[i];
      const auto [r2, y2] = rows[i + 1];
      if (r > 0) stl.facet({at(r, y, k), at(r, y, k + 1), at(r2, y2, k)});
      if (r2 > 0) stl.facet({at(r, y, k + 1), at(r2, y2, k + 1), at(r2, y2, k)});
    }
  folder.write("beaker.stl", stl.text());
  const test::Outcome made = handsel("object new beaker.stl --full");
  ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
  EXPECT_THAT(made.err, HasSubstr("turned so that y of the file is up: it is a container"));
  EXPECT_THAT(made.out, HasSubstr("a container of 0.2"));
  std::ifstream in(folder.path() / "beaker.txtpb");
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  EXPECT_THAT(text, HasSubstr("walls {"));
  EXPECT_THAT(text, HasSubstr("max_tilt: 0.35"));
}

TEST_F(OwnObject, that_cannot_be_is_refused_in_one_sentence) {
  folder.write("open.stl", prism(10, 30, 115, true));
  const test::Outcome open = handsel("object new open.stl --mass 0.2");
  EXPECT_EQ(open.exit_code, 0) << open.err;
  EXPECT_THAT(open.err, HasSubstr("the surface is open: mass and inertia are those of cells"));
  EXPECT_THAT(refusal("open.stl"), HasSubstr("open.txtpb is there already; --replace"));
  EXPECT_EQ(handsel("object new open.stl --replace").exit_code, 0);

  EXPECT_THAT(refusal("nothing.stl", 3), HasSubstr("mesh nothing.stl does not exist"));
  folder.write("empty.stl", "solid nothing\nendsolid nothing\n");
  EXPECT_THAT(refusal("empty.stl"), HasSubstr("empty.stl"));
  folder.write("flat.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0.1 0.1 0\nf 1 2 3\nf 2 4 3\n");
  EXPECT_THAT(refusal("flat.obj"), HasSubstr("flat.obj: the mesh is flat"));
  folder.write("vague.stl", prism(10, 2, 9));
  EXPECT_THAT(refusal("vague.stl"), HasSubstr("give --unit"));
  EXPECT_EQ(handsel("object new vague.stl --unit cm").exit_code, 0);
  folder.write("huge.stl", prism(10, 30, 115));
  EXPECT_THAT(refusal("huge.stl --unit m"), HasSubstr("m; what a hand lifts has 0.005 to 1.5 m"));
  EXPECT_THAT(refusal("huge.stl --full"), HasSubstr("this object holds nothing with z up"));
  std::string many(80, ' ');
  const std::uint32_t count = 600'000;
  many.append(reinterpret_cast<const char*>(&count), 4);
  many.append(50ULL * count, '\0');
  folder.write("many.stl", many);
  EXPECT_THAT(refusal("many.stl"), HasSubstr("500000 triangles"));
}

}  // namespace
}  // namespace handsel::own_object_test
