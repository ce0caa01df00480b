// SPDX-License-Identifier: Apache-2.0
// Refused descriptions, with file, line and reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "common/config/resources.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/object_model.hpp"
#include "common/model/robot_model.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/reference_data.hpp"

namespace handsel::model_input_test {
namespace {

using test::message_of;
using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string urdf(const std::string& inside) {
  return "<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"one\"><inertial><mass "
         "value=\"1\"/>"
         "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
         "izz=\"1\"/></inertial></link>\n"
         "<joint name=\"j\" type=\"revolute\"><parent link=\"base\"/><child link=\"one\"/><axis "
         "xyz=\"0 0 1\"/>"
         "<limit lower=\"-1\" upper=\"1\" velocity=\"2\" effort=\"3\"/></joint>\n" +
         inside + "</robot>\n";
}

std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& rest = "") {
  return "<joint name=\"" + name + "\" type=\"revolute\"><parent link=\"" + parent +
         "\"/><child link=\"" + child +
         "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" velocity=\"2\" effort=\"3\"/>" +
         rest + "</joint>\n";
}

std::string urdf_refusal(const std::string& text) {
  const TemporaryFolder folder;
  return message_of<ConfigError>([&] { RobotModel::load_urdf(folder.write("r.urdf", text)); });
}

TEST(BadUrdf, missing_file) {
  EXPECT_THAT(message_of<MissingError>([] { RobotModel::load_urdf("/nowhere/r.urdf"); }),
              HasSubstr("/nowhere/r.urdf"));
}

TEST(BadUrdf, not_xml) {
  EXPECT_THAT(urdf_refusal("<robot name=\"r\">\n<link name=\"a\"\n</robot>"),
              AllOf(HasSubstr("r.urdf:"), HasSubstr("XML")));
  EXPECT_THAT(urdf_refusal("<house/>"), HasSubstr("no <robot>"));
  EXPECT_THAT(urdf_refusal("<robot name=\"r\"/>"), HasSubstr("no link"));
}

TEST(BadUrdf, with_a_cycle_is_refused) {
  EXPECT_THAT(urdf_refusal("<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>" +
                           joint("x", "a", "b") + joint("y", "b", "a") + "</robot>"),
              HasSubstr("cycle"));
  EXPECT_THAT(urdf_refusal(urdf("<link name=\"a\"/><link name=\"b\"/>\n" + joint("x", "a", "b") +
                                joint("y", "b", "a"))),
              AllOf(HasSubstr("r.urdf:"), HasSubstr("cycle")));
  EXPECT_THAT(urdf_refusal(urdf(joint("again", "base", "one"))),
              AllOf(HasSubstr("r.urdf:5"), HasSubstr("more than one parent")));
}

TEST(BadUrdf, with_duplicates_is_refused) {
  EXPECT_THAT(urdf_refusal(urdf("<link name=\"one\"/>\n")),
              AllOf(HasSubstr("r.urdf:5"), HasSubstr("link one is defined twice")));
}

TEST(BadUrdf, capsules_are_not_urdf) {
  EXPECT_THAT(urdf_refusal("<robot name=\"r\">\n<link name=\"a\"><collision><geometry>\n<capsule "
                           "radius=\"1\" length=\"1\"/></geometry></collision>"
                           "</link></robot>"),
              AllOf(HasSubstr("r.urdf:3"), HasSubstr("link a has a <capsule>")));
}

TEST(BadUrdf, missing_mesh_names_the_line) {
  const TemporaryFolder folder;
  const auto file = folder.write("r.urdf", urdf("<link name=\"m\"><collision><geometry><mesh "
                                                "filename=\"package://p/none.stl\"/></geometry>"
                                                "</collision></link>\n" +
                                                joint("k", "one", "m")));
  EXPECT_THAT(message_of<MissingError>([&] { RobotModel::load_urdf(file); }),
              AllOf(HasSubstr("r.urdf:5"), HasSubstr("none.stl")));
  EXPECT_EQ(RobotModel::load_urdf(file, {}, Meshes::skip).dof(), 2);
}

TEST(BadUrdf, with_bad_values_is_refused) {
  EXPECT_THAT(urdf_refusal("<robot name=\"r\"><link name=\"a\"><inertial><mass "
                           "value=\"-1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" "
                           "iyz=\"0\" izz=\"1\"/></inertial></link><link name=\"b\"/>" +
                           joint("x", "a", "b") + "</robot>"),
              HasSubstr("mass below 0"));
  EXPECT_THAT(urdf_refusal(urdf("<link name=\"a\"><collision><geometry><sphere "
                                "radius=\"0\"/></geometry></collision></link>" +
                                joint("x", "one", "a"))),
              HasSubstr("not > 0"));
  EXPECT_THAT(
      urdf_refusal(urdf("<link name=\"a\"/>" + joint("x", "one", "a", "<mimic joint=\"ghost\"/>"))),
      HasSubstr("ghost"));
  EXPECT_THAT(urdf_refusal(urdf("<link name=\"a\"/><link name=\"b\"/>" +
                                joint("x", "one", "a", "<mimic joint=\"y\"/>") +
                                joint("y", "a", "b", "<mimic joint=\"x\"/>"))),
              HasSubstr("circle"));
}

TEST(BadUrdf, with_bad_limits_is_refused) {
  const auto with_limit = [](const std::string& limit) {
    return urdf(
        "<link name=\"a\"/><joint name=\"x\" type=\"revolute\"><parent link=\"one\"/><child "
        "link=\"a\"/><axis xyz=\"0 0 1\"/>" +
        limit + "</joint>");
  };
  EXPECT_THAT(urdf_refusal(with_limit("")),
              AllOf(HasSubstr("x"), HasSubstr("does not specify limits")));
  EXPECT_THAT(
      urdf_refusal(with_limit("<limit lower=\"1\" upper=\"-1\" velocity=\"1\" effort=\"1\"/>")),
      HasSubstr("above its upper limit"));
  EXPECT_THAT(
      urdf_refusal(with_limit("<limit lower=\"nan\" upper=\"1\" velocity=\"1\" effort=\"1\"/>")),
      HasSubstr("nan"));
}

TEST(BadUrdf, numbers_that_are_not_finite_name_their_line_and_attribute) {
  const std::string good = urdf("");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return urdf_refusal(text);
  };
  EXPECT_THAT(with("<mass value=\"1\"/>", "<mass value=\"inf\"/>"),
              HasSubstr("r.urdf:3: value of <mass> is \"inf\", must be a finite number"));
  EXPECT_THAT(with("ixx=\"1\"", "ixx=\"nan\""), HasSubstr("r.urdf:3: ixx of <inertia> is \"nan\""));
  EXPECT_THAT(with("xyz=\"0 0 1\"", "xyz=\"0 0 1e400\""),
              HasSubstr("r.urdf:4: xyz of <axis> is \"1e400\""));
  EXPECT_THAT(with("velocity=\"2\"", "velocity=\"-inf\""),
              HasSubstr("r.urdf:4: velocity of <limit> is \"-inf\""));
  EXPECT_THAT(with("lower=\"-1\"", "lower=\"one\""),
              HasSubstr("r.urdf:4: lower of <limit> is \"one\""));
  EXPECT_THAT(
      urdf_refusal(urdf("<link name=\"a\"><collision><origin xyz=\"0 nan 0\"/><geometry><sphere "
                        "radius=\"1\"/></geometry></collision></link>" +
                        joint("x", "one", "a"))),
      HasSubstr("xyz of <origin> is \"nan\""));
}

