// SPDX-License-Identifier: Apache-2.0
// Wheel odometry of a platform and its localisation.
#include <gtest/gtest.h>

#include "sim/robot/platform_odometry.hpp"

namespace handsel::sim::platform_odometry_test {
namespace {

constexpr double kStep = 0.001;

class Odometry : public ::testing::Test {
 protected:
  static const RobotModel& robot() {
    static const RobotModel model = RobotModel::load(
        std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido_mobile/jido_mobile.txtpb");
    return model;
  }
  static Vector at(double x, double y, double heading) {
    return with_platform_at(robot(), robot().rest_configuration(), {x, y, heading});
  }
  /// Drives an arc from the origin: 3 m long, turning by 1 rad.
  static Vector arc(double part) { return at(3 * std::sin(part), 3 * (1 - std::cos(part)), part); }
  static void drive(PlatformOdometry& odometry) {
    for (int i = 1; i <= 6000; ++i) odometry.advance(arc(i / 6000.0), i * kStep);
  }
  /// Returns the platform's place in the root frame from the robot's reports.
  static Vector3 found(const PlatformOdometry& odometry, const Vector& truth) {
    const Vector measured = odometry.measured_position(truth);
    return (odometry.T_root_odometry() * T_world_platform(robot(), measured, Pose::Identity()))
        .translation();
  }
};

TEST_F(Odometry, without_noise_the_odometry_frame_stays_the_root_frame) {
  PlatformOdometry odometry(robot(), at(0, 0, 0), {0, 0}, {10, 0, 0, 0.5}, 1);
  drive(odometry);
  EXPECT_LT((odometry.measured_position(arc(1)) - arc(1)).norm(), 1e-9);
  EXPECT_LT((odometry.T_root_odometry().matrix() - Pose::Identity().matrix()).norm(), 1e-9);
}

TEST_F(Odometry, errors_of_the_wheels_add_up_and_the_localisation_makes_up_for_them) {
  double wheels = 0, together = 0;
  constexpr int kTrials = 40;
  for (int trial = 1; trial <= kTrials; ++trial) {
    PlatformOdometry odometry(robot(), at(0, 0, 0), {0.03, 0.03}, {10, 0.005, 0.002, 0.3},
                              static_cast<std::uint64_t>(trial));
    drive(odometry);
    const Vector truth = arc(1);
    const Vector3 p = T_world_platform(robot(), truth, Pose::Identity()).translation();
    wheels += (odometry.measured_position(truth) - truth).norm() / kTrials;
    together += (found(odometry, truth) - p).norm() / kTrials;
  }
  EXPECT_GT(wheels, 0.03);
  EXPECT_LT(together, 0.02);
}

TEST_F(Odometry, set_points_in_the_odometry_frame_lead_to_where_the_wheels_measure_them) {
  PlatformOdometry odometry(robot(), at(0, 0, 0), {0.05, 0.05}, {10, 0, 0, 0.5}, 3);
  drive(odometry);
  Vector position = at(1, 2, 0.3), velocity = Vector::Zero(robot().dof()), acceleration = velocity;
  const std::vector<int>& axes = robot().require_group(kPlatformGroup).axes;
  velocity[axes[0]] = 0.4;
  odometry.to_root(position, velocity, acceleration);
  EXPECT_LT((odometry.measured_position(position) - at(1, 2, 0.3)).norm(), 1e-9);
  Vector along = Vector::Zero(robot().dof());
  along[axes[0]] = 0.4;
  EXPECT_LT((odometry.measured_velocity(velocity) - along).norm(), 1e-9);
}

TEST_F(Odometry, a_slip_shows_in_where_the_localisation_has_the_odometry_frame) {
  PlatformOdometry odometry(robot(), at(0, 0, 0), {0, 0}, {10, 0, 0, 0.5}, 1);
  odometry.slip(0.3);
  for (int i = 1; i <= 2000; ++i) odometry.advance(at(0.0005 * i, 0, 0), i * kStep);
  EXPECT_NEAR(odometry.measured_position(at(1, 0, 0))[robot().dof() - 3], 1.3, 1e-6);
  for (int i = 2001; i <= 4000; ++i) odometry.advance(at(1, 0, 0), i * kStep);
  EXPECT_LT((found(odometry, at(1, 0, 0)) - Vector3(1, 0, 0)).norm(), 2e-3);
  EXPECT_NEAR(odometry.T_root_odometry().translation().x(), -0.3, 2e-3);
}

TEST_F(Odometry, a_lost_platform_grows_older_until_it_is_found_again) {
  PlatformOdometry odometry(robot(), at(0, 0, 0), {0, 0}, {10, 0, 0, 0.5}, 1);
  odometry.advance(at(0, 0, 0), 0.1);
  odometry.lose(2.0);
  for (int i = 1; i <= 1000; ++i) odometry.advance(at(0, 0, 0), 0.1 + i * kStep);
  EXPECT_NEAR(odometry.age(1.1), 1.0, 1e-9);
  for (int i = 1001; i <= 2100; ++i) odometry.advance(at(0, 0, 0), 0.1 + i * kStep);
  EXPECT_LT(odometry.age(2.2), 0.2);
}

}  // namespace
}  // namespace handsel::sim::platform_odometry_test
