// SPDX-License-Identifier: Apache-2.0
// A receiver holds a hand beside the planned offer: the exchange point follows the hand by the
// attentional shift, during the motion and while the robot waits. The whole system in lock-step,
// and again with a manipulation planner that ignores the shift.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "common/messages/names.hpp"
#include "common/model/human/body_index.hpp"
#include "components/path_planner/search/random.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "tests/support/processes/edited_settings.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::exchange_shift_test {
namespace {

constexpr const char* kScenario = R"(name: "exchange_shift" robot: "jido"
boxes { id: "table" pose { xyz { x: 0.85 y: -0.62 z: 0.36 } } size { x: 0.7 y: 0.7 z: 0.72 }
    supports: true }
objects { id: "mug" model: "mug" on: "table" pose { xyz { x: 0.68 y: -0.42 } } }
people { id: "anna" x: 1.4 y: -0.05 yaw: 3.1416 stature: 1.72 behaviour: EXTERNAL
    external: "body_tracker" }
object_sensors { source: "object_tracker" rate: 30 latency: 0.04 noise: 0.001 }
timeout: 90
)";
constexpr double kMaxShift = 0.15;  // max shift, as shipped [m]

/// A person whose right wrist is held anywhere.
std::vector<BodyJoint> holding_out(const Vector3& p_wrist) {
  std::vector<BodyJoint> joints = standing_body({1.4, -0.05, 0}, M_PI, 1.72);
  const auto at = [&](int joint) -> Vector3& {
    return joints[static_cast<std::size_t>(joint)].position;
  };
  const Vector3 shoulder = at(body::r_shoulder);
  const double upper = (at(body::r_elbow) - shoulder).norm(),
               fore = (at(body::r_wrist) - at(body::r_elbow)).norm(),
               palm = (at(body::r_hand) - at(body::r_wrist)).norm();
  Vector3 along = p_wrist - shoulder;
  along *= std::min(1.0, 0.98 * (upper + fore) / along.norm());
  const double d = along.norm(), a = (upper * upper - fore * fore + d * d) / (2 * d);
  const Vector3 down = Vector3(0, 0, -1) + along * along.z() / along.squaredNorm();
  at(body::r_elbow) = shoulder + along / d * a +
                      down.normalized() * std::sqrt(std::max(0.0, upper * upper - a * a));
  at(body::r_wrist) = shoulder + along;
  at(body::r_hand) =
      at(body::r_wrist) + palm * (at(body::r_wrist) - at(body::r_elbow)).normalized();
  return joints;
}

/// When the hand is held out beside the planned wrist.
enum class HeldOut { on_the_way, while_waiting };

struct Handover {
  bool offered{};
  double from_wrist{};  ///< the exchange point from the wrist held out, at the end [m]
  Vector3 p_offered{Vector3::Zero()};  ///< the exchange point at the end, world [m]
  double moved{};                      ///< the exchange point while the robot waited [m]
  double from_object{};                ///< the object at the end from the exchange point [m]
  bool held{};                         ///< the robot holds the object at the end
  std::uint64_t violations{};          ///< of limits and separation, and collisions
  std::string ended;                   ///< how and why, if the object was not offered
};

