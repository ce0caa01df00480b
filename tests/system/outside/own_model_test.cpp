// SPDX-License-Identifier: Apache-2.0
// A user's robot outside the tree, from a URDF written by this test: described, checked, and used
// to give in the simulator. Broken URDFs are refused in one sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/published_robots.hpp"

namespace handsel::own_model_test {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), with);
}

std::string replaced_everywhere(std::string text, const std::string& what,
                                const std::string& with) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
  return text;
}

/// Returns an STL of a box from -half to half.
std::string box_stl(double x, double y, double z) {
  std::string text = "solid box\n";
  const auto facet = [&](const std::array<std::array<double, 3>, 3>& corners) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const auto& c : corners)
      text += "vertex " + std::to_string(c[0] * x / 2) + " " + std::to_string(c[1] * y / 2) + " " +
              std::to_string(c[2] * z / 2) + "\n";
    text += "endloop\nendfacet\n";
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto at = [&](double u, double v) {
        std::array<double, 3> p{};
        p[static_cast<std::size_t>(axis)] = side;
        p[static_cast<std::size_t>((axis + 1) % 3)] = u * side;
        p[static_cast<std::size_t>((axis + 2) % 3)] = v;
        return p;
      };
      facet({at(-1, -1), at(1, -1), at(1, 1)});
      facet({at(-1, -1), at(1, 1), at(-1, 1)});
    }
  return text + "endsolid box\n";
}

class OwnModel : public testing::Test {
 protected:
  test::Outcome handsel(const std::string& arguments) const {
    return test::shell("cd " + folder.path().string() + " && " + HANDSEL_COMMAND + " " + arguments);
  }
  /// Returns the sentence with which `model new` refuses a URDF.
  std::string refusal(const std::string& urdf, int exit_code = 2) const {
    folder.write("bad.urdf", urdf);
    const test::Outcome outcome = handsel("model new bad.urdf --configurations 1000 --replace");
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.out << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "bad/bad.txtpb")) << outcome.err;
    return outcome.err;
  }
  std::string text_of(const std::string& file) const {
    std::ifstream in(folder.path() / file);
    return {(std::istreambuf_iterator<char>(in)), {}};
  }
  test::TemporaryFolder folder;
};

TEST_F(OwnModel, of_an_arm_with_its_gripper_gives_in_the_simulator) {
  folder.write("mine.urdf", test::urdf("mine", test::ur5e() + test::robotiq_2f85("tool0")));
  const test::Outcome made = handsel("model new mine.urdf");
  ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
  EXPECT_THAT(made.out, HasSubstr("mine: arm of 6 axes, hand of 1"));
  EXPECT_THAT(made.out, HasSubstr("never touch"));
  EXPECT_THAT(made.out, HasSubstr("only you can know"));
  const test::Outcome checked = handsel("model check mine");
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
  const std::string description = text_of("mine/mine.txtpb");
  EXPECT_THAT(description, HasSubstr("# velocity: URDF; acceleration: assumed; jerk: assumed"));
  EXPECT_THAT(description, HasSubstr("tool_link: \"robotiq_base\""));
  EXPECT_THAT(text_of("mine/mine_hand.txtpb"),
              AllOf(HasSubstr("left_inner_finger_pad"), HasSubstr("right_inner_finger_pad")));
  EXPECT_THAT(text_of("mine/mine.srdf"),
              AllOf(HasSubstr("reason=\"Never\""), HasSubstr("reason=\"Hand\"")));
  EXPECT_EQ(text_of("mine/mine.png").substr(1, 3), "PNG");

  const test::Outcome given = handsel("eval --scenario mine/mine_give.txtpb --trials 1 --jobs 1");
  ASSERT_EQ(given.exit_code, 0) << given.err;
  const Json line = Json::parse(given.out);
  EXPECT_TRUE(line["success"].get<bool>()) << given.out;
  EXPECT_EQ(line["ssm_violations"], 0);
}