TEST(BadUrdf, more_links_or_depth_than_a_robot_can_have_are_refused) {
  std::string chain;
  for (int i = 0; i < 1200; ++i)
    chain += "<link name=\"l" + std::to_string(i) + "\"/>" +
             joint("k" + std::to_string(i), i == 0 ? "one" : "l" + std::to_string(i - 1),
                   "l" + std::to_string(i));
  EXPECT_THAT(urdf_refusal(urdf(chain)), HasSubstr("has 1202 links, must have at most 1000"));
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "<a>";
  EXPECT_THAT(urdf_refusal("<robot name=\"r\">" + deep), HasSubstr("nested too deep"));
  EXPECT_THAT(urdf_refusal(urdf("<link name=\"m\"><collision><geometry><mesh filename=\"" +
                                std::string(5000, 'm') + ".stl\"/></geometry></collision></link>" +
                                joint("k", "one", "m"))),
              HasSubstr("the name of a mesh has 5004 bytes"));
}

TEST(BadSrdf, groups_that_contain_themselves_are_refused) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& groups) {
    return message_of<ConfigError>([&] {
      RobotModel::load_urdf(folder.write("r.urdf", urdf("")),
                            folder.write("r.srdf", "<robot name=\"r\">\n" + groups + "</robot>\n"));
    });
  };
  EXPECT_THAT(refusal("<group name=\"a\"><group name=\"a\"/></group>\n"),
              HasSubstr("r.srdf:2: group \"a\" contains itself"));
  std::string many;
  for (int i = 0; i < 60; ++i) many += "<group name=\"a\"/>";
  EXPECT_THAT(refusal("<group name=\"a\">" + many + "</group>\n"), HasSubstr("contains itself"));
  EXPECT_THAT(refusal("<group name=\"a\"><group name=\"b\"/></group>\n<group name=\"b\"><group "
                      "name=\"a\"/></group>\n"),
              HasSubstr("r.srdf:3: group \"a\" contains itself"));
  // Each group names the next one many times: 20^20 visits unless each group is visited once.
  std::string ladder;
  for (int i = 0; i < 20; ++i) {
    ladder += "<group name=\"g" + std::to_string(i) + "\">";
    for (int k = 0; k < 20; ++k) ladder += "<group name=\"g" + std::to_string(i + 1) + "\"/>";
    ladder += "</group>\n";
  }
  EXPECT_EQ(refusal(ladder + "<group name=\"g20\"><joint name=\"j\"/></group>\n"), "no error");
  std::string rows;
  for (int i = 0; i < 600; ++i) rows += "<group name=\"r" + std::to_string(i) + "\"/>\n";
  EXPECT_THAT(refusal(rows), HasSubstr("has 600 groups"));
}

