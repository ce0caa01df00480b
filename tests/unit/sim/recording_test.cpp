// SPDX-License-Identifier: Apache-2.0
// Recorded people: third-party and own BVH and CSV files, bodies of other sizes, and invalid files.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "common/base/errors.hpp"
#include "sim/recordings/bvh.hpp"
#include "sim/recordings/recording.hpp"
#include "tests/support/reference_data.hpp"

namespace handsel::sim::recording_test {
namespace {

namespace fs = std::filesystem;

int joint(const char* name) { return body_joint_index(name); }

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

fs::path ours(const std::string& name) {
  return fs::path(HANDSEL_SOURCE_DIR) / "tests/fuzz/corpus" / name;
}

fs::path bvh_folder() { return handsel::test::reference_data("motion/bvh").value_or(fs::path()); }

std::string sentence(const std::string& name) {
  try {
    load_recording(ours(name));
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    return text.substr(text.rfind('/') + 1);
  }
  return "read";
}

TEST(Bvh, joint_positions_are_those_of_a_third_party_tool) {
  if (bvh_folder().empty()) GTEST_SKIP() << "HANDSEL_DATA names no folder with motion/bvh";
  const Bvh bvh = parse_bvh(contents(bvh_folder() / "walk01.bvh"), "walk01.bvh");
  EXPECT_EQ(bvh.frames(), 101u);
  EXPECT_NEAR(bvh.frame_time, 0.0416667, 1e-9);
  std::istringstream table(contents(bvh_folder() / "walk01_pos.csv"));
  std::string line, cell;
  std::getline(table, line);
  std::vector<std::pair<int, int>> columns;  // joint, axis
  std::istringstream header(line);
  while (std::getline(header, cell, ',')) {
    if (!cell.empty() && cell.back() == '\r') cell.pop_back();
    const auto dot = cell.rfind('.');
    columns.emplace_back(dot == std::string::npos ? -1 : bvh.find(cell.substr(0, dot)),
                         cell.back() - 'x');
  }
  int compared = 0;
  double worst = 0;
  std::vector<Vector3> points;
  for (std::size_t frame = 0; std::getline(table, line); ++frame) {
    ASSERT_LT(frame, bvh.frames());
    bvh.positions(frame, points);
    std::istringstream row(line);
    for (const auto& [j, axis] : columns) {
      std::getline(row, cell, ',');
      if (j < 0) continue;
      worst =
          std::max(worst, std::abs(points[static_cast<std::size_t>(j)][axis] - std::stod(cell)));
      ++compared;
    }
  }
  EXPECT_GT(compared, 5000);
  EXPECT_LT(worst, 2e-5) << "file units; the table has five decimals";
}

TEST(Bvh, every_file_of_others_is_read_and_is_a_body) {
  if (bvh_folder().empty()) GTEST_SKIP() << "HANDSEL_DATA names no folder with motion/bvh";
  int read = 0;
  for (const auto& entry : fs::directory_iterator(bvh_folder())) {
    if (entry.path().extension() != ".bvh") continue;
    const std::string name = entry.path().filename().string();
    if (name == "standard_skeleton.bvh") {
      EXPECT_THROW(load_recording(entry.path()), ConfigError) << "one frame";
      continue;
    }
    const Recording r = load_recording(entry.path());
    ++read;
    EXPECT_GT(r.stature, 1.4) << name;
    EXPECT_LT(r.stature, 2.1) << name;
    const BodyPoints& first = r.frames.front();
    EXPECT_GT(first[joint("head")].z(), 1.2) << name;
    EXPECT_GT(first[joint("l_shoulder")].y(), first[joint("r_shoulder")].y())
        << name << ": left is left of someone who faces +x";
    EXPECT_NEAR(first[joint("waist")].head<2>().norm(), 0, 1e-9) << name;
    double lowest = 1e9, travel = 0;
    for (const BodyPoints& frame : r.frames) {
      lowest = std::min({lowest, frame[joint("l_ankle")].z(), frame[joint("r_ankle")].z()});
      travel = std::max(travel, frame[joint("waist")].head<2>().norm());
    }
    EXPECT_NEAR(lowest, 0.039 * r.stature, 1e-6) << name << ": the feet are on the floor";
    EXPECT_LE(travel, 0.5) << name << ": who walks, walks on the spot";
    for (std::size_t i = 0; i < first.size(); ++i)
      EXPECT_LT((r.frames[1][i] - first[i]).norm() * r.rate, 15) << name << ": begins with a jump";
    EXPECT_GT((first[joint("r_wrist")] - first[joint("r_elbow")]).norm(), 0.15) << name;
    EXPECT_LT((first[joint("r_wrist")] - first[joint("r_elbow")]).norm(), 0.40) << name;
  }
  EXPECT_GE(read, 7);
}

TEST(Recordings, of_our_corpus_reach_with_the_right_hand) {
  for (const char* name : {"csv/good_reach.csv", "bvh/good_cm.bvh", "bvh/good_inches.bvh",
                           "bvh/good_no_unit.bvh", "bvh/good_prefix.bvh"}) {
    const Recording r = load_recording(ours(name));
    EXPECT_EQ(r.taking, Side::right) << name;
    EXPECT_NEAR(r.stature, 1.75, 0.2) << name;
    EXPECT_NEAR(r.frames.front()[joint("head")].z(), 0.93 * r.stature, 0.08) << name;
    EXPECT_GT(r.contact, 0.0) << name;
  }
}

TEST(Recordings, begin_after_the_rest_pose_of_the_skeleton) {
  const Recording r = load_recording(ours("bvh/good_rest_pose.bvh")),
                  same = load_recording(ours("bvh/good_cm.bvh"));
  ASSERT_EQ(r.frames.size(), same.frames.size());
  const double off =
      (r.frames.front()[joint("r_hand")] - same.frames.front()[joint("r_hand")]).norm();
  EXPECT_LT(off, 0.01);
  EXPECT_EQ(r.contact, same.contact);
}

TEST(Recordings, uneven_times_are_resampled) {
  const Recording r = load_recording(ours("csv/good_uneven.csv"));
  EXPECT_NEAR(r.rate, 19 / (19 / 30.0 + 0.01), 0.01);
  EXPECT_EQ(r.frames.size(), 20u);
}

/// A bent arm keeps its fraction of the reach and its direction, with the feet on the floor.
TEST(Retarget, keeps_feet_on_the_floor_bones_of_the_new_body_and_the_reach) {
  const auto length = [](const BodyPoints& p, const char* a, const char* b) {
    return (p[joint(a)] - p[joint(b)]).norm();
  };
  std::vector<fs::path> files{ours("csv/good_reach.csv"), ours("bvh/good_cm.bvh")};
  if (!bvh_folder().empty()) files.push_back(bvh_folder() / "cmu_12_01_walk.bvh");
  for (const fs::path& file : files) {
    const Recording from = load_recording(file);
    for (const double stature : {1.45, 1.70, 2.0}) {
      const Recording to = retarget(from, stature);
      const auto model = standing_body(Vector3::Zero(), 0, stature);
      const auto wanted = [&](const char* a, const char* b) {
        return (model[static_cast<std::size_t>(joint(a))].position -
                model[static_cast<std::size_t>(joint(b))].position)
            .norm();
      };
      double lowest = 1e9;
      for (std::size_t f = 0; f < to.frames.size(); f += 3) {
        const BodyPoints &p = to.frames[f], &q = from.frames[f];
        lowest = std::min({lowest, p[joint("l_ankle")].z(), p[joint("r_ankle")].z()});
        for (const auto& [a, b] : {std::pair{"r_shoulder", "r_elbow"},
                                   {"r_elbow", "r_wrist"},
                                   {"r_wrist", "r_hand"},
                                   {"l_knee", "l_hip"},
                                   {"neck", "torso"},
                                   {"r_knee", "r_ankle"}})
          ASSERT_NEAR(length(p, a, b), wanted(a, b), 1e-6) << a << " " << file << " frame " << f;
        const auto share = [&](const BodyPoints& x) {
          return length(x, "r_shoulder", "r_hand") /
                 (length(x, "r_shoulder", "r_elbow") + length(x, "r_elbow", "r_wrist") +
                  length(x, "r_wrist", "r_hand"));
        };
        ASSERT_NEAR(share(p), share(q), 0.03) << file << " frame " << f;
        const Vector3 d = (p[joint("r_hand")] - p[joint("r_shoulder")]).normalized(),
                      e = (q[joint("r_hand")] - q[joint("r_shoulder")]).normalized();
        ASSERT_GT(d.dot(e), 0.999) << file << " frame " << f;
      }
      EXPECT_NEAR(lowest, 0.039 * stature, 0.01);
      EXPECT_NEAR(to.frames.front()[joint("head")].z() / from.frames.front()[joint("head")].z(),
                  stature / from.stature, 0.12);
    }
  }
}

TEST(Retarget, to_its_own_size_changes_little) {
  const Recording from = load_recording(ours("csv/good_reach.csv"));
  const Recording to = retarget(from, from.stature);
  for (std::size_t f = 0; f < to.frames.size(); ++f)
    EXPECT_LT((to.frames[f][joint("r_hand")] - from.frames[f][joint("r_hand")]).norm(), 0.12);
}

TEST(BadRecordings, are_refused_in_one_sentence_with_file_and_line) {
  const std::pair<const char*, const char*> expected[] = {
      {"csv/nan.csv", "nan.csv:7: column 4 is not a finite number within 1e7"},
      {"csv/time_backwards.csv", "time_backwards.csv:7: time 0.100000 is not after 0.133300"},
      {"csv/column_missing.csv", "column_missing.csv:1: waist needs the columns .x, .y and .z"},
      {"csv/short_row.csv", "short_row.csv:7: has 34 columns, the first line names 37"},
      {"csv/twice.csv", "twice.csv:1: column head.x is there twice"},
      {"csv/one_row.csv", "one_row.csv:2: needs at least two rows of positions"},
      {"csv/header_only.csv", "header_only.csv:1: needs at least two rows of positions"},
      {"bvh/zero_frame_time.bvh", "Frame Time: must be above 0.0001 and at most 1 second"},
      {"bvh/unknown_channel.bvh",
       "unknown_channel.bvh:5: channel \"Wrotation\" is unknown; there are Xposition ... "
       "Zposition, Xrotation ... Zrotation"},
      {"bvh/fewer_frames.bvh", "the motion ends in frame 21 of 25 announced by Frames:"},
      {"bvh/more_frames.bvh", "there is more motion than the 15 frames of 54 values announced"},
      {"bvh/truncated_hierarchy.bvh", "expected CHANNELS, found"},
      {"bvh/negative_frames.bvh", "Frames: must be a whole number of at least 1"},
      {"bvh/no_arm.bvh", "no joint for the body's l_elbow; known names are leftforearm"},
      {"bvh/one_frame.bvh", "one frame is no motion"},
      {"bvh/deep.bvh", "the hierarchy is deeper than 128"},
  };
  for (const auto& [file, text] : expected)
    EXPECT_NE(sentence(file).find(text), std::string::npos) << file << ": " << sentence(file);
}

TEST(BadRecordings, wrong_units_are_told_by_the_bodys_size) {
  EXPECT_NE(sentence("csv/millimetres.csv")
                .find("millimetres.csv:2: from waist to head the body measures 650.0"),
            std::string::npos)
      << sentence("csv/millimetres.csv");
  EXPECT_NE(sentence("csv/millimetres.csv")
                .find("which looks like millimetres; positions must be in metres"),
            std::string::npos);
  EXPECT_NE(sentence("csv/centimetres.csv").find("looks like centimetres"), std::string::npos);
  EXPECT_NE(sentence("csv/giant.csv").find("no person's"), std::string::npos);
  EXPECT_NE(sentence("csv/milliseconds.csv").find("is time in seconds?"), std::string::npos);
  EXPECT_NE(sentence("csv/y_up.csv").find("z must be up"), std::string::npos);
}

TEST(BadRecordings, of_another_kind_or_missing) {
  EXPECT_THROW(load_recording("no/such.bvh"), MissingError);
  EXPECT_THROW(load_recording(fs::path(HANDSEL_SOURCE_DIR) / "README.md"), ConfigError);
}

}  // namespace
}  // namespace handsel::sim::recording_test
