// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>

#include "tests/unit/sim/person_fixture.hpp"

namespace handsel::sim::recorded_person_test {
namespace {

using namespace test;

TEST(SimRecording, the_taker_of_the_kth_sample_faces_forward_and_reaches_with_the_right_hand) {
  if (recording_folder().empty()) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const Recording recording = load_recording(recording_folder());
  EXPECT_EQ(recording.frames.size(), 801u);
  EXPECT_EQ(recording.taking, Side::right);
  EXPECT_NEAR(recording.contact, 3.05, 0.25);
  const BodyPoints& first = recording.frames.front();
  EXPECT_GT(first[joint("l_shoulder")].y(), first[joint("r_shoulder")].y())
      << "left is left of someone who faces +x";
  EXPECT_LT(std::abs(first[joint("l_shoulder")].x() - first[joint("r_shoulder")].x()), 0.02);
  EXPECT_NEAR(first[joint("waist")].head<2>().norm(), 0, 1e-9);
  EXPECT_GT(first[joint("head")].z(), 1.3);
  BodyPoints reaching;
  recording.sample(recording.contact, reaching);
  EXPECT_GT(reaching[joint("r_hand")].x(), 0.45);
}

TEST(SimRecording,
     the_hand_is_warped_by_at_most_ten_centimetres_at_the_end_and_the_feet_by_thirty) {
  if (recording_folder().empty()) GTEST_SKIP() << "HANDSEL_DATA is not set";
  PersonSettings settings;
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  settings.kind = PersonKind::recording;
  settings.recording = std::make_shared<const Recording>(load_recording(recording_folder()));
  const auto recorded_at = [&](double t, const char* name) {
    BodyPoints points;
    settings.recording->sample(t, points);
    return Vector3(settings.feet + Eigen::AngleAxisd(M_PI, Vector3::UnitZ()) * points[joint(name)]);
  };
  const double contact = settings.recording->contact;
  for (const Vector3& off : {Vector3(0.02, 0.03, -0.04), Vector3(0.15, -0.1, 0.0),
                             Vector3(0.2, 0.2, 0.25), Vector3(0.65, 0, 0)}) {
    PersonModel person(settings);
    const PersonView view = offer(recorded_at(contact, "r_hand") + Vector3(-0.07, 0, 0) + off);
    double clock = 0, t = 0, warp = 0, step = 0;
    while (clock < 6 && person.phase() != PersonPhase::closing) {
      person.step(0.001, view);
      clock += 0.001;
      if (person.phase() != PersonPhase::reaching) continue;
      t = std::min(t + 0.001, contact);
      const Vector3 moved = person.body().joints[joint("waist")].position - recorded_at(t, "waist");
      const double bent =
          (person.hand().T_world_body.translation() - recorded_at(t, "r_hand") - moved).norm();
      if (t < contact - settings.manners.recorded_warp_time - 0.002) {
        ASSERT_LT(bent, 0.005) << "at " << t;
      }
      warp = std::max(warp, bent);
      step = std::max(step, moved.norm());
    }
    EXPECT_LT(warp, settings.manners.recorded_max_warp + 0.005);
    EXPECT_LT(step, 0.305);
    const bool within = off.head<2>().norm() < 0.3 && std::abs(off.z()) < 0.1;
    EXPECT_EQ(person.phase() == PersonPhase::closing, within) << off.transpose();
  }
}

class BadRecording : public ::testing::Test {
 protected:
  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("recording_" + std::to_string(getpid()));
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    for (const char* part :
         {"hip", "chest", "neck", "head", "LUArm", "RUArm", "LFArm", "RFArm", "LHand", "RHand"}) {
      const std::string row = std::string("0,") + (part[0] == 'L' ? "0.2" : "-0.2") +
                              (part == std::string("head") ? ",1.65" : ",1") + ",0,0,0,1\n";
      write(part, "x,y,z,q0,q1,q2,q3\n" + row + row);
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& part, const std::string& text) {
    std::ofstream(folder_ / ("taker_" + part + "_pose_saved.csv")) << text;
  }
  std::string sentence() {
    try {
      load_recording(folder_);
    } catch (const std::runtime_error& error) {
      const std::string text = error.what();
      return text.substr(text.rfind('/') == std::string::npos ? 0 : text.rfind('/') + 1);
    }
    return "accepted";
  }
};

TEST_F(BadRecording, names_file_line_and_fault) {
  EXPECT_EQ(sentence(), "accepted");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0,1\n0,0,oops,0,0,0,1\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:3: column 3 is not a finite number");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,nan,0,0,0,1\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:2: column 3 is not a finite number");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0,2\n");
  EXPECT_EQ(sentence(),
            "taker_neck_pose_saved.csv:2: the quaternion's length is 2.000000, must be 1");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:2: expected 7 numbers separated by commas");
  write("neck", "a,b\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:1: the first line must be x,y,z,q0,q1,q2,q3");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0,1\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:2: needs at least two rows");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0,1\n0,0,1,0,0,0,1\n0,0,1,0,0,0,1\n");
  EXPECT_NE(sentence().find("rows, they must agree"), std::string::npos);
  std::filesystem::remove(folder_ / "taker_neck_pose_saved.csv");
  EXPECT_NE(sentence().find("cannot be opened"), std::string::npos);
}

TEST(SimRecording, a_missing_folder_is_missing) {
  EXPECT_THROW(load_recording("no/such/folder"), MissingError);
}

}  // namespace
}  // namespace handsel::sim::recorded_person_test
