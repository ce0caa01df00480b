// SPDX-License-Identifier: Apache-2.0
// Random polylines of Jido's arm among random boxes: never slower than with a stop at each
// waypoint, inside the limits, and free of contact at every millimetre. Spheres around the links
// prove most states free, FCL checks the rest; FCL alone checks every kAlone-th line. HANDSEL_RUNS:
// number of lines (20); HANDSEL_FIRST: the first line that is checked (1).
#include <cmath>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/path/segment_table.hpp"
#include "components/trajectory_planner/trajectory_planner.hpp"
#include "tests/support/broken_lines.hpp"

namespace handsel::trajectory_planner::broken_lines_test {
namespace {

constexpr unsigned kSeed = 44;
constexpr int kAlone = 100;
constexpr double kReach = 1.6;  // max distance of a point of arm and hand from an axis [m]
constexpr double kMaxPointMotion = 0.001;  // motion of a point between two states [m]

TEST(BrokenLines, are_smoothed_to_motion_that_is_faster_inside_the_limits_and_free) {
  const char* asked = std::getenv("HANDSEL_RUNS");
  const int runs = asked != nullptr ? std::max(1, std::atoi(asked)) : 20;
  const char* from = std::getenv("HANDSEL_FIRST");
  const int first = from != nullptr ? std::atoi(from) : 1;
  const RobotModel robot =
      RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
  const Group& arm = robot.require_group("arm");
  CollisionWorld planning(robot, nullptr), wide(robot, nullptr), exact(robot, nullptr);
  wide.set_moving_axes(arm.axes);
  const HumanCost nobody(robot, {});
  std::mt19937 random(kSeed);
  int corners = 0, stops = 0, collided = 0;
  double time = 0, with_stops = 0;
  std::size_t states = 0;
  for (int run = 1; run <= runs; ++run) {
    const test::BrokenLine line = test::broken_line(robot, wide, 3, 10, random);
    if (run < first) continue;
    for (CollisionWorld* world : {&planning, &exact}) world->set_scene(line.scene);
    const TrajectoryRequest& request = line.request;
    const Result result = plan(robot, planning, nobody, {}, request, {});
    ASSERT_TRUE(result.reply.solved) << "line " << run << ": " << result.reply.reason;
    const Trajectory& found = result.reply.trajectory;
    EXPECT_LE(found.duration(), result.reply.duration_ptp + 1e-9) << "line " << run;
    KinematicLimits limits = robot.comfort_limits();
    limits = {RobotModel::part(limits.velocity, arm), RobotModel::part(limits.acceleration, arm),
              RobotModel::part(limits.jerk, arm)};
    EXPECT_EQ(why_not_within(found, limits, 0.1 + 1e-9), "") << "line " << run;
    for (int i = 0; i < found.size(); ++i) {
      const AxisExtremes e = extremes(found.axes[i]);
      const Axis& axis = robot.axes()[static_cast<std::size_t>(arm.axes[i])];
      EXPECT_GE(e.lowest, axis.lower - 1e-9) << "line " << run;
      EXPECT_LE(e.highest, axis.upper + 1e-9) << "line " << run;
    }
    corners += static_cast<int>(request.nodes.size()) - 2;
    stops += static_cast<int>(result.reply.corners.size());
    for (const Refusal& refusal : result.reply.corners)
      collided += refusal.reason.find("collides") != std::string::npos;
    time += found.duration();
    with_stops += result.reply.duration_ptp;
    const SegmentTable table(found);
    MotionState3 state = found.at(0);
    int cursor = 0;
    CollisionWorld& checker = run % kAlone == 0 ? exact : wide;
    for (double t = 0; t <= table.duration();) {
      table.evaluate(t, cursor, state);
      ++states;
      const CollisionVerdict verdict =
          checker.is_free(RobotModel::with(request.start, arm, state.position))
              ? CollisionVerdict{}
              : checker.check(RobotModel::with(request.start, arm, state.position));
      if (!verdict.free) {
        double off = 1e9;
        for (std::size_t k = 0; k + 1 < request.nodes.size(); ++k) {
          const Vector segment = request.nodes[k + 1] - request.nodes[k];
          const double s = std::clamp(
              (state.position - request.nodes[k]).dot(segment) / segment.squaredNorm(), 0.0, 1.0);
          off = std::min(off, (state.position - request.nodes[k] - s * segment).norm());
        }
        FAIL() << "line " << run << " at " << t << " s, " << off
               << " rad off the legs: " << verdict.first << " touches " << verdict.second;
      }
      const double speed = kReach * state.velocity.cwiseAbs().sum();
      t += std::clamp(kMaxPointMotion / std::max(speed, 1e-3), 2e-4, 0.02);
    }
  }
  std::printf(
      "seed %u: %d lines, %d corners, %d keep their stop (%d of them would collide); %.0f s "
      "instead of %.0f s; %zu states free\n",
      kSeed, runs, corners, stops, collided, time, with_stops, states);
  EXPECT_GT(collided, first == 1 ? runs / 10 : -1);
  EXPECT_LT(time, with_stops);
}

}  // namespace
}  // namespace handsel::trajectory_planner::broken_lines_test