TEST(Urdf, meshes_are_found_in_packages_above_the_urdf) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "urdf");
  folder.write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto file = folder.write(
      "urdf/r.urdf",
      urdf("<link name=\"m\"><collision><geometry><mesh filename=\"package://any/tri.obj\" "
           "scale=\"2 2 2\"/></geometry></collision></link>" +
           joint("k", "one", "m")));
  const auto robot = RobotModel::load_urdf(file);
  const auto& shape = robot.links()[robot.link_index("m")].collision.at(0).shape;
  EXPECT_EQ(std::get<MeshPtr>(shape)->vertices.size(), 3u);
}

TEST(Urdf, mimics_of_mimics_are_composed) {
  const TemporaryFolder folder;
  const auto robot = RobotModel::load_urdf(folder.write(
      "r.urdf",
      urdf("<link name=\"a\"/><link name=\"b\"/>" +
           joint("x", "one", "a", "<mimic joint=\"j\" multiplier=\"2\" offset=\"0.1\"/>") +
           joint("y", "a", "b", "<mimic joint=\"x\" multiplier=\"-1\" offset=\"0.2\"/>"))));
  ASSERT_EQ(robot.dof(), 1);
  Vector q = Vector::Constant(1, 0.3);
  const Pose T = robot.link_pose(q, robot.link_index("b"));
  const double x = 2 * 0.3 + 0.1, y = -x + 0.2;
  EXPECT_NEAR(std::atan2(T(1, 0), T(0, 0)), 0.3 + x + y, 1e-12);
}

std::string description(const std::string& more = "", const std::string& arm = "\"j\"",
                        const std::string& limits = "") {
  const std::string all = limits.empty()
                              ? "comfort { joints: \"j\" velocity: 1 acceleration: 2 jerk: 6 }\n"
                                "guard { joints: \"j\" velocity: 2 acceleration: 4 jerk: 12 }\n"
                                "stop { joints: \"j\" velocity: 2 acceleration: 4 jerk: 12 }\n"
                              : limits;
  return "name: \"r\"\nurdf: \"r.urdf\"\ngroups { name: \"arm\" joints: [" + arm +
         "] tip_link: \"one\" }\n" + all + more;
}