/// Gives the mug to a person who extends a hand from the beginning, or beside the waiting robot.
Handover give(HeldOut when, const std::filesystem::path& settings) {
  // Noise: a source that repeats a sample counts as blind.
  path_planner::Random random(7);
  const auto noise = [&random] {
    return Vector3(0.002 * Vector3(random.normal(), random.normal(), random.normal()));
  };
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "exchange_shift.txtpb").string();
  std::ofstream(file) << kScenario;
  LockstepSystem system(system_context(file, "", 3, settings));
  Bus& seat = system.bus();
  auto goals = seat.advertise<TaskGoal>();
  auto body_out = seat.advertise<HumanObservation>();
  Handover out;
  ActionStatus action;
  Scene scene;
  const Vector3 p_raised(1.05, 0.15, 0.95), p_hanging(1.4, 0.2, 0.85);
  Vector3 p_wrist = when == HeldOut::on_the_way ? p_raised : p_hanging;
  Vector3 p_held_out = p_wrist, p_first = Vector3::Zero();
  bool is_held_out = when == HeldOut::on_the_way;
  double offered_for = 0;
  seat.subscribe<Scene>([&](const Scene& s, const Receipt&) { scene = s; });
  seat.subscribe<ActionStatus>([&](const ActionStatus& s, const Receipt&) {
    action = s;
    if (s.phase != ActionPhase::offer || is_held_out || !s.has_partner) return;
    is_held_out = true;
    p_first = s.exchange_point;
    p_held_out = s.T_world_partner_wrist.translation() + Vector3(0.1, 0.22, 0.0);
  });
  seat.every(from_seconds(1.0 / 30), [&](TimePoint) {
    constexpr double kStep = 0.8 / 30;  // motion of the wrist per sample [m]
    const Vector3 left = p_held_out - p_wrist;
    if (left.norm() > 1e-6) p_wrist += std::min(1.0, kStep / left.norm()) * left;
    if (action.phase == ActionPhase::offer) offered_for += 1.0 / 30;
    HumanObservation seen;
    seen.source = "body_tracker";
    seen.coverage = {{-2, -3, 0}, {4, 3, 2.5}};
    ObservedPerson person;
    person.body = "anna";
    for (const BodyJoint& joint : holding_out(p_wrist))
      person.joints.push_back({joint.name, joint.position + noise(), 1.0});
    person.has_gaze = true;
    person.gaze_origin = person.joints.front().position;
    person.gaze_direction = Vector3(-1, 0, -0.2).normalized();
    seen.people.push_back(person);
    body_out->publish(seen);
  });
  seat.after(from_seconds(3.0), [&](TimePoint) {
    goals->publish({.id = 1, .kind = TaskKind::give, .object = "mug"});
  });
  constexpr double kWaits = 6.0;  // duration of the offer [s]
  system.network().run_until([&] { return offered_for > kWaits; }, TimePoint(from_seconds(60)));
  out.offered = action.phase == ActionPhase::offer;
  out.from_wrist = (action.exchange_point - p_held_out).norm();
  out.p_offered = action.exchange_point;
  out.moved = when == HeldOut::on_the_way ? 0.0 : (action.exchange_point - p_first).norm();
  for (const SceneObject& object : scene.objects) {
    out.from_object = (object.T_world_object.translation() - action.exchange_point).norm();
    out.held = object.holder == Holder::robot;
  }
  const auto& tasks = system.snapshot().tasks;
  out.ended = phase_text(action) + ": " + (tasks.count(1) != 0 ? tasks.at(1).reason : "no task");
  for (const auto& refusal : action.refusals)
    out.ended += "; " + refusal.what + ": " + refusal.reason;
  const GroundTruth& truth = system.snapshot().ground_truth.sample;
  out.violations = truth.limit_violations + truth.ssm_violations + truth.self_or_scene_collisions;
  std::printf("offered %d at %.2f %.2f %.2f, %.3f m from the wrist, moved %.3f m; %s\n",
              out.offered, out.p_offered.x(), out.p_offered.y(), out.p_offered.z(), out.from_wrist,
              out.moved, out.ended.c_str());
  std::fflush(stdout);
  return out;
}

void expect_sound(const Handover& run) {
  EXPECT_TRUE(run.offered) << run.ended;
  EXPECT_TRUE(run.held) << "the hand lost the object";
  EXPECT_LT(run.from_object, 0.03) << "the object is not offered where the planner reports";
  EXPECT_EQ(run.violations, 0u);
}

class ExchangeShift : public testing::TestWithParam<HeldOut> {};

TEST_P(ExchangeShift, follows_the_hand_that_the_receiver_holds_out) {
  test::EditedSettings unread;
  unread.set("manipulation_planner.txtpb", "max_shift", "0");
  const Handover with = give(GetParam(), {}), without = give(GetParam(), unread.folder());
  expect_sound(with);
  expect_sound(without);
  EXPECT_LT(with.from_wrist, without.from_wrist - 0.06)
      << "the planner that reads no shift follows as well";
  EXPECT_EQ(without.moved, 0) << "the planner that reads no shift moves what it offers";
  EXPECT_GT((with.p_offered - without.p_offered).norm(), 0.06);
  EXPECT_LT(with.moved, kMaxShift + 0.02);
}

INSTANTIATE_TEST_SUITE_P(People, ExchangeShift,
                         testing::Values(HeldOut::on_the_way, HeldOut::while_waiting));

}  // namespace
}  // namespace handsel::exchange_shift_test
