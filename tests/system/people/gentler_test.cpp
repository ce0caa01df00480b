// SPDX-License-Identifier: Apache-2.0
// The same motion near people: velocity, acceleration and jerk fall with the distance of a person
// (chapter section 2.1). The whole system in lock-step; the path is requested directly.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "common/trajectory/limits_check.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::gentler_test {
namespace {

/// Largest velocity, acceleration and jerk of a motion as ratios to the comfort limits.
struct Rates {
  double velocity{}, acceleration{}, jerk{};
  double duration{};  ///< [s]
};

std::string place(double x) {
  return R"(name: "beside"
robot: "jido"
people { id: "anna" x: )" +
         std::to_string(x) + R"( y: -0.25 yaw: 3.1416 stature: 1.72 behaviour: STILL }
human_sensors { source: "kinect" rate: 30 latency: 0.04 noise: 0 }
object_sensors { source: "object_tracker" rate: 30 latency: 0.04 noise: 0 }
)";
}

TrajectoryRequest reach_forward(const RobotModel& robot) {
  TrajectoryRequest request;
  request.id = {77, 1};
  request.group = "arm";
  request.start = robot.rest_configuration();
  const Group& arm = robot.require_group(request.group);
  Vector from(arm.axes.size());
  for (std::size_t i = 0; i < arm.axes.size(); ++i)
    from[static_cast<Eigen::Index>(i)] = request.start[arm.axes[i]];
  Vector to = from;
  to[0] += 0.9;
  to[1] += 0.7;
  request.nodes = {from, to};
  return request;
}

Rates rates_with_person_at(double x) {
  test::TemporaryFolder folder;
  const NodeContext context =
      system_context(folder.write("beside.txtpb", place(x)).string(), "", 1);
  LockstepSystem system(context);
  TrajectoryReply reply;
  system.bus().subscribe<TrajectoryReply>(
      [&](const TrajectoryReply& m, const Receipt&) { reply = m; });
  const auto requests = system.bus().advertise<TrajectoryRequest>();
  const auto ready = [&] { return not_ready(system.snapshot(), false).empty(); };
  system.network().run_until(ready, TimePoint(from_seconds(10)));
  EXPECT_TRUE(ready());
  EXPECT_TRUE(requests->publish(reach_forward(*context.robot)));
  system.network().run_until([&] { return !reply.axes.empty(); }, TimePoint(from_seconds(20)));
  EXPECT_TRUE(reply.solved) << reply.reason;
  Rates rates{0, 0, 0, reply.trajectory.duration()};
  const KinematicLimits& comfort = context.robot->comfort_limits();
  for (std::size_t i = 0; i < reply.axes.size(); ++i) {
    const AxisExtremes most = extremes(reply.trajectory.axes[i]);
    const auto axis = static_cast<Eigen::Index>(reply.axes[i]);
    rates.velocity = std::max(rates.velocity, most.velocity / comfort.velocity[axis]);
    rates.acceleration =
        std::max(rates.acceleration, most.acceleration / comfort.acceleration[axis]);
    rates.jerk = std::max(rates.jerk, most.jerk / comfort.jerk[axis]);
  }
  std::printf("person at %.2f m: v %.3f a %.3f j %.3f of the comfort limits, %.2f s\n", x,
              rates.velocity, rates.acceleration, rates.jerk, rates.duration);
  return rates;
}

TEST(Gentler, velocity_acceleration_and_jerk_fall_the_nearer_a_person_stands) {
  const Rates far = rates_with_person_at(4.0), middle = rates_with_person_at(1.5),
              near = rates_with_person_at(1.1);
  for (const auto& [more, less] : {std::pair(far, middle), std::pair(middle, near)}) {
    EXPECT_LT(less.velocity, 0.97 * more.velocity);
    EXPECT_LT(less.acceleration, 0.97 * more.acceleration);
    EXPECT_LT(less.jerk, 0.97 * more.jerk);
    EXPECT_GT(less.duration, more.duration);
  }
}

}  // namespace
}  // namespace handsel::gentler_test
