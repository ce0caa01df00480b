// SPDX-License-Identifier: Apache-2.0
// Calibration of sources: invalid files, and points converted to the world frame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "common/base/errors.hpp"
#include "components/spark/calibration.hpp"
#include "components/spark/sources.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::spark::calibration_test {
namespace {

using ::testing::HasSubstr;

class CalibrationFile : public ::testing::Test {
 protected:
  Calibration read(const std::string& text) {
    const std::filesystem::path file = folder_.path() / "calibration.txtpb";
    std::ofstream(file) << text;
    return Calibration(file);
  }
  std::string mistake(const std::string& text) {
    try {
      read(text);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "none";
  }
  test::TemporaryFolder folder_;
};

TEST_F(CalibrationFile, each_mistake_is_named_with_its_line) {
  const std::string camera = "# cameras\nsources { source: \"kinect\" speaks_in: CAMERA ";
  EXPECT_THAT(mistake(camera + "T_world_camera { orientation { x: 0.5 w: 0.5 } } }"),
              HasSubstr("calibration.txtpb:2: source kinect has an orientation of norm 0.7071; a "
                        "rotation is a quaternion x y z w of norm 1"));
  EXPECT_THAT(mistake(camera + "T_world_camera { rotation: [1, 0, 0, 0, 1, 0, 0, 0, 2] } }"),
              HasSubstr("right angles and of length 1 (off by 3)"));
  EXPECT_THAT(mistake(camera + "T_world_camera { rotation: [1, 0, 0, 0, 1, 0, 0, 0, -1] } }"),
              HasSubstr("mirrors"));
  EXPECT_THAT(mistake(camera + "T_world_camera { rotation: [1, 0, 0] } }"),
              HasSubstr("a rotation of 3 numbers; it must be nine"));
  EXPECT_THAT(mistake(camera + "T_world_camera { position { x: 2100 } } }"),
              HasSubstr("stands 2100 m from the world's origin; positions are in metres"));
  EXPECT_THAT(mistake(camera + "T_world_camera { position { x: nan } } }"),
              HasSubstr(":x: is nan, must be a number in"));
  EXPECT_THAT(mistake(camera + "}"), HasSubstr("T_world_camera"));
  EXPECT_THAT(mistake(camera + "T_world_camera {} } sources { source: \"kinect\" }"),
              HasSubstr("is there twice"));
  EXPECT_THAT(mistake(camera + "T_world_camera {} measured: \"2026-13-01\" }"),
              HasSubstr("2026-13-01, which is no date"));
  EXPECT_THAT(mistake(camera + "T_world_camera {} coverage_low { x: 1 } }"),
              HasSubstr("both or none"));
  EXPECT_THAT(mistake("sources { speaks_in: WORLD }"), HasSubstr("has no name"));
  EXPECT_THAT(mistake("sources { sauce: \"kinect\" }"), HasSubstr("calibration.txtpb:1"));
  EXPECT_EQ(mistake("sources { source: \"kinect\" } robots { robot: \"jido\" T_world_base {} } "
                    "valid_days: 90"),
            "none");
  EXPECT_TRUE(Calibration(folder_.path() / "nothing.txtpb").sources().empty());
}

TEST_F(CalibrationFile, what_a_camera_says_is_brought_to_the_world) {
  const Calibration calibration = read(
      R"(sources { source: "side" speaks_in: CAMERA T_world_camera { position { x: 1 y: 2 z: 0.5 }
      rotation: [0, -1, 0, 1, 0, 0, 0, 0, 1] } } sources { source: "top" })");
  HumanObservation people;
  people.source = "side";
  people.coverage = {{-1, -2, 0}, {3, 2, 2}};
  people.people.push_back({"1", {{"head", {1, 0, 1.2}, 1}}, true, {1, 0, 1.2}, {1, 0, 0}});
  ObjectObservation things;
  things.source = "side";
  things.objects = {{"mug", "mug", make_pose({0, 1, 0}), 1, {{{1, 1, 0}, 2}}, {}}};
  HumanObservation same = people;
  same.source = "top";
  calibration.to_world(same);
  EXPECT_EQ(same.people[0].joints[0].position, people.people[0].joints[0].position)
      << "it speaks in frame world";
  calibration.to_world(people);
  calibration.to_world(things);
  EXPECT_TRUE(people.people[0].joints[0].position.isApprox(Vector3(1, 3, 1.7)));
  EXPECT_TRUE(people.people[0].gaze_origin.isApprox(Vector3(1, 3, 1.7)));
  EXPECT_TRUE(people.people[0].gaze_direction.isApprox(Vector3(0, 1, 0)));
  EXPECT_TRUE(people.coverage.low.isApprox(Vector3(-1, 1, 0.5)))
      << "turned by a right angle nothing of it is lost";
  EXPECT_TRUE(people.coverage.high.isApprox(Vector3(3, 5, 2.5)));
  EXPECT_TRUE(things.objects[0].T_world_object.translation().isApprox(Vector3(0, 2, 0.5)));
  EXPECT_TRUE(things.objects[0].grips[0].position.isApprox(Vector3(0, 3, 0.5)));
}

TEST(Coverage, of_a_turned_camera_is_never_more_than_it_looked_at) {
  std::mt19937 random(31);
  std::printf("seed 31\n");
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Coverage box{{-1 - unit(random), -2 + unit(random), -1},
                       {2 + unit(random), 1.5, 1 + 0.5 * unit(random)}};
    const Pose T = make_pose(
        Vector3(unit(random), unit(random), unit(random)),
        Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized());
    const Coverage inside = inscribed(box, T);
    ASSERT_TRUE((inside.low.array() <= inside.high.array()).all());
    for (int corner = 0; corner < 8; ++corner) {
      Vector3 p;
      for (int k = 0; k < 3; ++k) p[k] = corner >> k & 1 ? inside.high[k] : inside.low[k];
      const Vector3 q = T.inverse() * p;
      for (int k = 0; k < 3; ++k)
        ASSERT_TRUE(q[k] >= box.low[k] - 1e-9 && q[k] <= box.high[k] + 1e-9) << i;
    }
  }
}

TEST(Days, between_dates) {
  EXPECT_EQ(days_between("2026-02-27", "2026-03-01"), 2);
  EXPECT_EQ(days_between("2026-11-21", "2026-11-20"), -1);
  EXPECT_FALSE(days_between("", "2026-11-20"));
  EXPECT_FALSE(days_between("2026-11-20x", "2026-11-20"));
}

}  // namespace
}  // namespace handsel::spark::calibration_test
