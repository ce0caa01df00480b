// SPDX-License-Identifier: Apache-2.0
// People move at random within their bounds: a person who touches the arm during a stop that passed
// the proof touches a link at rest or slow enough for the contact limits. The oracle samples both
// stops and the people finely, independent of the bounds of the proof.
#include "components/trajectory_controller/supervise/stop/stop_proof.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <random>

#include "common/config/resources.hpp"
#include "common/geometry/segments.hpp"
#include "common/trajectory/stop.hpp"
#include "components/trajectory_controller/supervise/reach_limit.hpp"

namespace handsel::trajectory_controller::stop_proof_test {
namespace {

int number(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

/// The part moves with a random acceleration at each instant, its speed and acceleration bounded.
struct Wanderer {
  PersonCapsule part;
  RegionMotion bounds;
  Vector3 velocity{Vector3::Zero()}, offset{Vector3::Zero()};
  void step(double dt, const Vector3& wish) {
    velocity += dt * bounds.acceleration * wish;
    if (velocity.norm() > bounds.speed) velocity *= bounds.speed / velocity.norm();
    offset += dt * velocity;
  }
};

class StopProofStories : public testing::Test {
 protected:
  StopProofStories()
      : robot_(RobotModel::load(robot_description("jido"))),
        capsules_(robot_capsules(robot_)),
        proof_(settings_, robot_, capsules_) {}

  /// Speed of the surface of a capsule, from two forward kinematics [m/s].
  double speed(const LinkCapsule& c, const std::vector<Pose>& before,
               const std::vector<Pose>& after, double dt) const {
    const Pose &A = before[static_cast<std::size_t>(c.link)],
               &B = after[static_cast<std::size_t>(c.link)];
    return std::max((B * c.a - A * c.a).norm(), (B * c.b - A * c.b).norm()) / dt;
  }

  RobotModel robot_;
  std::vector<LinkCapsule> capsules_;
  StopProofSettings settings_;
  StopProof proof_;
};

TEST_F(StopProofStories,
       whoever_touches_a_stopping_arm_touches_it_at_rest_or_within_the_contact_limits) {
  const auto seed = static_cast<std::uint64_t>(number("HANDSEL_STORY_SEED", 4711));
  const int motions = number("HANDSEL_PROOF_MOTIONS", 20000);
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0), both(-1.0, 1.0);
  const Group& arm = robot_.require_group("arm");
  const KinematicLimits &guard = robot_.guard_limits(), &stop = robot_.stop_limits();
  int harmless = 0, touched = 0, moving = 0;
  double worst = 0.0;
  std::vector<Pose> before, after;
  for (int done = 0; done < motions;) {
    MotionState3 state{robot_.rest_configuration(), Vector::Zero(robot_.dof()),
                       Vector::Zero(robot_.dof())};
    const double pace = std::pow(unit(random), 2.0);
    for (int axis : arm.axes) {
      const Axis& bounds = robot_.axes()[static_cast<std::size_t>(axis)];
      state.position[axis] =
          bounds.lower + (0.2 + 0.6 * unit(random)) * (bounds.upper - bounds.lower);
      state.velocity[axis] = pace * 0.9 * both(random) * guard.velocity[axis];
      state.acceleration[axis] = pace * 0.3 * both(random) * guard.acceleration[axis];
    }
    // One part of one person, at random near the hand.
    robot_.forward(state.position, before);
    Wanderer person;
    const auto region = static_cast<std::size_t>(unit(random) * kBodyRegions);
    person.bounds = settings_.people[region];
    person.part.region = static_cast<BodyRegion>(region);
    const Vector3 hand = before[static_cast<std::size_t>(robot_.tool_link())].translation();
    person.part.a = hand + (0.1 + 0.9 * unit(random)) *
                               Vector3(both(random), both(random), both(random)).normalized();
    person.part.b = person.part.a + 0.2 * Vector3(both(random), both(random), both(random));
    person.part.radius = 0.05 + 0.1 * unit(random);
    person.part.centre = 0.5 * (person.part.a + person.part.b);
    person.part.reach = 0.5 * (person.part.b - person.part.a).norm() + person.part.radius;
    person.velocity = unit(random) * person.bounds.speed *
                      Vector3(both(random), both(random), both(random)).normalized();
    person.part.fastest = person.velocity.norm();
    person.part.joints = 1;
    person.part.velocities[0] = person.velocity;
    person.part.measured = true;
    PersonCapsules people;
    people.capsules = {person.part};
    people.revision = static_cast<std::uint64_t>(done) + 1;
    const double age = 0.05 * unit(random);
    if (!proof_.check(state, people, Pose::Identity(), age, 0.0)) {
      ++done;
      continue;
    }
    ++harmless;
    ++done;
    const bool robot_side = unit(random) < 0.5;
    // Half of the time the part moves straight at the arm, else at random.
    const bool attacks = unit(random) < 0.5;
    constexpr double kStep = 2e-3;
    std::vector<AxisState> axes;
    for (Eigen::Index i = 0; i < state.position.size(); ++i)
      axes.push_back({state.position[i], state.velocity[i], state.acceleration[i]});
    std::vector<JerkLimitedStop> stops(axes.size());
    Vector q = state.position;
    Vector3 wish = Vector3(both(random), both(random), both(random)).normalized();
    bool stopping = false, was_moving = false;
    for (double t = -age; t < 1.5; t += kStep) {
      if (attacks)
        wish = (before[static_cast<std::size_t>(robot_.tool_link())].translation() -
                person.part.centre - person.offset)
                   .stableNormalized();
      person.step(kStep, wish);
      if (t < 0.0) continue;
      if (!stopping && (!robot_side || t >= settings_.robot_side_delay)) {
        stopping = true;
        for (std::size_t i = 0; i < axes.size(); ++i)
          stops[i].init(axes[i], limits_of(stop, static_cast<Eigen::Index>(i)));
      }
      bool at_rest = stopping;
      for (std::size_t i = 0; i < axes.size(); ++i) {
        axes[i] = stopping ? stops[i].step(kStep) : advanced(axes[i], kStep, 0.0);
        q[static_cast<Eigen::Index>(i)] = axes[i].position;
        at_rest = at_rest && stops[i].finished();
      }
      robot_.forward(q, after);
      bool touches = false;
      for (const LinkCapsule& c : capsules_) {
        const Pose& T = after[static_cast<std::size_t>(c.link)];
        Vector3 on_robot, on_person;
        const double d =
            std::sqrt(nearest_points(T * c.a, T * c.b, person.part.a + person.offset,
                                     person.part.b + person.offset, on_robot, on_person)) -
            c.radius - person.part.radius;
        if (d > 0.0) continue;
        touches = true;
        const double v = speed(c, before, after, kStep),
                     allowed = proof_.contact_speeds().max_speed_at(person.part.region, 0.0);
        was_moving = was_moving || v > 1e-6;
        worst = std::max(worst, v / allowed);
        ASSERT_LE(v, allowed * (1.0 + 1e-6))
            << "motion " << done << ", link "
            << robot_.links()[static_cast<std::size_t>(c.link)].name << ", "
            << kBodyRegionNames[region] << ", " << t << " s after the set-point";
      }
      before = after;
      if (touches) {
        ++touched;
        moving += was_moving;
        break;
      }
      if (at_rest) break;
    }
  }
  std::printf(
      "%d motions: %d stops found harmless, %d of them touched, %d while the arm still moved; its "
      "largest speed there %.2f of the "
      "contact speed\n",
      motions, harmless, touched, moving, worst);
  EXPECT_GT(harmless, motions / 20) << "the proof refuses nearly everything: it shows nothing";
  EXPECT_GT(moving, 0) << "nobody ever touched a moving arm: it shows nothing";
}

TEST_F(StopProofStories, a_fast_arm_beside_a_head_is_refused_and_a_slow_one_is_not) {
  MotionState3 state{robot_.rest_configuration(), Vector::Zero(robot_.dof()),
                     Vector::Zero(robot_.dof())};
  std::vector<Pose> links;
  robot_.forward(state.position, links);
  PersonCapsules people;
  PersonCapsule head{};
  const Vector3 beside =
      links[static_cast<std::size_t>(robot_.tool_link())].translation() + Vector3(0.35, 0, 0);
  head.a = beside;
  head.b = beside;
  head.centre = beside;
  head.radius = 0.12;
  head.reach = 0.12;
  head.region = BodyRegion::head;
  head.measured = true;
  people.capsules.push_back(head);
  people.revision = 1;
  const int shoulder = robot_.require_group("arm").axes.front();
  state.velocity[shoulder] = 0.8;
  EXPECT_FALSE(proof_.check(state, people, Pose::Identity(), 0.02, 0.0));
  EXPECT_GT(proof_.refutation().speed, proof_.refutation().max_speed);
  state.velocity[shoulder] = 0.05;
  EXPECT_TRUE(proof_.check(state, people, Pose::Identity(), 0.02, 0.0));
}

TEST_F(StopProofStories, a_turning_head_takes_nothing_from_the_speed_of_the_arm) {
  MotionState3 state{robot_.rest_configuration(), Vector::Zero(robot_.dof()),
                     Vector::Zero(robot_.dof())};
  std::vector<Pose> links;
  robot_.forward(state.position, links);
  PersonCapsule face{};
  face.a = face.b = face.centre =
      links[static_cast<std::size_t>(robot_.tool_link())].translation() + Vector3(0.6, 0, 0);
  face.radius = face.reach = 0.12;
  face.region = BodyRegion::head;
  face.measured = true;
  PersonCapsules people;
  people.capsules.push_back(face);
  const int shoulder = robot_.require_group("arm").axes.front();
  const auto fastest = [&] {
    double harmless = 0.0, harmful = 1.5;
    for (int k = 0; k < 20; ++k) {
      state.velocity[shoulder] = 0.5 * (harmless + harmful);
      people.revision += 1;
      (proof_.check(state, people, Pose::Identity(), 0.02, 0.0) ? harmless : harmful) =
          state.velocity[shoulder];
    }
    return harmless;
  };
  const double still = fastest();
  for (int axis : robot_.require_group("head").axes) {
    state.velocity[axis] = 0.9;
    state.acceleration[axis] = 2.0;
  }
  const double turning = fastest();
  std::printf("fastest harmless shoulder %.3f rad/s, with a head that turns %.3f rad/s\n", still,
              turning);
  EXPECT_GT(still, 0.26) << "intervals of a stop are bounded by more than their own two samples";
  EXPECT_LT(still, 1.4);
  EXPECT_NEAR(turning, still, 1e-3);
}

TEST_F(StopProofStories, a_stop_that_would_leave_the_bounds_of_an_axis_is_refused) {
  MotionState3 state{robot_.rest_configuration(), Vector::Zero(robot_.dof()),
                     Vector::Zero(robot_.dof())};
  const int axis = robot_.require_group("arm").axes.front();
  state.position[axis] = robot_.axes()[static_cast<std::size_t>(axis)].upper - 0.01;
  state.velocity[axis] = 0.5;
  EXPECT_FALSE(proof_.check(state, {}, Pose::Identity(), 0.0, 0.0));
  state.velocity[axis] = -0.5;
  EXPECT_TRUE(proof_.check(state, {}, Pose::Identity(), 0.0, 0.0));
}

}  // namespace
}  // namespace handsel::trajectory_controller::stop_proof_test
