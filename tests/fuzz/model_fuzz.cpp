// SPDX-License-Identifier: Apache-2.0
// Fuzzes URDF and SRDF of users. For libFuzzer: clang++ -fsanitize=fuzzer,address with the
// sources of common/model; here corpora and their seeded mutations are replayed.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/base/errors.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

namespace fs = std::filesystem;

/// A folder in memory where there is one: the readers take files.
fs::path scratch() {
  static const fs::path folder = [] {
    std::string pattern =
        (fs::is_directory("/dev/shm") ? "/dev/shm" : "/tmp") + std::string("/handsel-fuzz-XXXXXX");
    return fs::path(mkdtemp(pattern.data()));
  }();
  return folder;
}

fs::path written(const std::string& name, const std::string& content) {
  std::ofstream(scratch() / name, std::ios::binary) << content;
  return scratch() / name;
}

/// True when the robot was read. Aborts when a refusal is no sentence or a pose of the robot is not
/// finite.
bool read_robot(const std::string& name, const fs::path& urdf, const fs::path& srdf) {
  try {
    const RobotModel robot = RobotModel::load_urdf(urdf, srdf, Meshes::skip);
    std::vector<Pose> poses;
    robot.forward(robot.rest_configuration(), poses);
    for (const Pose& pose : poses)
      if (!pose.matrix().allFinite()) std::abort();
    return true;
  } catch (const std::runtime_error& error) {
    const std::string what = error.what();
    if (what.find(name) == std::string::npos || what.find('\n') != std::string::npos ||
        what.size() > 1000) {
      std::fprintf(stderr, "no sentence: %s\n", what.c_str());
      std::abort();
    }
    return false;
  }
}

bool read_urdf(const std::string& name, const std::string& content) {
  return read_robot(name, written(name, content), {});
}

bool read_srdf(const std::string& name, const std::string& content) {
  static const fs::path urdf =
      written("arm.urdf",
              "<robot name=\"r\"><link name=\"base\"/><link name=\"one\"/><link name=\"two\"/>"
              "<joint name=\"a\" type=\"revolute\"><parent link=\"base\"/><child "
              "link=\"one\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" "
              "upper=\"1\" "
              "velocity=\"2\" effort=\"3\"/></joint><joint name=\"b\" type=\"revolute\"><parent "
              "link=\"one\"/><child link=\"two\"/><axis xyz=\"0 1 "
              "0\"/><limit lower=\"-1\" upper=\"1\" velocity=\"2\" effort=\"3\"/></joint></robot>");
  return read_robot(name, urdf, written(name, content));
}

}  // namespace handsel

#ifdef HANDSEL_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string content(reinterpret_cast<const char*>(data) + 1, size - 1);
  data[0] & 1 ? handsel::read_urdf("f.urdf", content) : handsel::read_srdf("f.srdf", content);
  return 0;
}
#else
#include "tests/fuzz/replay.hpp"

namespace handsel {
namespace {

struct ModelFuzz : testing::Test {
  static void TearDownTestSuite() { fs::remove_all(scratch()); }
};

TEST_F(ModelFuzz, no_urdf_crashes_and_each_refusal_is_one_sentence) {
  fuzz::replay(
      "urdf", read_urdf,
      {"<link name=\"a\"/>",
       "<joint name=\"k\" type=\"fixed\"><parent link=\"one\"/><child link=\"a\"/></joint>",
       "xyz=\"1 2\"", "<mimic joint=\"j\"/>", "type=\"continuous\"", "<limit/>", "rpy=\"9e9 0 0\"",
       "</link>", "<collision>", "name=\"one\""},
      60);
}

TEST_F(ModelFuzz, no_srdf_crashes_and_each_refusal_is_one_sentence) {
  fuzz::replay("srdf", read_srdf,
               {"<group name=\"arm\"/>", "<group name=\"both\">", "</group>",
                "<chain base_link=\"two\" tip_link=\"base\"/>", "<joint name=\"a\"/>",
                "<link name=\"two\"/>", "link1=\"two\""},
               60);
}

}  // namespace
}  // namespace handsel
#endif
