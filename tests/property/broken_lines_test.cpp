// Random broken lines of Jido's arm among random boxes: never longer than with a stop at each node, inside the limits, and free of contact
// at every millimetre. States the spheres around the links clear are taken for free, the rest is FCL's; every kAlone-th line is FCL's
// alone. HANDSEL_RUNS: how many lines (20).
#include <cmath>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/segment_table.hpp"
#include "components/trajectory_planner/trajectory_planner.hpp"

namespace handsel::trajectory_planner {
namespace {

constexpr unsigned kSeed = 44;
constexpr int kAlone = 100;
constexpr double kReach = 1.6;     // no point of arm and hand is farther from an axis [m]
constexpr double kMost = 0.001;    // a point of the robot moves between two states [m]
constexpr double kLegStep = 2e-4;  // of the path planner's last check [rad]

TEST(BrokenLines, are_smoothed_to_motion_that_is_faster_inside_the_limits_and_free) {
  const char* asked = std::getenv("HANDSEL_RUNS");
  const int runs = asked != nullptr ? std::max(1, std::atoi(asked)) : 20;
  const RobotModel robot = RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  const Group& arm = robot.require_group("arm");
  CollisionWorld planning(robot, nullptr), wide(robot, nullptr), exact(robot, nullptr);
  wide.set_moving_axes(arm.axes);
  const HumanCost nobody(robot, {});
  std::mt19937 random(kSeed);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  int corners = 0, stops = 0, collided = 0;
  double time = 0, with_stops = 0;
  std::size_t states = 0;
  for (int run = 0; run < runs;) {
    Scene scene;
    for (int i = 0; i < 6; ++i)
      scene.boxes.push_back({"box " + std::to_string(i),
                             make_pose({between(0.4, 1.1), between(-0.9, 0.6), between(0.4, 1.6)}),
                             {between(0.03, 0.3), between(0.03, 0.3), between(0.03, 0.3)},
                             false});
    for (CollisionWorld* world : {&planning, &wide, &exact}) world->set_scene(scene);
    TrajectoryRequest request;
    request.id = {1, static_cast<std::uint64_t>(run)};
    request.group = "arm";
    request.start = robot.rest_posture();
    if (!wide.is_free(request.start)) continue;
    Vector at = request.start;
    request.nodes = {RobotModel::part(at, arm)};
    const int nodes = 3 + static_cast<int>(random() % 8);
    for (int tries = 0; tries < 40 && static_cast<int>(request.nodes.size()) < nodes; ++tries) {
      Vector next = at;
      for (const int axis : arm.axes)
        next[axis] = std::clamp(at[axis] + between(-0.7, 0.7), robot.axes()[static_cast<std::size_t>(axis)].lower,
                                robot.axes()[static_cast<std::size_t>(axis)].upper);
      if (!wide.check_motion(at, next, kLegStep).free) continue;
      at = next;
      request.nodes.push_back(RobotModel::part(at, arm));
    }
    if (request.nodes.size() < 3) continue;
    ++run;
    const Result result = plan(robot, planning, nobody, {}, request, {});
    ASSERT_TRUE(result.reply.solved) << "line " << run << ": " << result.reply.reason;
    const Trajectory& found = result.reply.trajectory;
    EXPECT_LE(found.duration(), result.reply.duration_ptp + 1e-9) << "line " << run;
    KinematicLimits limits = robot.comfort_limits();
    limits = {RobotModel::part(limits.velocity, arm), RobotModel::part(limits.acceleration, arm), RobotModel::part(limits.jerk, arm)};
    EXPECT_EQ(why_not_within(found, limits, 0.1 + 1e-9), "") << "line " << run;
    for (int i = 0; i < found.size(); ++i) {
      const AxisExtremes e = extremes(found.axes[i]);
      const Axis& axis = robot.axes()[static_cast<std::size_t>(arm.axes[i])];
      EXPECT_GE(e.lowest, axis.lower - 1e-9) << "line " << run;
      EXPECT_LE(e.highest, axis.upper + 1e-9) << "line " << run;
    }
    corners += static_cast<int>(request.nodes.size()) - 2;
    stops += static_cast<int>(result.reply.corners.size());
    for (const Refusal& refusal : result.reply.corners) collided += refusal.reason.find("collides") != std::string::npos;
    time += found.duration();
    with_stops += result.reply.duration_ptp;
    const SegmentTable table(found);
    MotionState3 state = found.at(0);
    int cursor = 0;
    CollisionWorld& judge = run % kAlone == 0 ? exact : wide;
    for (double t = 0; t <= table.duration();) {
      table.evaluate(t, cursor, state);
      ++states;
      const CollisionVerdict verdict = judge.is_free(RobotModel::with(request.start, arm, state.position))
                                           ? CollisionVerdict{}
                                           : judge.check(RobotModel::with(request.start, arm, state.position));
      ASSERT_TRUE(verdict.free) << "line " << run << " at " << t << " s: " << verdict.first << " touches " << verdict.second;
      const double speed = kReach * state.velocity.cwiseAbs().sum();
      t += std::clamp(kMost / std::max(speed, 1e-3), 2e-4, 0.02);
    }
  }
  std::printf("seed %u: %d lines, %d corners, %d keep their stop (%d of them would collide); %.0f s instead of %.0f s; %zu states free\n",
              kSeed, runs, corners, stops, collided, time, with_stops, states);
  EXPECT_GT(collided, runs / 10);
  EXPECT_LT(time, with_stops);
}

}  // namespace
}  // namespace handsel::trajectory_planner
