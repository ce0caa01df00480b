// SPDX-License-Identifier: Apache-2.0
// The receiver steps aside while the arm carries the object to them: the running path is redirected
// to another exchange point without a stop. The whole system in lock-step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "common/cost/human_cost.hpp"
#include "common/messages/names.hpp"
#include "common/model/human/human_body.hpp"
#include "components/path_planner/search/random.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::exchange_moves_test {
namespace {

constexpr const char* kScenario = R"(name: "exchange_moves" robot: "jido"
boxes { id: "table" pose { xyz { x: 0.85 y: -0.62 z: 0.36 } } size { x: 0.7 y: 0.7 z: 0.72 }
    supports: true }
objects { id: "mug" model: "mug" on: "table" pose { xyz { x: 0.68 y: -0.42 } } jitter: 0.03 }
people { id: "anna" x: 1.4 y: -0.05 yaw: 3.1416 stature: 1.72 behaviour: EXTERNAL
    external: "body_tracker" }
object_sensors { source: "object_tracker" rate: 30 latency: 0.04 noise: 0.001 }
timeout: 90
)";
constexpr double kSideSpeed = 0.8;  // speed of the person [m/s]
// Max distance of a person's wrist from the middle of the mug in any grasp [m].
constexpr double kMaxWrist = 0.22;

struct Carried {
  bool offered{};
  std::string ended;        ///< how and why, if it was not offered
  double moved{};           ///< distance from the point of the first path to the person [m]
  int switches{};           ///< commands that replace a running one
  double standing{};        ///< max time of the arm at rest after the person's step [s]
  double aside{};           ///< lateral distance of the offered point from the person's middle [m]
  bool reached{};           ///< the point lies within their reach
  bool has_partner{};       ///< the offer is planned for a grasp of the person
  double partner_strain{};  ///< of the person's wrist and arm there
  double partner_distance{};  ///< of their wrist from the offered point [m]
};

/// The person goes `step` [m] aside (+y) `after` [s] on the first path to them.
Carried carry(std::uint64_t seed, double step, double after, const std::string& folder) {
  const std::string file = folder + "/exchange_moves.txtpb";
  std::ofstream(file) << kScenario;
  LockstepSystem system(system_context(file, "", seed));
  Bus& seat = system.bus();
  auto goals = seat.advertise<TaskGoal>();
  auto body_out = seat.advertise<HumanObservation>();
  Carried out;
  ActionStatus action;
  HumanState people;
  ActiveTrajectory active;
  path_planner::Random random(seed);
  const auto noise = [&random] {
    return Vector3(0.003 * Vector3(random.normal(), random.normal(), random.normal()));
  };
  double walked = 0, carrying = 0,
         still = 0;  // carrying: time since the start of the first path to the person [s]
  std::uint64_t first_path = 0;
  Vector3 first_point = Vector3::Zero();
  const auto body = [&] {
    return standing_body({1.4, -0.05 + walked, 0}, M_PI - 0.5 * walked, 1.72);
  };
  seat.subscribe<HumanState>([&](const HumanState& s, const Receipt&) { people = s; });
  seat.subscribe<ActionStatus>([&](const ActionStatus& s, const Receipt&) { action = s; });
  seat.subscribe<ActiveTrajectory>([&](const ActiveTrajectory& a, const Receipt&) { active = a; });
  seat.subscribe<TrajectoryCommand>([&](const TrajectoryCommand& c, const Receipt&) {
    if (action.phase != ActionPhase::carry || c.axes.empty()) return;
    if (first_path != 0) {
      out.switches += c.switch_at > 0;
      return;
    }
    first_path = c.id;
    first_point = action.exchange_point;
  });
  seat.every(from_seconds(0.01), [&](TimePoint) {
    if (action.phase != ActionPhase::carry || active.trajectory == 0) return;
    if (first_path != 0 && active.trajectory >= first_path) carrying += 0.01;
    const bool on_way = active.time > 0.2 && active.time < active.rest.duration() - 0.3;
    still = on_way && active.velocity.norm() < 1e-3 ? still + 0.01 : 0;
    out.standing = std::max(out.standing, still);
  });
  seat.every(from_seconds(1.0 / 30), [&](TimePoint) {
    if (carrying > after) walked = std::min(step, walked + kSideSpeed / 30);
    HumanObservation seen;
    seen.source = "body_tracker";
    seen.coverage = {{-2, -3, 0}, {4, 3, 2.5}};
    ObservedPerson person;
    person.body = "anna";
    for (const BodyJoint& joint : body())
      person.joints.push_back({joint.name, joint.position + noise(), 1.0});
    person.has_gaze = true;
    person.gaze_origin = person.joints.front().position;
    person.gaze_direction = Vector3(-1, -0.2 * walked, -0.2).normalized();
    seen.people.push_back(person);
    body_out->publish(seen);
  });
  seat.after(from_seconds(3.0), [&](TimePoint) {
    goals->publish({.id = 1, .kind = TaskKind::give, .object = "mug"});
  });
  const auto ended = [&] {
    const auto& tasks = system.snapshot().tasks;
    return action.phase == ActionPhase::offer ||
           (tasks.count(1) != 0 && tasks.at(1).state == TaskState::failed);
  };
  system.network().run_until(ended, TimePoint(from_seconds(80)));
  out.offered = action.phase == ActionPhase::offer;
  out.moved = (action.exchange_point - first_point).norm();
  const auto& tasks = system.snapshot().tasks;
  if (!out.offered)
    out.ended = phase_text(action) + ": " + (tasks.count(1) != 0 ? tasks.at(1).reason : "no task");
  out.reached = people.people.size() == 1 && within_reach(people.people[0], action.exchange_point);
  out.aside = std::abs(action.exchange_point.y() -
                       body()[static_cast<std::size_t>(body_joint_index("torso"))].position.y());
  out.has_partner = action.has_partner;
  out.partner_strain = action.partner_strain;
  out.partner_distance =
      (action.T_world_partner_wrist.translation() - action.exchange_point).norm();
  return out;
}

