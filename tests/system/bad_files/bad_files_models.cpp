// SPDX-License-Identifier: Apache-2.0
// Bad meshes and bad descriptions of robots, hands and objects.
#include <algorithm>
#include <filesystem>

#include "tests/system/bad_files/bad_files.hpp"

namespace handsel::test {
namespace {

const std::string kMesh = "grasp placements --object {}";
const std::string kInfo = "model info {}";

const std::string kTriangle =
    "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// A robot of one axis; each part may be replaced.
const std::string kUrdf =
    "<robot name=\"r\">\n"
    "<link name=\"base\"/>\n"
    "<link name=\"one\"><inertial><origin xyz=\"0 0 0\"/><mass value=\"1\"/><inertia ixx=\"1\" "
    "ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
    "izz=\"1\"/></inertial><collision><geometry><sphere "
    "radius=\"0.1\"/></geometry></collision></link>\n"
    "<joint name=\"j\" type=\"revolute\"><parent link=\"base\"/><child link=\"one\"/><axis xyz=\"0 "
    "0 1\"/>"
    "<limit lower=\"-1\" upper=\"1\" velocity=\"2\" effort=\"3\"/></joint>\n"
    "</robot>\n";

std::string more_urdf(const std::string& inside) {
  return with(kUrdf, "</robot>", inside + "</robot>");
}

std::string joint(const std::string& name, const std::string& parent, const std::string& child) {
  return "<joint name=\"" + name + "\" type=\"fixed\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/></joint>\n";
}

void add_urdfs(BadFiles& table) {
  const auto urdf = [&](const std::string& name, const std::string& content,
                        const std::string& says) {
    table.push_back({"urdf/" + name + ".urdf", content, kInfo, says});
  };
  urdf("empty", "", "not well-formed XML");
  urdf("binary",
       std::string("\x7f"
                   "ELF\0\1\2",
                   8),
       "not well-formed XML");
  urdf("no_robot", "<house/>", "no <robot>");
  urdf("no_link", "<robot name=\"r\"/>", "no link");
  urdf("cut", kUrdf.substr(0, 200), "not well-formed XML");
  urdf("deep", "<robot name=\"r\">" + repeated("<a>", 20000), "nested too deep");
  urdf("cycle",
       "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>" + joint("x", "a", "b") +
           joint("y", "b", "a") + "</robot>",
       "cycle");
  urdf("cycle_apart",
       more_urdf("<link name=\"a\"/><link name=\"b\"/>" + joint("x", "a", "b") +
                 joint("y", "b", "a")),
       "cycle");
  urdf("own_parent", more_urdf("<link name=\"a\"/>" + joint("x", "a", "a")), "cycle");
  urdf("two_parents", more_urdf(joint("x", "base", "one")), "more than one parent");
  urdf("link_twice", more_urdf("<link name=\"one\"/>"), "link one is defined twice");
  urdf("joint_twice", more_urdf("<link name=\"a\"/>" + joint("j", "one", "a")),
       "joint j is defined twice");
  urdf("link_missing", more_urdf(joint("x", "one", "ghost")), "ghost");
  urdf("mass_nan", with(kUrdf, "mass value=\"1\"", "mass value=\"nan\""),
       "value of <mass> is \"nan\"");
  urdf("mass_negative", with(kUrdf, "mass value=\"1\"", "mass value=\"-1\""), "mass below 0");
  urdf("mass_overflow", with(kUrdf, "mass value=\"1\"", "mass value=\"1e400\""),
       "value of <mass> is \"1e400\"");
  urdf("inertia_infinite", with(kUrdf, "ixx=\"1\"", "ixx=\"inf\""), "ixx of <inertia> is \"inf\"");
  urdf("axis_zero", with(kUrdf, "axis xyz=\"0 0 1\"", "axis xyz=\"0 0 0\""), "axis of length 0");
  urdf("axis_nan", with(kUrdf, "axis xyz=\"0 0 1\"", "axis xyz=\"0 nan 1\""),
       "xyz of <axis> is \"nan\"");
  urdf("axis_word", with(kUrdf, "axis xyz=\"0 0 1\"", "axis xyz=\"up\""),
       "xyz of <axis> is \"up\"");
  urdf("origin_huge", with(kUrdf, "origin xyz=\"0 0 0\"", "origin xyz=\"0 1e300 0\""),
       "xyz of <origin> is \"1e300\"");
  urdf("limits_crossed", with(kUrdf, "lower=\"-1\"", "lower=\"5\""), "lower limit above its upper");
  urdf("limit_missing",
       with(kUrdf, "<limit lower=\"-1\" upper=\"1\" velocity=\"2\" effort=\"3\"/>", ""),
       "does not specify limits");
  urdf("radius_zero", with(kUrdf, "radius=\"0.1\"", "radius=\"0\""), "size is not > 0");
  urdf("radius_infinite", with(kUrdf, "radius=\"0.1\"", "radius=\"inf\""),
       "radius of <sphere> is \"inf\"");
  urdf("capsule", with(kUrdf, "<sphere radius=\"0.1\"/>", "<capsule radius=\"1\" length=\"1\"/>"),
       "<capsule>");
  urdf("mimic_circle", with(kUrdf, "</joint>", "<mimic joint=\"j\"/></joint>"), "mimics itself");
  urdf("mimic_ghost", with(kUrdf, "</joint>", "<mimic joint=\"ghost\"/></joint>"), "ghost");
  urdf("joint_type", with(kUrdf, "type=\"revolute\"", "type=\"rubber\""), "rubber");
  std::string chain;
  for (int i = 0; i < 5000; ++i)
    chain += "<link name=\"l" + std::to_string(i) + "\"/>" +
             joint("k" + std::to_string(i), i == 0 ? "one" : "l" + std::to_string(i - 1),
                   "l" + std::to_string(i));
  urdf("five_thousand_links", more_urdf(chain), "must have at most 1000");
  urdf("long_mesh_name",
       with(kUrdf, "<sphere radius=\"0.1\"/>",
            "<mesh filename=\"" + repeated("m", 5000) + ".stl\"/>"),
       "5004 bytes");
  urdf("five_megabytes", kUrdf + repeated(" ", 5 << 20), "may have 4 MB");
  table.push_back({"urdf/mesh_missing.urdf",
                   with(kUrdf, "<sphere radius=\"0.1\"/>", "<mesh filename=\"none.stl\"/>"), kInfo,
                   "none.stl", 3});
  table.push_back({"urdf/missing.urdf", "", kInfo, "missing.urdf", 3, "", BadFile::Kind::missing});
  table.push_back({"urdf/folder.urdf", "", kInfo, "is not a file", 2, "", BadFile::Kind::folder});
  table.push_back(
      {"urdf/unreadable.urdf", kUrdf, kInfo, "cannot be read", 2, "", BadFile::Kind::unreadable});
}

void add_srdfs(BadFiles& table) {
  const std::string plan = "plan --robot {source}/deploy/robots/duo/duo.urdf --srdf {}";
  const auto srdf = [&](const std::string& name, const std::string& content,
                        const std::string& says) {
    table.push_back({"srdf/" + name + ".srdf", content, plan, says});
  };
  srdf("empty", "", "not well-formed XML");
  srdf("no_robot", "<house/>", "no <robot>");
  srdf("cut", "<robot name=\"r\"><group name=\"a\">", "not well-formed XML");
  srdf("in_itself",
       "<robot name=\"r\">\n<group name=\"a\">" + repeated("<group name=\"a\"/>", 30) +
           "</group></robot>",
       "in_itself.srdf:2: group \"a\" contains itself");
  srdf("in_each_other",
       "<robot name=\"r\">\n<group name=\"a\"><group name=\"b\"/></group>\n<group "
       "name=\"b\"><group name=\"a\"/></group></robot>",
       "contains itself");
  srdf("deep", "<robot name=\"r\">" + repeated("<group name=\"a\">", 5000), "nested too deep");
  srdf("many_groups", "<robot name=\"r\">" + repeated("<group name=\"a\"/>", 100000) + "</robot>",
       "must have at most 500");
  table.push_back({"srdf/missing.srdf", "", plan, "missing.srdf", 3, "", BadFile::Kind::missing});
}

void add_robots(BadFiles& table) {
  const auto robot = [&](const std::string& name, const std::string& content,
                         const std::string& says, int exit_code = 2) {
    table.push_back({"robot/" + name + ".txtpb", content, kInfo, says, exit_code});
  };
  robot("empty", "", "urdf is missing");
  robot("binary", std::string("\0\1\2\377\376", 5), "binary.txtpb:1");
  robot("unknown_key", "name: \"r\"\nlegs: 4\n", "unknown_key.txtpb:2");
  robot("wrong_type", "name: 3\n", "wrong_type.txtpb:1");
  robot("cut", "name: \"r\"\ngroups {\n", "cut.txtpb:");
  robot("name_twice", "name: \"a\"\nname: \"b\"\n", "name_twice.txtpb:2");
  robot("xml", kUrdf.substr(0, 40), "XML");
  robot("long_word", repeated("x", 1 << 20) + ": 1\n", "long_word.txtpb:1");
  robot("deep", repeated("mount { pose { ", 2000), "deep.txtpb:1");
  robot("urdf_missing",
        "name: \"r\"\nurdf: \"none.urdf\"\ngroups { name: \"arm\" joints: \"j\" }\n", "none.urdf",
        3);
  robot("variable_missing", "name: \"r\"\nurdf: \"$HANDSEL_NO_SUCH/none.urdf\"\n",
        "HANDSEL_NO_SUCH", 3);
  robot("no_text", "name: \"\\377\"\n", "no_text.txtpb:1:name: is no text in UTF-8");
  robot("velocity_nan", "name: \"r\"\ncomfort { joints: \"j\" velocity: nan }\n",
        "velocity_nan.txtpb:2:velocity: is nan");
  robot("jerk_infinite", "name: \"r\"\nguard { joints: \"j\" jerk: inf }\n",
        "jerk_infinite.txtpb:2:jerk: is inf");
  robot("rest_overflow", "name: \"r\"\nrest { key: \"j\" value: 1e400 }\n",
        "rest_overflow.txtpb:2:value: is inf");
  robot("rest_twice", "name: \"r\"\nrest { key: \"j\" value: 0 }\nrest { key: \"j\" value: 1 }\n",
        "has the key \"j\" twice");
  robot("platform_negative", "name: \"r\"\nplatform { speed: -1 turn_speed: 1 }\n",
        "platform_negative.txtpb:2:speed: is -1");
  table.push_back(
      {"robot/missing.txtpb", "", kInfo, "missing.txtpb", 3, "", BadFile::Kind::missing});
  table.push_back({"robot/folder.txtpb", "", kInfo, "is not a file", 2, "", BadFile::Kind::folder});
  table.push_back({"robot/long_name", "", "model info " + repeated("n", 5000), "no robot \"nnn", 3,
                   "", BadFile::Kind::missing});
}

void add_hands(BadFiles& table) {
  const std::string good =
      with(source_file("deploy/hands/parallel/parallel.txtpb"), "\"parallel.urdf\"",
           "\"$HANDSEL_SOURCE/deploy/hands/parallel/parallel.urdf\"");
  const std::string list = "env HANDSEL_SOURCE={source} handsel grasp list --object box --hand {}";
  const auto hand = [&](const std::string& name, const std::string& content,
                        const std::string& says) {
    table.push_back({"hand/" + name + ".txtpb", content, list, says});
  };
  hand("empty", "", "name is missing");
  hand("no_fingers", "name: \"h\"\n", "at least two fingers");
  hand("pad_negative", with(good, "width: 0.02", "width: -0.02"), "width: is -0.02");
  hand("pad_nan", with(good, "height: 0.028", "height: nan"), "height: is nan");
  hand("frame_infinite", with(good, "z: 0.114", "z: inf"), "z: is inf");
  hand("rest_outside", with(good, "value: 0.02", "value: 7"), "outside the joint's limits");
  hand("joint_unknown", with(good, "joints: \"finger_joint\"", "joints: \"thumb\""),
       "no joint \"thumb\"");
  hand("margin_too_large", with(good, "contact_margin: 0.0005", "contact_margin: 1"),
       "leaves no range");
  hand("force_nan", with(good, "grip_force: 30", "grip_force: nan"), "grip_force: is nan");
}

void add_objects(BadFiles& table) {
  const std::string mug = HANDSEL_SOURCE_DIR "/deploy/objects/mug/mug.obj";
  const auto object = [&](const std::string& name, const std::string& content,
                          const std::string& says, int exit_code = 2) {
    table.push_back({"object/" + name + ".txtpb", content, kMesh, says, exit_code});
  };
  object("empty", "", "name is missing");
  object("mass_zero", "name: \"o\"\nmesh: \"o.obj\"\nmass: 0\n", "mass");
  object("mass_nan", "name: \"o\"\nmesh: \"o.obj\"\nmass: nan\n", "mass_nan.txtpb:3:mass: is nan");
  object("friction_negative", "name: \"o\"\nmesh: \"o.obj\"\nmass: 1\nfriction: -1\n",
         "friction_negative.txtpb:4:friction: is -1");
  object("scale_infinite", "name: \"o\"\nmesh: \"o.obj\"\nmass: 1\nscale { x: inf y: 1 z: 1 }\n",
         "x: is inf");
  object("scale_zero", "name: \"o\"\nmesh: \"" + mug + "\"\nmass: 1\nscale { x: 0 y: 1 z: 1 }\n",
         "a mesh scale must be finite and not 0");
  object("mesh_missing", "name: \"o\"\nmesh: \"none.obj\"\nmass: 1\n", "none.obj", 3);
  object("mesh_folder", "name: \"o\"\nmesh: \".\"\nmass: 1\n", "is not a file");
  object("com_huge", "name: \"o\"\nmesh: \"o.obj\"\nmass: 1\ncom { x: 1e300 }\n", "x: is 1e+300");
  object("no_mesh", "name: \"o\"\nmass: 1\n", "mesh is missing");
}

}  // namespace

void add_meshes(BadFiles& table) {
  const std::filesystem::path corpus =
      std::filesystem::path(HANDSEL_SOURCE_DIR) / "tests/fuzz/corpus/mesh";
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("good", 0) != 0)
      table.push_back(
          {"mesh/" + name, source_file("tests/fuzz/corpus/mesh/" + name), kMesh, name + ":"});
  }
  table.push_back({"mesh/long_line.obj", kTriangle + "f " + repeated("1 ", 200000) + "\n", kMesh,
                   "long_line.obj:9: a line of 400002 bytes"});
  table.push_back({"mesh/missing.stl", "", kMesh, "missing.stl", 3, "", BadFile::Kind::missing});
  table.push_back({"mesh/folder.dae", "", kMesh, "is not a file", 2, "", BadFile::Kind::folder});
  table.push_back({"mesh/unreadable.obj", kTriangle, kMesh, "cannot be read", 2, "",
                   BadFile::Kind::unreadable});
  table.push_back({"mesh/scale.obj", kTriangle, kMesh + " --scale inf",
                   "a mesh scale must be finite and not 0"});
  std::string xml = "<COLLADA>";
  table.push_back({"mesh/very_deep.dae", xml + repeated("<a>", 100000), kMesh,
                   "very_deep.dae:1: elements are nested deeper than 64"});
}

void add_descriptions(BadFiles& table) {
  add_urdfs(table);
  add_srdfs(table);
  add_robots(table);
  add_hands(table);
  add_objects(table);
}

}  // namespace handsel::test
