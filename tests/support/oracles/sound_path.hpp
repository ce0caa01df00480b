// SPDX-License-Identifier: Apache-2.0
// Checks whether a path solves its problem.
#pragma once

#include <gtest/gtest.h>

#include "common/collision/collision_world.hpp"
#include "components/path_planner/problem.hpp"

namespace handsel::test {

/// From the start to the goal it names, and free at every 2 mrad; for problems of all axes of the
/// robot.
inline void expect_sound(const path_planner::Result& result, const path_planner::Problem& problem,
                         CollisionWorld& world) {
  ASSERT_TRUE(result.solved) << result.reason;
  ASSERT_GE(result.path.size(), 2u);
  EXPECT_EQ(result.path.front(), problem.start);
  EXPECT_EQ(result.path.back(), problem.goals[result.goal]);
  for (std::size_t i = 1; i < result.path.size(); ++i)
    EXPECT_TRUE(world.check_motion(result.path[i - 1], result.path[i], 0.002).free);
}

}  // namespace handsel::test