TEST_F(OwnModel, of_a_bare_arm_carries_the_parallel_gripper) {
  folder.write("arm.urdf", test::urdf("arm", test::ur5e()));
  folder.write("joint_limits.yaml",
               "joint_limits:\n  elbow_joint:\n    has_velocity_limits: true\n"
               "    max_velocity: 1.5\n    has_acceleration_limits: true\n"
               "    max_acceleration: 4\n    has_jerk_limits: false\n    max_jerk: 1\n"
               "  ghost_joint:\n    max_velocity: 1\n");
  const test::Outcome made =
      handsel("model new arm.urdf --joint-limits joint_limits.yaml --configurations 2000");
  ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
  EXPECT_THAT(made.err, HasSubstr("names joint ghost_joint, which the URDF does not have"));
  const std::string description = text_of("arm/arm.txtpb");
  EXPECT_THAT(description, HasSubstr("mount { link: \"tool0\""));
  EXPECT_THAT(description,
              HasSubstr("# velocity: joint_limits.yaml; acceleration: joint_limits.yaml; jerk: "
                        "assumed\nguard { joints: \"elbow_joint\" velocity: 1.5 acceleration: 4 "
                        "jerk: 40 }"));
  EXPECT_EQ(handsel("model check arm").exit_code, 0);
}

TEST_F(OwnModel, takes_an_srdf_in_which_a_link_is_missing_and_one_is_unknown) {
  folder.write("arm.urdf", test::urdf("arm", test::ur5e()));
  folder.write("arm.srdf",
               "<robot name=\"arm\">\n"
               "<disable_collisions link1=\"base_link\" link2=\"shoulder_link\" "
               "reason=\"Adjacent\"/>\n"
               "<disable_collisions link1=\"forearm_link\" link2=\"wrist_3_link\" "
               "reason=\"Never\"/>\n"
               "<disable_collisions link1=\"forearm_link\" link2=\"old_camera\" "
               "reason=\"Never\"/>\n</robot>\n");
  const test::Outcome made = handsel("model new arm.urdf --srdf arm.srdf --configurations 2000");
  ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
  EXPECT_THAT(made.err, HasSubstr("the SRDF names link old_camera, which the robot does not have"));
  EXPECT_THAT(made.err, HasSubstr("the SRDF does not name link wrist_1_link: its pairs were"));
  EXPECT_THAT(text_of("arm/arm.srdf"),
              AllOf(HasSubstr("link1=\"forearm_link\" link2=\"wrist_3_link\""),
                    Not(HasSubstr("old_camera"))));
}

TEST_F(OwnModel, is_corrected_where_the_urdf_lacks_shapes_masses_and_metres) {
  folder.write("upper.stl", box_stl(425, 110, 110));
  std::string urdf = test::urdf("arm", test::ur5e());
  urdf = replaced(urdf, test::cylinder(0.055, 0.425),
                  "<mesh filename=\"package://my_arm/upper.stl\"/>");
  urdf = replaced(urdf, "rpy=\"0 1.57079633 0\"", "rpy=\"0 0 0\"");
  const auto drawn = urdf.find("<collision>", urdf.find("link name=\"forearm_link\""));
  urdf.replace(drawn, 11, "<visual>");
  urdf = urdf.substr(0, drawn) + replaced(urdf.substr(drawn), "</collision>", "</visual>");
  urdf = replaced(urdf, "<mass value=\"1.370000\"/>", "<mass value=\"0\"/>");
  urdf = replaced(urdf, "effort=\"28.000000\"", "effort=\"0\"");
  folder.write("arm.urdf", urdf);
  const test::Outcome made = handsel("model new arm.urdf --configurations 2000");
  ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
  EXPECT_THAT(made.err, HasSubstr("meshes in millimetres: upper.stl; scaled by 0.001"));
  EXPECT_THAT(made.err, HasSubstr("no collision shape in links forearm_link"));
  EXPECT_THAT(made.err, HasSubstr("no mass in links wrist_1_link"));
  EXPECT_THAT(made.err, HasSubstr("joint wrist_1_joint has no effort limit"));
  EXPECT_THAT(text_of("arm/arm.urdf"), HasSubstr("scale=\"0.001 0.001 0.001\""));
  EXPECT_EQ(handsel("model check arm").exit_code, 0);
}

