// SPDX-License-Identifier: Apache-2.0
// The receiver steps aside while the object is carried to them: time until a trajectory leads from
// the running motion to the new exchange point (search of the point, path, jerk-limited trajectory
// and the junction), against a stop and new planning. Jido; one process, alternating; thread time.
// Usage: bench_retarget [cases]
#include <cstdio>
#include <cstdlib>
#include <random>

#include "common/config/located.hpp"
#include "common/config/resources.hpp"
#include "common/model/object_model.hpp"
#include "common/trajectory/switch.hpp"
#include "components/manipulation_planner/handover/otp_search.hpp"
#include "components/path_planner/live_path.hpp"
#include "components/trajectory_planner/trajectory_planner.hpp"
#include "tests/support/person_grasps.hpp"
#include "tests/support/processes/thread_times.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel {
namespace {

using test::seconds;
using test::Times;

constexpr unsigned kSeed = 21;
constexpr std::uint64_t kBudget = 10000;  // max checks of a replanning request, as shipped
constexpr double kUnderWay = 0.4;  // fraction of the carrying motion's duration at the switch

int run(int cases) {
  const RobotModel robot = RobotModel::load(robot_description("jido"));
  const Group& arm = robot.require_group("arm");
  const ObjectModel mug = ObjectModel::load(object_description("mug"));
  const auto settings =
      settings::read_manipulation_planner_settings(resource("config/manipulation_planner.txtpb"));
  CollisionWorld world(robot,
                       [&mug](const std::string& name) { return name == "mug" ? &mug : nullptr; });
  HumanCost cost(robot, {});
  Scene scene;
  scene.robot_known = true;
  scene.robot_position = robot.rest_configuration();
  scene.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
  Attachment attachment;
  attachment.object = "mug";
  attachment.T_tool_object = make_pose({0.08, 0.02, 0.23});
  scene.objects.push_back({"mug", "mug", make_pose({0.7, 0, 1.2}), Holder::robot, "jido", 0});
  world.set_scene(scene);
  world.set_attachment(attachment, {});
  const auto put = [&](const HumanState& people) {
    world.set_people(people);
    cost.set_people(people);
  };
  const auto tool_at = [&](const Vector& q) {
    return Pose(robot.link_pose(q, robot.tool_link()) * attachment.T_tool_object);
  };
  const auto choose_with = [&](const HumanState& people, const Vector& q,
                               const std::vector<PartnerGrasp>& partners) {
    const Pose T_world_object = tool_at(q);
    const Vector3 back = -Vector3::UnitZ();
    const manipulation_planner::OtpQuery query{
        scene, people.people[0], {}, T_world_object, attachment.T_tool_object, {}, partners, {},
        back};
    return manipulation_planner::find_otp(robot, robot.require_group("arm"), query, q, settings);
  };
  const auto choose = [&](const HumanState& people, const Vector& q) {
    return choose_with(people, q, {});
  };
  const std::vector<PartnerGrasp> partners = test::grasps_of_both_hands();
  const auto smooth = [&](const HumanState& people, const std::vector<Vector>& nodes,
                          const Vector& start) {
    TrajectoryRequest request;
    request.group = "arm";
    request.nodes = nodes;
    request.start = start;
    request.attachment = attachment;
    return trajectory_planner::plan(robot, world, cost, {people, scene.T_world_base}, request, {})
        .reply;
  };

  std::mt19937 engine(kSeed);
  std::uniform_real_distribution<double> unit(0, 1);
  Times point, pairs, path, motion, join, whole, anew;
  int tried = 0, led = 0, led_anew = 0;
  for (int k = 0; k < cases; ++k) {
    const Vector3 feet{1.35 + 0.3 * unit(engine), -0.4 + 0.8 * unit(engine), 0};
    const double direction = 6.283185307179586 * unit(engine), step = 0.15 + 0.25 * unit(engine);
    const HumanState before = test::person_at(feet),
                     after = test::person_at(
                         feet + step * Vector3{std::cos(direction), std::sin(direction), 0});
    const Vector rest = robot.rest_configuration();
    put(before);
    path_planner::Problem problem;
    problem.axes = arm.axes;
    problem.seed = kSeed + static_cast<unsigned>(k);
    problem.start = rest;
    for (const auto& pose : choose(before, rest).poses) problem.goals.push_back(pose.arm_joints);
    if (problem.goals.empty()) continue;
    const path_planner::Result first = path_planner::plan(robot, world, cost, problem, {});
    if (!first.solved) continue;
    const TrajectoryReply running = smooth(before, first.path, rest);
    if (!running.solved) continue;
    const MotionState3 now = running.trajectory.at(kUnderWay * running.trajectory.duration());
    problem.start = RobotModel::with(rest, arm, now.position);
    problem.budget = kBudget;
    ++tried;

    manipulation_planner::OtpSearch search;
    path_planner::ReplanResult live;
    TrajectoryReply soft;
    bool joined = false;
    const auto goals_of_search = [&] {
      problem.goals.clear();
      for (const auto& pose : search.poses) problem.goals.push_back(pose.arm_joints);
    };
    const double t_point = seconds([&] {
      put(after);
      search = choose(after, problem.start);
    });
    pairs.add(seconds([&] { choose_with(after, problem.start, partners); }));
    goals_of_search();
    if (!problem.goals.empty()) {
      const double t_path = seconds([&] {
        live = path_planner::continue_path({robot, world, cost}, problem, first.path, {}, {});
      });
      const double t_motion = seconds([&] {
        if (live.result.solved) soft = smooth(after, live.result.path, problem.start);
      });
      const double t_join = seconds([&] {
        if (!soft.solved) return;
        KinematicLimits limits = robot.comfort_limits();
        for (Vector* part : {&limits.velocity, &limits.acceleration, &limits.jerk})
          *part = 1.1 * RobotModel::part(*part, arm);
        joined = switch_to(now, soft.trajectory, limits).ok();
      });
      led += joined;
      point.add(t_point), path.add(t_path), motion.add(t_motion), join.add(t_join);
      whole.add(t_point + t_path + t_motion + t_join);
    }
    bool reached = false;
    const double t_anew = seconds([&] {
      put(after);
      search = choose(after, problem.start);
      goals_of_search();
      if (problem.goals.empty()) return;
      const path_planner::Result again = path_planner::plan(robot, world, cost, problem, {});
      reached = again.solved && smooth(after, again.path, problem.start).solved;
    });
    led_anew += reached;
    anew.add(t_anew);
  }
  std::printf("seed %u, %d cases: led to the new point %d, from rest %d\n", kSeed, tried, led,
              led_anew);
  point.print("exchange point");
  pairs.print("point, both hands");
  path.print("path");
  motion.print("soft motion");
  join.print("joining what runs");
  whole.print("retarget while moving");
  anew.print("planned anew from rest");
  std::printf(
      "ratio to planned anew, exchange point with the grasps of both hands: median %.3f, p99 "
      "%.3f\n",
      pairs.at(0.5) / anew.at(0.5), pairs.at(0.99) / anew.at(0.99));
  std::printf("ratio of medians, planned anew / retarget: %.2f\n", anew.at(0.5) / whole.at(0.5));
  return 0;
}

}  // namespace
}  // namespace handsel

int main(int argc, char** argv) { return handsel::run(argc > 1 ? std::atoi(argv[1]) : 200); }
