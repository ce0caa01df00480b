// SPDX-License-Identifier: Apache-2.0
// An external person: follows the observations, takes an object offered near the hand, pulls with
// limited force, keeps the object.
#include <gtest/gtest.h>

#include "common/base/errors.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace handsel::sim::external_person_test {
namespace {

using namespace test;

Vector start() { return opened(jido().rest_configuration()); }

config::Scenario with_visitor() {
  config::Scenario scenario = mug_in_hand();
  for (int i = 0; i < jido().dof(); ++i)
    (*scenario.mutable_start())[jido().axes()[static_cast<std::size_t>(i)].name] = start()[i];
  config::PersonDescription* person = add_person(scenario, config::EXTERNAL);
  person->set_external("tracker");
  person->set_correction(0.2);
  return scenario;
}

/// Returns a person at the place of add_person, with the right hand at `hand`.
HumanObservation seen(const Vector3& hand) {
  HumanObservation out;
  out.source = "tracker";
  ObservedPerson person;
  person.body = "b7";
  for (const BodyJoint& joint :
       standing_body(Vector3(in_hand().x() + 0.55, in_hand().y(), 0), M_PI, 1.75))
    if (joint.name != "r_hand" && joint.name != "r_wrist" && joint.name != "r_elbow")
      person.joints.push_back({joint.name, joint.position, 1.0});
  person.joints.push_back({"r_hand", hand, 1.0});
  out.people.push_back(person);
  return out;
}

Vector3 hand_of(const SimWorld& world) {
  return world.person(0).joints[static_cast<std::size_t>(body_joint_index("r_hand"))].position;
}

TEST(ExternalPerson, follows_its_source_and_no_other) {
  SimWorld world(jido(), library(), with_visitor(), SimSettings{}, 1);
  Driver driver(world, start());
  EXPECT_TRUE(world.follows());
  const Vector3 first(in_hand().x() + 0.4, in_hand().y() + 0.3, 0.9);
  world.observe(seen(first));
  driver.hold(0.4);
  EXPECT_LT((hand_of(world) - first).norm(), 0.02) << "the first sample places it";
  double fastest = 0;
  for (int i = 1; i <= 30; ++i) {  // 1 s at 0.3 m/s
    world.observe(seen(first + Vector3(0, 0.01 * i, 0)));
    Vector3 before = hand_of(world);
    driver.move(driver.q(), 0.033, [&] {
      fastest = std::max(fastest, (hand_of(world) - before).norm() / 0.001);
      before = hand_of(world);
    });
  }
  EXPECT_LT((hand_of(world) - first - Vector3(0, 0.3, 0)).norm(), 0.03);
  EXPECT_LT(fastest, 0.8) << "it moves between samples, it does not jump";
  HumanObservation other = seen(first);
  other.source = "somebody_else";
  world.observe(other);
  driver.hold(0.2);
  EXPECT_GT((hand_of(world) - first).norm(), 0.25);
  EXPECT_EQ(world.control({0, SimAction::person_dart, "anna", 1.0}), "there is no person anna")
      << "it is not the simulator that moves it";
  EXPECT_EQ(world.control({0, SimAction::person_freeze, "anna", 0}), "");
}

TEST(ExternalPerson, comes_from_one_moment_to_the_next_without_a_push) {
  SimWorld world(jido(), library(), with_visitor(), SimSettings{}, 1);
  Driver driver(world, start());
  driver.hold(0.3);
  HumanObservation far = seen(in_hand() + Vector3(0.45, 0, 0));
  for (ObservedJoint& joint : far.people[0].joints)
    joint.position += Vector3(-3.0, 0.1, 0);  // behind the robot
  double fastest = 0;
  RobotState state;
  const auto watch = [&] {
    if (world.robot_state(state)) fastest = std::max(fastest, state.velocity.cwiseAbs().maxCoeff());
  };
  for (int times = 0; times < 3; ++times) {  // behind the robot and back, through it
    world.observe(far);
    driver.move(driver.q(), 0.3, watch);
    EXPECT_LT((hand_of(world) - far.people[0].joints.back().position).norm(), 0.05);
    world.observe(seen(in_hand() + Vector3(0.45, 0, 0)));
    driver.move(driver.q(), 0.3, watch);
  }
  EXPECT_LT(fastest, 0.05) << "nobody struck the arm";
}

TEST(ExternalPerson, takes_what_is_offered_and_pulls_until_the_robot_lets_go) {
  SimWorld world(jido(), library(), with_visitor(), SimSettings{}, 1);
  Driver driver(world, start());
  const Vector3 away(in_hand().x() + 0.45, in_hand().y() - 0.2, 0.8);
  world.observe(seen(away));
  driver.move(closed(start()), 1.5);
  driver.move(raised(driver.q()), 2.0);
  ASSERT_TRUE(world.robot_grips());
  EXPECT_EQ(world.person_phase(0), PersonPhase::watching)
      << "a hand that is not there takes nothing";

  const Vector3 near = world.T_world_object("mug").translation() + Vector3(0.14, 0, 0.03);
  for (int i = 1; i <= 20; ++i) {
    world.observe(seen(away + i / 20.0 * (near - away)));
    driver.hold(0.033);
  }
  for (int i = 0; i < 40 && world.person_phase(0) != PersonPhase::pulling; ++i) {
    world.observe(seen(near));
    driver.hold(0.033);
  }
  ASSERT_EQ(world.person_phase(0), PersonPhase::pulling) << "the hand was led over the last 0.1 m";
  RobotState state;
  double least = 1e9, most = 0;
  for (int i = 0; i < 30; ++i) {  // the person waits: no pull
    world.observe(seen(near));
    driver.hold(0.033);
  }
  world.robot_state(state);
  const double resting = state.wrist_wrench.force.norm();
  for (int i = 1; i <= 40; ++i) {  // the hand moves away by 0.12 m while the robot holds the object
    world.observe(seen(near + std::min(1.0, i / 12.0) * Vector3(0.12, 0, 0)));
    driver.hold(0.033);
    world.robot_state(state);
    if (i > 30) least = std::min(least, (state.wrist_wrench.force).norm() - resting);
    most = std::max(most, state.wrist_wrench.force.norm() - resting);
  }
  EXPECT_EQ(world.person_phase(0), PersonPhase::pulling);
  EXPECT_LT(most, 15) << "the pull is limited to 8 N";
  EXPECT_TRUE(world.robot_grips());

  driver.move(opened(driver.q()), 0.4);
  for (int i = 0; i < 60; ++i) {
    world.observe(seen(near + Vector3(0.12, 0, 0)));
    driver.hold(0.033);
  }
  EXPECT_FALSE(world.robot_grips());
  EXPECT_EQ(world.person_phase(0), PersonPhase::keeping);
  EXPECT_EQ(truth_of(world).carrier, "human");
  EXPECT_FALSE(truth_of(world).dropped);
  EXPECT_LT((hand_of(world) - near - Vector3(0.12, 0, 0)).norm(), 0.05)
      << "the led hand is back where it is told to be";
}

TEST(ExternalPerson, needs_a_source_of_its_own) {
  config::Scenario scenario = with_visitor();
  scenario.mutable_people(0)->clear_external();
  EXPECT_THROW(SimWorld(jido(), library(), scenario, SimSettings{}, 1), ConfigError);
  scenario = with_visitor();
  auto* sensor = scenario.add_human_sensors();
  sensor->set_source("tracker");
  sensor->set_rate(30);
  EXPECT_THROW(SimWorld(jido(), library(), scenario, SimSettings{}, 1), ConfigError);
}

}  // namespace
}  // namespace handsel::sim::external_person_test