TEST_F(OwnModel, that_cannot_be_is_refused_in_one_sentence) {
  const std::string good = test::urdf("bad", test::ur5e());
  EXPECT_THAT(refusal(replaced(good, "0 0 0.1625", "0 0 162.5")),
              HasSubstr("looks like millimetres; a URDF is in metres"));
  EXPECT_THAT(refusal(replaced(good, "lower=\"-3.141590\" upper=\"3.141590\"",
                               "lower=\"-180\" upper=\"180\"")),
              HasSubstr("joint elbow_joint has limits of -180 and 180 rad, which look like"));
  EXPECT_THAT(refusal(replaced_everywhere(good, "velocity=\"3.141590\"", "velocity=\"180\"")),
              HasSubstr("looks like degrees per second"));
  EXPECT_THAT(
      refusal(replaced(good, "lower=\"-3.141590\" upper=\"3.141590\"", "lower=\"0\" upper=\"0\"")),
      HasSubstr("joint elbow_joint has no range"));
  EXPECT_THAT(refusal(replaced(good, "0 0 0.1625", "0 0 ${height}")),
              HasSubstr("a command of xacro; expand the file with `xacro"));
  EXPECT_THAT(refusal(replaced(good, test::cylinder(0.055, 0.425),
                               "<mesh filename=\"package://my_arm/upper.stl\"/>"),
                      3),
              HasSubstr("mesh package://my_arm/upper.stl is neither"));
  EXPECT_THAT(refusal(replaced(good, "name=\"forearm_link\"", "name=\"shoulder_link\"")),
              HasSubstr("link shoulder_link is defined twice"));
  EXPECT_THAT(refusal(good.substr(0, good.size() / 2)), HasSubstr("not well-formed XML"));
  EXPECT_THAT(refusal(replaced(good, "<child link=\"shoulder_link\"", "<child link=\"base_link\"")),
              HasSubstr("bad.urdf"));
  EXPECT_THAT(refusal(replaced_everywhere(good, "\"revolute\"", "\"fixed\"")),
              HasSubstr("no axis"));
  EXPECT_THAT(refusal(replaced(replaced(good, "name=\"elbow_joint\" type=\"revolute\"",
                                        "name=\"elbow_joint\" type=\"fixed\""),
                               "name=\"wrist_1_joint\" type=\"revolute\"",
                               "name=\"wrist_1_joint\" type=\"fixed\"")),
              HasSubstr("no arm was found: the longest chain of turning joints has 4 axes"));
  const test::Outcome missing = handsel("model new nothing.urdf");
  EXPECT_EQ(missing.exit_code, 3) << missing.err;
  EXPECT_THAT(missing.err, HasSubstr("nothing.urdf"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "nothing")) << "a folder is left behind";
  folder.write("arm.urdf", good);
  EXPECT_EQ(handsel("model new arm.urdf --configurations 1000").exit_code, 0);
  EXPECT_THAT(handsel("model new arm.urdf").err,
              HasSubstr("arm.txtpb is there already; --replace"));
  EXPECT_THAT(handsel("model new arm.urdf --replace --tool tol0").err,
              HasSubstr("the URDF has no such link; it has tool0"));
}

TEST_F(OwnModel, of_a_xacro_is_expanded_by_the_program_of_the_user) {
  folder.write("arm.urdf.xacro", "not read by this test's program");
  const test::Outcome without = handsel("model new arm.urdf.xacro");
  if (without.exit_code == 3) {  // no xacro is installed here
    EXPECT_THAT(without.err, HasSubstr("xacro is not installed here; expand the file"));
  }
  folder.write("expanded", test::urdf("arm", test::ur5e()));
  const auto program = folder.write("xacro", "#!/bin/sh\ncat expanded\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const test::Outcome made =
      test::shell("cd " + folder.path().string() + " && PATH=.:$PATH " + HANDSEL_COMMAND +
                  " model new arm.urdf.xacro --configurations 1000");
  EXPECT_EQ(made.exit_code, 0) << made.out << made.err;
  EXPECT_THAT(made.out, HasSubstr("arm: arm of 6 axes"));
}

}  // namespace
}  // namespace handsel::own_model_test