std::string robot_refusal(const std::string& text, const std::string& model = urdf("")) {
  const TemporaryFolder folder;
  folder.write("r.urdf", model);
  return message_of<ConfigError>([&] { RobotModel::load(folder.write("r.txtpb", text)); });
}

TEST(RobotDescription, is_read_when_right) {
  EXPECT_EQ(robot_refusal(description("rest { key: \"j\" value: 0.5 }\n")), "no error");
}

TEST(RobotDescription, unknown_key_names_the_line) {
  EXPECT_THAT(robot_refusal(description("colour: 3\n")), HasSubstr("r.txtpb:7:"));
}

TEST(RobotDescription, unknown_names_name_the_line) {
  EXPECT_THAT(robot_refusal(description("", "\"k\"")),
              AllOf(HasSubstr("r.txtpb:3"), HasSubstr("no joint \"k\"")));
  EXPECT_THAT(robot_refusal(description("tool_link: \"palm\"\n")),
              AllOf(HasSubstr("r.txtpb:7"), HasSubstr("tool_link")));
  EXPECT_THAT(robot_refusal(description("rest { key: \"k\" value: 0 }\n")),
              AllOf(HasSubstr("r.txtpb:7"), HasSubstr("rest")));
  EXPECT_THAT(robot_refusal(description("redundancy_joint: \"k\"\n")),
              HasSubstr("redundancy_joint"));
  EXPECT_THAT(robot_refusal(description("", "\"j\", \"j\"")), HasSubstr("twice"));
}

TEST(RobotDescription, rest_must_be_inside_the_limits) {
  EXPECT_THAT(robot_refusal(description("rest { key: \"j\" value: 1.5 }\n")), HasSubstr("outside"));
}

TEST(RobotDescription, limits_must_be_complete_and_ordered) {
  const auto limits = [](double comfort, double stop) {
    const auto entry = [](const char* kind, double v) {
      return std::string(kind) + " { joints: \"j\" velocity: " + std::to_string(v) +
             " acceleration: 4 jerk: 12 }\n";
    };
    return entry("comfort", comfort) + entry("guard", 2) + entry("stop", stop);
  };
  EXPECT_THAT(robot_refusal(description("", "\"j\"", limits(1, 2))), HasSubstr("acceleration"));
  EXPECT_THAT(robot_refusal(description("", "\"j\"", limits(1.9, 2))), HasSubstr("guard / 1.1"));
  EXPECT_THAT(robot_refusal(description("", "\"j\"", limits(0, 2))), HasSubstr("must be > 0"));
  EXPECT_THAT(robot_refusal(description(
                  "", "\"j\"", "comfort { joints: \"j\" velocity: 1 acceleration: 2 jerk: 6 }\n")),
              HasSubstr("guard has no entry for \"j\""));
}

TEST(RobotDescription, what_moves_needs_a_mass) {
  EXPECT_THAT(
      robot_refusal(description(), "<robot name=\"r\"><link name=\"base\"/>\n<link name=\"one\"/>" +
                                       joint("j", "base", "one") + "</robot>"),
      AllOf(HasSubstr("r.urdf:2"), HasSubstr("mass > 0")));
}

TEST(RobotDescription, missing_urdf_is_missing) {
  const TemporaryFolder folder;
  EXPECT_THAT(
      message_of<MissingError>([&] { RobotModel::load(folder.write("r.txtpb", description())); }),
      AllOf(HasSubstr("r.txtpb:2"), HasSubstr("r.urdf")));
}

TEST(RobotDescription, srdf_names_are_checked) {
  const TemporaryFolder folder;
  folder.write("r.urdf", urdf(""));
  folder.write("r.srdf",
               "<robot name=\"r\">\n<disable_collisions link1=\"base\" link2=\"ghost\"/></robot>");
  EXPECT_THAT(message_of<ConfigError>([&] {
                RobotModel::load(folder.write("r.txtpb", description("srdf: \"r.srdf\"\n")));
              }),
              AllOf(HasSubstr("r.srdf:2"), HasSubstr("ghost")));
}