/// Min motion of the exchange point when the person walks by 0.5 m [m]. In nine seeds the point
/// moved by 0.11 to 0.21 m; the arm of the person covers the rest.
constexpr double kMinMoved = 0.1;

TEST(ExchangeMoves, the_running_path_leads_to_another_exchange_point_without_a_stop) {
  const test::TemporaryFolder folder;
  const char* text = std::getenv("HANDSEL_RUNS");
  const int runs = text == nullptr ? 3 : std::atoi(text);
  int led_over = 0, reached = 0, planned_for_hand = 0;
  for (int k = 0; k < runs; ++k) {
    const auto seed = static_cast<std::uint64_t>(k + 1);
    const Carried run = carry(seed, 0.5, 0.0, folder.path().string());
    std::printf(
        "seed %d: offered %d %s, led %.2f m on, switches %d, stood for %.2f s, offered %.2f m "
        "aside, reached %d\n",
        k + 1, run.offered, run.ended.c_str(), run.moved, run.switches, run.standing, run.aside,
        run.reached);
    EXPECT_TRUE(run.offered) << run.ended;
    std::printf("  wrist of the person: planned %d, strain %.2f, %.2f m from the point\n",
                run.has_partner, run.partner_strain, run.partner_distance);
    EXPECT_LE(run.partner_strain, 1.0);
    if (run.has_partner) {
      EXPECT_LT(run.partner_distance, kMaxWrist) << "the wrist did not follow the exchange point";
    }
    planned_for_hand += run.has_partner;
    reached += run.reached;
    led_over += run.moved > kMinMoved && run.switches > 0 && run.standing < 0.05;
  }
  EXPECT_GE(planned_for_hand, runs * 2 / 3)
      << "no grasp of the person was chosen with that of the robot";
  EXPECT_GE(reached, runs * 2 / 3)
      << "what is offered is out of the person's reach where they are now";
  EXPECT_GE(led_over, runs * 2 / 3) << "the arm stopped, or went on to where the person was";
}

}  // namespace
}  // namespace handsel::exchange_moves_test
