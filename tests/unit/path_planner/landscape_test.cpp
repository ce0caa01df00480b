// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/pictures/landscape.hpp"

#include <gtest/gtest.h>

namespace handsel::landscape_test {
namespace {

TEST(Landscape, trees_follow_the_valleys_from_start_and_goal) {
  const LandscapeResult found = plan_on_landscape(PlannerKind::bitrrt, 1);
  ASSERT_TRUE(found.answer["solved"].get<bool>());
  ASSERT_EQ(found.answer["trees"].size(), 2u);
  for (const auto& tree : found.answer["trees"]) {
    EXPECT_EQ(tree[0][2], -1);
    for (std::size_t i = 1; i < tree.size(); ++i)
      EXPECT_LT(tree[i][2].get<int>(), static_cast<int>(i));
  }
  EXPECT_EQ(found.answer["path"].front(), nlohmann::json({-0.85, -0.75}));
  EXPECT_EQ(found.answer["path"].back(), nlohmann::json({0.85, 0.8}));
  EXPECT_LT(found.answer["work"].get<double>(), 0.5) << "the straight line climbs 0.9";
  EXPECT_EQ(plan_on_landscape(PlannerKind::bitrrt, 1).answer, found.answer);
}

TEST(Landscape, picture_is_a_png) {
  const std::string png = plan_on_landscape(PlannerKind::trrt, 2).png;
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(png.size() - 8), "IEND\xae\x42\x60\x82");
}

}  // namespace
}  // namespace handsel::landscape_test
