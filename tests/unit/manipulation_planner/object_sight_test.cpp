// SPDX-License-Identifier: Apache-2.0
// An object that is moved or lost before it is picked up.
#include <gmock/gmock.h>

#include "tests/unit/manipulation_planner/manipulation_rig.hpp"

namespace handsel::manipulation_planner::object_sight_test {
namespace {

using rig::Rig;
using testing::HasSubstr;

std::string phase(Rig& rig) { return phase_text(rig.planner.status()); }

TEST(ObjectSight, an_object_that_moves_during_the_approach_is_approached_anew) {
  Rig rig;
  rig.moves = true;
  rig.start(ActionKind::pick);
  rig.run_until("approach");
  for (int i = 0; i < 5; ++i) rig.cycle();
  ASSERT_EQ(rig.execution.motion, MotionState::running);
  rig.scene.objects[0].T_world_object.translation() += Vector3(0, 0.3, 0);
  for (int i = 0; i < 3; ++i) rig.cycle();
  EXPECT_NE(phase(rig), "reaching the object");
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
  EXPECT_EQ(std::count(rig.phases.begin(), rig.phases.end(), "reaching the object"), 1);
  const auto& refusals = rig.planner.status().refusals;
  EXPECT_TRUE(std::any_of(refusals.begin(), refusals.end(), [](const Refusal& r) {
    return r.reason.find("mug was moved away") != std::string::npos;
  }));
}

TEST(ObjectSight, what_has_not_been_seen_for_a_while_is_searched_for_first) {
  Rig rig;
  rig.scene.objects[0].age = 2;
  rig.start(ActionKind::pick);
  for (int i = 0; i < 100; ++i) rig.cycle();
  EXPECT_EQ(phase(rig), "looking for the object");
  EXPECT_TRUE(rig.phases.empty()) << "the arm rests";
  rig.scene.objects[0].age = 0;
  rig.run(30);
  EXPECT_EQ(rig.planner.status().state, ActionState::succeeded) << rig.planner.status().reason;
}

TEST(ObjectSight, what_is_not_found_is_given_up_with_where_it_was_last_seen) {
  Rig rig;
  rig.scene.objects[0].age = 7;
  rig.start(ActionKind::pick);
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_THAT(rig.planner.status().reason,
              HasSubstr("mug was last seen 7 s ago at (0.70, -0.60, 0.75)"));
  EXPECT_EQ(rig.planner.status().failure, ActionFailure::not_visible);
}

TEST(ObjectSight, the_arm_waits_while_a_person_has_the_object) {
  Rig rig;
  rig.scene.objects[0].holder = Holder::human;
  rig.scene.objects[0].holder_id = "anna";
  rig.start(ActionKind::pick);
  for (int i = 0; i < 100; ++i) rig.cycle();
  EXPECT_TRUE(rig.phases.empty());
  rig.run(60);
  EXPECT_EQ(rig.planner.status().state, ActionState::failed);
  EXPECT_THAT(rig.planner.status().reason, HasSubstr("anna has mug"));
}

}  // namespace
}  // namespace handsel::manipulation_planner::object_sight_test
