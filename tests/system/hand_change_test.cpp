// SPDX-License-Identifier: Apache-2.0
// The receiver waits with a raised hand and changes to the other hand while the arm carries the
// object: exchange point and wrist follow the new hand, which takes the object. The whole system in
// lock-step.
#include <gtest/gtest.h>

#include <fstream>

#include "common/messages/names.hpp"
#include "common/model/human/human_body.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::hand_change_test {
namespace {

constexpr const char* kScenario = R"(name: "hand_change" robot: "jido"
boxes {
  id: "table" pose { xyz { x: 0.85 y: -0.62 z: 0.36 } } size { x: 0.7 y: 0.7 z: 0.72 }
    supports: true
}
objects { id: "mug" model: "mug" on: "table" pose { xyz { x: 0.68 y: -0.42 } } }
people {
  id: "anna" x: 1.4 y: -0.05 yaw: 3.1416 stature: 1.72 behaviour: TAKER
  varies { readies: 1 changes_hand: 1 from_carry: true begins_after: 1.5 begins_before: 1.5 }
}
human_sensors { source: "kinect" rate: 30 latency: 0.04 noise: 0.004 }
object_sensors { source: "object_tracker" rate: 30 latency: 0.04 noise: 0.001 }
timeout: 90
)";

TEST(HandChange, who_changes_hands_is_given_the_object_for_the_new_hand) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "hand_change.txtpb").string();
  std::ofstream(file) << kScenario;
  LockstepSystem system(system_context(file, "", 1));
  Bus& seat = system.bus();
  auto goals = seat.advertise<TaskGoal>();
  ActionStatus first, last;  // of the carrying: at its start, and at the offer
  bool is_carrying = false;
  GroundTruth truth;
  HumanState people;
  seat.subscribe<GroundTruth>([&](const GroundTruth& t, const Receipt&) { truth = t; });
  seat.subscribe<HumanState>([&](const HumanState& s, const Receipt&) { people = s; });
  seat.subscribe<ActionStatus>([&](const ActionStatus& s, const Receipt&) {
    if (s.phase == ActionPhase::carry && s.has_partner && !is_carrying) {
      first = s;
      is_carrying = true;
    }
    if (s.phase == ActionPhase::offer) last = s;
  });
  seat.after(from_seconds(3.0), [&](TimePoint) {
    goals->publish({.id = 1, .kind = TaskKind::give, .object = "mug"});
  });
  const auto ended = [&] {
    const auto& tasks = system.snapshot().tasks;
    return tasks.count(1) != 0 &&
           (tasks.at(1).state == TaskState::failed || tasks.at(1).state == TaskState::succeeded);
  };
  system.network().run_until(ended, TimePoint(from_seconds(80)));
  const auto& tasks = system.snapshot().tasks;
  ASSERT_TRUE(ended());
  EXPECT_EQ(tasks.at(1).state, TaskState::succeeded) << tasks.at(1).reason;
  ASSERT_TRUE(is_carrying) << "no grasp of the person was planned for";
  EXPECT_EQ(first.partner_side, Side::right);
  ASSERT_TRUE(last.has_partner);
  EXPECT_EQ(last.partner_side, Side::left) << "the plan is still for the hand that was lowered";
  EXPECT_LE(last.partner_strain, 1.0);
  // The person faces -x: the left hand is at -y.
  EXPECT_LT(last.exchange_point.y(), first.exchange_point.y() - 0.08)
      << "the point did not follow the hand";
  EXPECT_TRUE(truth.taken);
  EXPECT_EQ(truth.taking_side, Side::left);
  EXPECT_LT(truth.taking_wrist_strain, 1.0);
  std::printf("planned wrist strain %.2f, measured: wrist %.2f, arm %.2f; point led %.2f m aside\n",
              last.partner_strain, truth.taking_wrist_strain, truth.taking_arm_strain,
              first.exchange_point.y() - last.exchange_point.y());
}

}  // namespace
}  // namespace handsel::hand_change_test