TEST(HandDescription, says_what_is_wrong) {
  const TemporaryFolder folder;
  folder.write("r.urdf", urdf("<link name=\"two\"/>" + joint("k", "base", "two")));
  const auto refusal = [&](const std::string& text) {
    return message_of<ConfigError>([&] { HandModel::load(folder.write("h.txtpb", text)); });
  };
  const auto hand = [](const std::string& tip, const std::string& more) {
    return "name: \"h\"\nurdf: \"r.urdf\"\nfingers { name: \"thumb\" joints: \"j\" tip_link: \"" +
           tip +
           "\" pad { width: 0.02 height: 0.01 } }\nfingers { name: \"fore\" joints: \"k\" "
           "tip_link: \"two\" pad { width: 0.02 height: 0.01 "
           "} }\n" +
           more;
  };
  EXPECT_EQ(refusal(hand("one", "")), "no error");
  EXPECT_THAT(refusal(hand("three", "")), HasSubstr("tip_link"));
  EXPECT_THAT(refusal(hand("one", "pregrasp { key: \"x\" value: 0 }\n")),
              AllOf(HasSubstr("h.txtpb:5"), HasSubstr("pregrasp")));
  EXPECT_THAT(refusal(hand("one", "contact_margin: 2\n")), HasSubstr("h.txtpb:5"));
  EXPECT_THAT(refusal("name: \"h\"\nurdf: \"r.urdf\"\n"), HasSubstr("two fingers"));
  const std::string tips =
      "fingers { name: \"a\" joints: \"j\" tip_link: \"one\" tip_radius: 0.01 }\nfingers { name: "
      "\"b\" joints: \"k\" tip_link: \"two\" ";
  EXPECT_THAT(refusal("name: \"h\"\nurdf: \"r.urdf\"\n" + tips + "tip_radius: 0.01 }\n"),
              HasSubstr("each needs a pad"));
  EXPECT_THAT(
      refusal(hand("one",
                   "fingers { name: \"c\" joints: \"k\" tip_link: \"two\" tip_radius: 0.01 }\n")),
      HasSubstr("pads are for two"));
  EXPECT_THAT(refusal("name: \"h\"\nurdf: \"r.urdf\"\n" + tips + "pad { width: 0.01 } }\n"),
              HasSubstr("width and height"));
}

