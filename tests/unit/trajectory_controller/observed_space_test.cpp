// SPDX-License-Identifier: Apache-2.0
// The union of the boxes of live views.
#include "components/trajectory_controller/input/observed_space.hpp"

#include <gtest/gtest.h>

#include <random>

namespace handsel::trajectory_controller::observed_space_test {
namespace {

SourceView view(const Vector3& low, const Vector3& high, double age = 0.05) {
  return {"camera", low, high, age, true, ""};
}

ObservedSpace space(std::vector<SourceView> views) {
  ObservedSpace out(0.25);
  out.set(views);
  return out;
}

const Box kUnit{{0, 0, 0}, {1, 1, 1}};

TEST(ObservedSpace, contains_nothing_without_a_view) {
  EXPECT_FALSE(space({}).contains(kUnit, 0));
  EXPECT_FALSE(space({}).any(0));
}

TEST(ObservedSpace, contains_what_is_in_one_view) {
  EXPECT_TRUE(space({view({0, 0, 0}, {1, 1, 1})}).contains(kUnit, 0)) << "its sides belong to it";
  EXPECT_FALSE(space({view({0, 0, 0}, {1, 0.99, 1})}).contains(kUnit, 0));
}

TEST(ObservedSpace, contains_what_lies_in_several_views_together) {
  const SourceView left = view({-1, -1, -1}, {0.5, 2, 2}), right = view({0.5, -1, -1}, {2, 2, 2});
  EXPECT_TRUE(space({left, right}).contains(kUnit, 0));
  EXPECT_FALSE(space({left, right}).one_contains(kUnit, 0));
  EXPECT_FALSE(space({left, view({0.51, -1, -1}, {2, 2, 2})}).contains(kUnit, 0))
      << "a gap of 1 cm";
  EXPECT_FALSE(space({left, view({0.5, -1, -1}, {2, 2, 0.9})}).contains(kUnit, 0)) << "an edge";
}

TEST(ObservedSpace, leaves_out_what_is_not_live_or_too_old) {
  SourceView frozen = view({-1, -1, -1}, {2, 2, 2});
  frozen.live = false;
  EXPECT_FALSE(space({frozen}).contains(kUnit, 0));
  const ObservedSpace seen = space({view({-1, -1, -1}, {2, 2, 2}, 0.1)});
  EXPECT_TRUE(seen.contains(kUnit, 0.14)) << "a view's age grows with the time since the message";
  EXPECT_FALSE(seen.contains(kUnit, 0.16));
  EXPECT_FALSE(seen.any(0.16));
  EXPECT_FALSE(space({view({-1, -1, -1}, {2, 2, 2}, -5)}).any(0.3))
      << "nothing is younger than now";
}

/// A grid of points decides as well, where the boxes' sides lie on a coarser one.
TEST(ObservedSpace, agrees_with_points_for_random_boxes) {
  std::mt19937 random(5);
  const auto box = [&](Vector3& low, Vector3& high) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      const int a = static_cast<int>(random() % 6), b = static_cast<int>(random() % 6);
      low[k] = std::min(a, b);
      high[k] = std::max(a, b) + 1;
    }
  };
  int inside = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    std::vector<SourceView> views(1 + random() % 8);
    for (SourceView& v : views) {
      v = view(Vector3::Zero(), Vector3::Zero());
      box(v.low, v.high);
    }
    Box query;
    box(query.low, query.high);
    bool expected = true;
    for (double x = query.low.x() + 0.5; x < query.high.x(); ++x)
      for (double y = query.low.y() + 0.5; y < query.high.y(); ++y)
        for (double z = query.low.z() + 0.5; z < query.high.z(); ++z)
          expected = expected && std::any_of(views.begin(), views.end(), [&](const SourceView& v) {
                       const Eigen::Array3d p(x, y, z);
                       return (p > v.low.array()).all() && (p < v.high.array()).all();
                     });
    ASSERT_EQ(space(views).contains(query, 0), expected) << trial;
    inside += expected;
  }
  EXPECT_GT(inside, 300);
}

}  // namespace
}  // namespace handsel::trajectory_controller::observed_space_test
