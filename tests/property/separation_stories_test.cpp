// SPDX-License-Identifier: Apache-2.0
// A person runs in from any side at up to 2.2 m/s while the arm moves: the arm is at rest or moves
// away before contact.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <random>

#include "common/trajectory/path/smooth.hpp"
#include "common/trajectory/stop.hpp"
#include "tests/support/controller_bench.hpp"

namespace handsel::trajectory_controller::separation_stories_test {
namespace {

constexpr double kRounding = 1e-9;  // rounding error of a finite difference [m/s]

class Watch {
 public:
  explicit Watch(const test::ControllerBench& bench)
      : bench_(bench), capsules_(robot_capsules(*bench.robot)) {}
  Separation separation_now() {
    bench_.robot->forward(bench_.core.set_point().position, links_);
    return separation(capsules_, links_, Pose::Identity(), bench_.people);
  }
  /// Speed of the robot toward the person at the nearest points [m/s], from the set-points sent.
  double speed_toward(const Separation& s) {
    constexpr double kStep = 1e-4;
    if (s.link < 0) return 0.0;
    const Pose T = links_[static_cast<std::size_t>(s.link)];
    bench_.robot->forward(
        bench_.core.set_point().position + kStep * bench_.core.set_point().velocity, links_);
    const Vector3 p = links_[static_cast<std::size_t>(s.link)] * (T.inverse() * s.on_robot);
    const Vector3 direction = (s.distance < 0 ? -1.0 : 1.0) * (s.on_person - s.on_robot);
    return direction.norm() < 1e-9 ? 0.0 : (p - s.on_robot).dot(direction.normalized()) / kStep;
  }

 private:
  const test::ControllerBench& bench_;
  std::vector<LinkCapsule> capsules_;
  std::vector<Pose> links_;
};

int number(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

/// Over the nodes without a stop.
TrajectoryCommand round_corners(const test::ControllerBench& b, std::vector<Eigen::VectorXd> nodes,
                                std::uint64_t id) {
  TrajectoryCommand c = b.command(nodes.back(), id);
  nodes.insert(nodes.begin(), b.core.set_point().position.head(3));
  const KinematicLimits& l = b.robot->comfort_limits();
  c.trajectory =
      smooth(nodes, {l.velocity.head(3), l.acceleration.head(3), l.jerk.head(3)}).trajectory;
  return c;
}

/// The separation the rule asks for between a person at `v_h` and an arm whose axes and hand move
/// as fast as they ever do [m].
double separation_needed(const test::ControllerBench& b, double v_h, double age) {
  const KinematicLimits &fastest = b.robot->comfort_limits(), &stop = b.robot->stop_limits();
  double max_duration = 0.0;
  for (Eigen::Index i = 0; i < 3; ++i)
    max_duration = std::max(
        max_duration,
        measure_stop(fastest.velocity[i], 0.0, stop.acceleration[i], stop.jerk[i]).duration);
  const GuardSettings& g = b.settings.guard;
  const double v_r = 0.9 * 2 * fastest.velocity[0], reaction = g.reaction + age;
  return v_h * (reaction + max_duration) + v_r * reaction + v_r * max_duration / 2 + g.intrusion +
         g.uncertainty_human + g.uncertainty_robot;
}

// The person starts at or beyond the separation that SSM requires; the controller's data of the
// person are up to 100 ms old.
TEST(SeparationStories, the_arm_stands_before_a_person_who_darts_in_reaches_it) {
  const auto seed = static_cast<std::uint64_t>(number("HANDSEL_SEPARATION_SEED", 77));
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int met = 0, was_moving = 0;
  double worst = -10.0, nearest_start = 1e9;
  const int runs = number("HANDSEL_SEPARATION_RUNS", 60);
  for (int trial = 0; trial < runs; ++trial) {
    test::ControllerBench b;
    b.human_age = 0.1 * unit(random) * unit(random);
    b.start();
    Watch watch(b);
    const double angle = 2.0 * M_PI * unit(random), speed = 0.3 + 1.9 * unit(random);
    constexpr double kReach = 1.0, kBody = 0.35;
    const double from = kReach + kBody + separation_needed(b, speed + 0.05, b.human_age + 0.033) +
                        0.5 * unit(random);
    const Vector3 away(std::cos(angle), std::sin(angle), 0.0), velocity = -speed * away;
    const double begin = 0.2 + 2.0 * unit(random);
    Person person = b.standing(from * away.x(), from * away.y());
    for (BodyJoint& j : person.joints) j.velocity.setZero();
    b.people.people = {person};
    nearest_start = std::min(nearest_start, watch.separation_now().distance);
    std::uint64_t id = 0;
    bool moved = false;
    for (int k = 0; k < 14000; ++k) {
      if (b.core.status_key().motion != MotionState::running && b.core.mode() < Mode::hold) {
        ++id;
        const Vector goal = test::ControllerBench::arm(id % 2 ? -1.2 : 1.2, 0.2, -0.3);
        if (trial % 2 == 0)
          b.go_to(goal, id);
        else
          b.send(round_corners(b,
                               {test::ControllerBench::arm(-0.4, 0.5, -0.6),
                                test::ControllerBench::arm(0.3, 0.0, 0.2), goal},
                               id));
      }
      if (k * 0.001 >= begin)
        for (BodyJoint& j : b.people.people[0].joints) {
          j.position += 0.001 * velocity;
          j.velocity = velocity;
        }
      b.tick();
      moved = moved || !b.at_rest();
      const Separation s = watch.separation_now();
      if (s.distance > 0.0) continue;
      ++met;
      const double toward = watch.speed_toward(s);
      worst = std::max(worst, toward);
      EXPECT_LE(toward, kRounding) << "trial " << trial << ", person at " << speed << " m/s, data "
                                   << b.human_age << " s old";
      break;
    }
    was_moving += moved ? 1 : 0;
  }
  std::printf(
      "%d of %d reached the robot, from %.2f m or more; the arm had been moving in %d; its largest "
      "speed toward them when they met: %g "
      "m/s\n",
      met, runs, nearest_start, was_moving, worst);
  EXPECT_GT(met, 0.6 * runs);
  EXPECT_GT(was_moving, 0.8 * runs);
}

TEST(SeparationStories, a_person_standing_still_leaves_most_of_the_time_productive) {
  test::ControllerBench b;
  b.people.people = {b.standing(1.5, 0.0)};
  b.start();
  std::uint64_t id = 0;
  int productive = 0, steps = 20000;
  for (int k = 0; k < steps; ++k) {
    if (b.core.status_key().motion != MotionState::running) {
      ++id;
      ASSERT_EQ(b.go_to(test::ControllerBench::arm(id % 2 ? -1.2 : 1.2, 0.2, -0.3), id), "");
    }
    b.tick();
    productive += b.core.speed_factor() > 0.5 ? 1 : 0;
  }
  std::printf("productive %.1f %% of the time with a person standing at 1.5 m\n",
              100.0 * productive / steps);
  EXPECT_GT(productive, 0.6 * steps);
}

}  // namespace
}  // namespace handsel::trajectory_controller::separation_stories_test