/// A flange and, in another folder, a gripper whose mesh is in a package.
class Mounted : public ::testing::Test {
 protected:
  Mounted() {
    folder_.write("r.urdf", urdf("<link name=\"old\"/><link name=\"older\"/>\n" +
                                 joint("o", "one", "old") + joint("p", "old", "older")));
    for (const char* sub : {"grip", "packages/far"})
      std::filesystem::create_directories(folder_.path() / sub);
    folder_.write("packages/far/tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder_.write("grip/g.urdf", urdf_named("palm", "nail"));
    folder_.write("grip/g.txtpb",
                  "name: \"g\"\nurdf: \"g.urdf\"\npackages: \"$HANDSEL_TEST_FOLDER/packages\"\n"
                  "fingers { name: \"a\" joints: \"n\" tip_link: \"nail\" pad { width: 0.01 "
                  "height: 0.01 } }\n"
                  "fingers { name: \"b\" joints: \"n\" tip_link: \"nail\" pad { width: 0.01 "
                  "height: 0.01 } }\n");
    setenv("HANDSEL_TEST_FOLDER", folder_.path().c_str(), 1);
  }
  static std::string urdf_named(const std::string& palm, const std::string& nail) {
    const std::string body =
        "<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
        "izz=\"1\"/></inertial>";
    return "<robot name=\"g\"><link name=\"" + palm + "\"/><link name=\"" + nail + "\">" + body +
           "<collision><geometry><mesh "
           "filename=\"package://far/tri.obj\"/></geometry></collision></link><link "
           "name=\"twin\">" +
           body + "</link>" + joint("n", palm, nail) +
           joint("t", palm, "twin", "<mimic joint=\"n\" multiplier=\"-2\"/>") + "</robot>";
  }
  RobotModel load(const std::string& without = "without: \"old\"\n",
                  const std::string& mount = "mount { link: \"one\" pose { xyz { z: 0.5 } } }\n",
                  const std::string& urdf = "$HANDSEL_TEST_FOLDER/r.urdf") {
    std::string limits;
    for (const char* kind : {"comfort", "guard", "stop"})
      limits +=
          std::string(kind) + " { joints: [\"j\", \"n\"] velocity: " +
          (kind[0] == 'c' ? "1 acceleration: 2 jerk: 6 }\n" : "2 acceleration: 4 jerk: 12 }\n");
    return RobotModel::load(folder_.write(
        "r.txtpb", "name: \"r\"\nurdf: \"" + urdf +
                       "\"\ngroups { name: \"arm\" joints: \"j\" tip_link: \"palm\" }\n" +
                       "groups { name: \"hand\" joints: \"n\" }\ntool_link: \"palm\"\nhand: "
                       "\"grip/g.txtpb\"\n" +
                       limits + without + mount));
  }
  TemporaryFolder folder_;
};

TEST_F(Mounted, hand_follows_the_flange) {
  const RobotModel robot = load();
  EXPECT_EQ(robot.dof(), 2);
  EXPECT_EQ(robot.link_index("old"), -1);
  EXPECT_EQ(robot.link_index("older"), -1);
  EXPECT_EQ(robot.hand(), (folder_.path() / "grip/g.txtpb").string());
  const Vector q = Eigen::Vector2d(0.3, 0.2);
  const Pose T_palm = robot.link_pose(q, robot.tool_link()),
             T_twin = robot.link_pose(q, robot.link_index("twin"));
  EXPECT_NEAR(T_palm.translation().z(), 0.5, 1e-12);
  EXPECT_NEAR(std::atan2(T_palm(1, 0), T_palm(0, 0)), 0.3, 1e-12);
  EXPECT_NEAR(std::atan2(T_twin(1, 0), T_twin(0, 0)), 0.3 - 0.4, 1e-12)
      << "a mimic joint follows its own hand's axis";
  EXPECT_EQ(robot.links()[static_cast<std::size_t>(robot.link_index("nail"))].collision.size(), 1U);
}

TEST_F(Mounted, says_what_is_wrong) {
  EXPECT_THAT(message_of<ConfigError>([&] { load("without: \"ghost\"\n"); }),
              HasSubstr("no link \"ghost\""));
  EXPECT_THAT(message_of<ConfigError>([&] { load("without: \"base\"\n"); }), HasSubstr("root"));
  EXPECT_THAT(message_of<ConfigError>([&] { load("", "mount { link: \"flange\" }\n"); }),
              HasSubstr("mount.link is \"flange\""));
  EXPECT_THAT(
      message_of<MissingError>([&] { load("", "", "$HANDSEL_NO_SUCH_FOLDER/r.urdf"); }),
      AllOf(HasSubstr("r.txtpb:2"), HasSubstr("HANDSEL_NO_SUCH_FOLDER"), HasSubstr("not set")));
  folder_.write("grip/g.urdf", urdf_named("palm", "one"));
  EXPECT_THAT(message_of<ConfigError>([&] { load(); }),
              AllOf(HasSubstr("link \"one\""), HasSubstr("g.urdf")));
}

TEST(ObjectDescription, says_what_is_wrong) {
  const TemporaryFolder folder;
  folder.write("o.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const auto load = [&](const std::string& text) {
    return ObjectModel::load(folder.write("o.txtpb", text));
  };
  const auto refusal = [&](const std::string& text) {
    return message_of<ConfigError>([&] { load(text); });
  };
  EXPECT_THAT(refusal("name: \"o\"\nmesh: \"o.obj\"\nmass: 0\n"),
              AllOf(HasSubstr("o.txtpb:3"), HasSubstr("mass must be > 0")));
  EXPECT_THAT(refusal("name: \"o\"\nmass: 1\n"), HasSubstr("mesh is missing"));
  EXPECT_THAT(refusal("name: \"o\"\nmesh: \"o.obj\"\nmass: 1\nparts { sphere: -1 }\n"),
              HasSubstr("o.txtpb:4"));
  EXPECT_THAT(refusal("name: \"o\"\nmesh: \"o.obj\"\nmass: 1\nparts { }\n"),
              HasSubstr("needs a shape"));
  EXPECT_THAT(refusal("name: \"o\"\nmesh: \"o.obj\"\nmass: 1\n"
                      "parts { sphere: 1 walls { sphere: 1 walls { sphere: 1 } } }\n"),
              HasSubstr("has no walls of its own"));
  EXPECT_THAT(message_of<MissingError>([&] { load("name: \"o\"\nmesh: \"p.obj\"\nmass: 1\n"); }),
              HasSubstr("p.obj"));
  const auto object =
      load("name: \"o\"\nmesh: \"o.obj\"\nmass: 1\nscale { x: 0.1 y: 0.1 z: 0.1 }\n");
  ASSERT_EQ(object.parts.size(), 1u);
  EXPECT_LT((std::get<Box>(object.parts[0].shape).size - Vector3::Constant(0.1)).norm(), 1e-9);
}

TEST(ObjectDescription, hollow_parts_are_their_walls) {
  const ObjectModel mug =
      ObjectModel::load(std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy/objects/mug/mug.txtpb");
  ASSERT_EQ(mug.parts.size(), 4U);
  EXPECT_TRUE(std::holds_alternative<Cylinder>(mug.parts[0].shape));
  ASSERT_FALSE(mug.parts[0].walls.empty());
  const std::vector<PlacedShape> solids = mug.solids();
  EXPECT_EQ(solids.size(), mug.parts[0].walls.size() + 3);
  std::size_t upright = 0;
  for (const PlacedShape& wall : mug.parts[0].walls) {
    const auto* box = std::get_if<Box>(&wall.shape);
    if (box == nullptr) continue;  // the bottom
    ++upright;
    // Every corner is in the wall of the mug, between inner and outer radius.
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        const Vector3 corner =
            wall.T_parent_shape * Vector3(x * box->size.x(), y * box->size.y(), 0);
        EXPECT_LT(corner.head<2>().norm(), 0.04 + 1e-5);
        EXPECT_GT(corner.head<2>().norm(), 0.036 - 1e-5);
      }
    }
  }
  EXPECT_EQ(upright, 16U);
}

