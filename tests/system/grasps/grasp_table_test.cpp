// SPDX-License-Identifier: Apache-2.0
// Third-party objects with the Schunk, Allegro and Barrett hands: no list is empty.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "deploy/handsel/offline/grasp_table.hpp"
#include "tests/support/reference_data.hpp"

namespace handsel::grasp_table_test {
namespace {

TEST(GraspTable, every_object_made_by_others_has_grasps_by_every_hand) {
  const auto folder = test::reference_data("objects");
  if (!folder) GTEST_SKIP() << "HANDSEL_DATA is not set";
  std::vector<std::string> meshes;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(*folder)) {
    const std::string name = entry.path().stem().string();
    // Skips convex parts and collision meshes: their objects are in the folder as well.
    if (entry.path().extension() == ".obj" && name.find("_vhacd") == std::string::npos &&
        name != "mug_col")
      meshes.push_back(entry.path().string());
  }
  std::sort(meshes.begin(), meshes.end());
  ASSERT_GE(meshes.size(), 15U);
  ListOptions o;
  o.positions = 40;
  o.orientations = 72;
  std::printf("%s\n", table_head().c_str());
  for (const std::string& mesh : meshes) {
    for (const char* hand : {"sah", "allegro", "barrett"}) {
      o.object = mesh;
      const TableRow row = table_row(hand, o, true);
      std::printf("%s\n", table_line(row).c_str());
      std::fflush(stdout);
      EXPECT_FALSE(row.reason.empty());
      EXPECT_GT(row.grasps, 0U) << hand << " on " << mesh << ": " << row.reason;
    }
  }
}

}  // namespace
}  // namespace handsel::grasp_table_test