TEST(ForeignRobots, an_arm_of_more_axes_than_can_be_solved_has_no_inverse) {
  const TemporaryFolder folder;
  std::string inside;
  std::string parent = "one";
  for (int i = 0; i < 30; ++i) {
    const std::string link = "l" + std::to_string(i);
    inside += "<link name=\"" + link + "\"/>\n" + joint("j" + std::to_string(i), parent, link);
    parent = link;
  }
  const std::string group =
      "<group name=\"arm\"><chain base_link=\"base\" tip_link=\"l29\"/></group>";
  const std::string srdf = "<robot name=\"r\">\n" + group + "</robot>\n";
  const auto robot =
      RobotModel::load_urdf(folder.write("r.urdf", urdf(inside)), folder.write("r.srdf", srdf));
  const Group& arm = robot.require_group("arm");
  ASSERT_EQ(arm.axes.size(), 31u);
  const Vector q = robot.rest_configuration();
  EXPECT_FALSE(robot.inverse(arm, robot.link_pose(q, arm.tip), q).has_value());
}

TEST(ForeignRobots, are_loaded_from_the_data_folder) {
  const auto robots = test::reference_data("robots");
  if (!robots) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const std::filesystem::path root = robots->parent_path();
  const auto panda = RobotModel::load_urdf(root / "robots/franka_panda/panda.urdf",
                                           root / "robots/franka_panda/panda.srdf");
  EXPECT_EQ(panda.group("panda_arm")->axes.size(), 7u);
  EXPECT_GE(panda.group("panda_arm")->tip, 0);
  EXPECT_EQ(RobotModel::load_urdf(root / "robots/kuka_iiwa14/model.urdf").dof(), 7);
  EXPECT_EQ(RobotModel::load_urdf(root / "robots/kuka_lwr4plus/urdf/lwr4plus_plain.urdf").dof(), 7);
  EXPECT_EQ(RobotModel::load_urdf(root / "robots/pr2/urdf/pr2.urdf").dof(), 20);
  EXPECT_THAT(message_of<ConfigError>([&] {
                RobotModel::load_urdf(root / "humans/bullet_humanoid/humanoid_capsules.urdf");
              }),
              HasSubstr("<capsule>"));
}

}  // namespace
}  // namespace handsel::model_input_test
