// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/geometry/segments.hpp"
#include "common/model/object_surface.hpp"
#include "sim/scene/settings.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/unit/sim/person_fixture.hpp"

namespace handsel::sim::sim_person_test {
namespace {

using namespace test;

TEST(SimPerson, reaches_smoothly_and_its_hand_ends_at_the_mug) {
  PersonSettings settings;
  settings.id = "anna";
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  PersonModel person(settings);
  const PersonView view = offer({0.95, 0.05, 1.05});
  double fastest = 0, clock = 0;
  Vector3 before = person.hand().T_world_body.translation();
  while (person.phase() != PersonPhase::pulling && clock < 5) {
    person.step(0.001, view);
    clock += 0.001;
    const Vector3 hand = person.hand().T_world_body.translation();
    fastest = std::max(fastest, (hand - before).norm() / 0.001);
    before = hand;
    for (const auto& [a, b] : {std::pair{"r_shoulder", "r_elbow"}, {"r_elbow", "r_wrist"}}) {
      const double length =
          (person.body().joints[joint(a)].position - person.body().joints[joint(b)].position)
              .norm();
      ASSERT_GT(length, 0.15);
      ASSERT_LT(length, 0.40);
    }
  }
  EXPECT_EQ(person.phase(), PersonPhase::pulling);
  EXPECT_GT(clock, settings.reaction + 0.8) << "not before the reaction and the reach";
  EXPECT_LT(clock, settings.reaction + 1.2 + 0.5);
  EXPECT_GT(fastest, 0.3);
  EXPECT_LT(fastest, 2.5);
  const double gap = surface_distance(
      *view.object, view.T_world_object.inverse() * person.hand().T_world_body.translation());
  EXPECT_NEAR(gap, kPalmDistance, 0.013);
}

TEST(SimPerson, takes_only_what_the_robots_hand_leaves_a_place_on) {
  PersonModel person(taker());
  PersonView view = offer({0.95, 0.05, 1.05});
  const Vector3 p = view.T_world_object * view.object->com;
  const std::vector<HandPart> covered{{p - Vector3(0, 0, 0.08), p + Vector3(0, 0, 0.08), 0.06}};
  view.robot = &covered;
  step_for(person, view, 4);
  EXPECT_EQ(person.phase(), PersonPhase::watching) << "no place for a hand";
  EXPECT_FALSE(person.hand_configuration());
  const std::vector<HandPart> beside{{p - Vector3(0.15, 0, 0), p - Vector3(0.07, 0, 0), 0.02}};
  view.robot = &beside;
  bool opened = false;
  for (int i = 0; i < 4000 && person.phase() != PersonPhase::pulling; ++i) {
    person.step(0.001, view);
    opened = opened ||
             (person.hand_configuration() && person.hand_configuration()->closures == Closures{});
  }
  ASSERT_EQ(person.phase(), PersonPhase::pulling);
  EXPECT_TRUE(opened) << "comes with an open hand";
  ASSERT_TRUE(person.hand_configuration());
  const HumanHand shape = person.hand_shape(1);
  const Pose T = make_pose(person.hand().T_world_body.translation(),
                           person.hand_configuration()->R_world_hand);
  for (const HandPart& part : shape.parts(person.hand_configuration()->closures)) {
    Vector3 on_hand, on_robot;
    const double axes = std::sqrt(
        nearest_points(T * part.a, T * part.b, beside[0].a, beside[0].b, on_hand, on_robot));
    EXPECT_GT(axes, part.radius + beside[0].radius);
  }
}

TEST(SimPerson, no_joint_ever_jumps) {
  for (const bool recorded : {false, true}) {
    if (recorded && recording_folder().empty()) GTEST_SKIP() << "HANDSEL_DATA is not set";
    PersonSettings settings;
    settings.feet = Vector3(1.5, 0, 0);
    settings.yaw = M_PI;
    if (recorded)
      settings.recording = std::make_shared<const Recording>(load_recording(recording_folder()));
    settings.kind = recorded ? PersonKind::recording : PersonKind::taker;
    PersonModel person(settings);
    PersonView view = offer({0.95, -0.05, 1.05});
    for (int i = 0; i < 12000; ++i) {
      view.held_by_robot =
          i < 6000;  // the grip is lost: the person ends with the hand at rest or with the mug
      person.step(0.001, view);
      if (i == 0) continue;
      for (const BodyJoint& joint : person.body().joints) {
        ASSERT_LT(joint.velocity.norm(), 3.0)
            << joint.name << " at step " << i << " " << name(person.phase())
            << (recorded ? " recorded" : "");
      }
    }
  }
}

TEST(SimPerson, does_not_reach_for_what_moves_or_is_out_of_reach) {
  PersonSettings settings;
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  PersonModel person(settings);
  PersonView moving = offer({0.95, 0.05, 1.05});
  moving.object_velocity = Vector3(0.1, 0, 0);
  for (int i = 0; i < 2000; ++i) person.step(0.001, moving);
  EXPECT_EQ(person.phase(), PersonPhase::watching);
  for (int i = 0; i < 2000; ++i) person.step(0.001, offer({0.3, 0, 1.05}));
  EXPECT_EQ(person.phase(), PersonPhase::watching);
  person.refuse();
  for (int i = 0; i < 2000; ++i) person.step(0.001, offer({0.95, 0.05, 1.05}));
  EXPECT_EQ(person.phase(), PersonPhase::watching);
}

TEST(SimPerson, nobody_walks_into_the_arm_of_a_robot_that_drives) {
  PersonSettings settings;
  settings.feet = Vector3(0, 0, 0);
  settings.yaw = 0;
  settings.kind = PersonKind::walker;
  settings.approach_from = 2;
  const auto farthest = [&](const PersonView& view) {
    PersonModel person(settings);
    const auto waist = static_cast<std::size_t>(body_joint_index("waist"));
    double most = -10, before = 0, back = 0;
    for (int i = 0; i < 20000; ++i) {
      person.step(0.001, view);
      const double x = person.body().joints[waist].position.x();
      EXPECT_TRUE(i == 0 || std::abs(x - before) < 0.004) << "where the person turns back";
      before = x;
      most = std::max(most, x);
      back = std::max(back, most - x);
    }
    EXPECT_GT(back, 0.5) << "also who waits turns back";
    return most;
  };
  PersonView view;
  view.robot_hand = {0.5, 0.3, 1.0};
  EXPECT_GT(farthest(view), 1.0) << "a robot that stands is what passers-by are used to";
  view.platform = Vector3(0.5, 1.3, 0);
  EXPECT_LT(farthest(view), 0.0) << "the hand is ahead";
  view.robot_hand.y() = 1.0;
  EXPECT_GT(farthest(view), 1.0) << "hand and platform are beside";
}

TEST(SimPerson, raises_a_hand_changes_to_the_other_and_takes_with_that) {
  PersonSettings settings;
  settings.id = "anna";
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  settings.behaviour.readies = true;
  settings.behaviour.from_carry = true;
  settings.behaviour.changes_hand_at = 2;
  PersonModel person(settings);
  const auto ahead = [&](const char* hand, const char* shoulder) {
    return person.body().joints[joint(shoulder)].position.x() -
           person.body().joints[joint(hand)].position.x();
  };
  double fastest = 0;
  std::array<Vector3, 2> before{person.hand(0).T_world_body.translation(),
                                person.hand(1).T_world_body.translation()};
  const auto run = [&](double duration, const PersonView& view) {
    for (double t = 0; t < duration; t += 0.001) {
      person.step(0.001, view);
      for (int s = 0; s < 2; ++s) {
        const Vector3 now = person.hand(s).T_world_body.translation();
        fastest = std::max(fastest, (now - before[static_cast<std::size_t>(s)]).norm() / 0.001);
        before[static_cast<std::size_t>(s)] = now;
      }
    }
  };
  PersonView far = offer({0.2, 0.05, 1.05});
  far.held_by_robot = false;
  run(3, far);
  EXPECT_LT(ahead("r_hand", "r_shoulder"), 0.1) << "the robot has nothing yet";
  far.held_by_robot = true;
  run(1.5, far);
  EXPECT_GT(ahead("r_hand", "r_shoulder"), 0.2);
  EXPECT_LT(ahead("l_hand", "l_shoulder"), 0.1);
  run(2.5, far);
  EXPECT_LT(ahead("r_hand", "r_shoulder"), 0.1);
  EXPECT_GT(ahead("l_hand", "l_shoulder"), 0.2);
  for (int i = 0; i < 40 && person.phase() != PersonPhase::pulling; ++i)
    run(0.1, offer({0.95, 0.05, 1.05}));
  EXPECT_EQ(person.phase(), PersonPhase::pulling);
  EXPECT_EQ(person.side(), Side::left);
  EXPECT_LT(fastest, 2.5) << "a hand jumps";
}

TEST(SimPerson, what_the_robot_has_only_begun_to_lift_is_not_reached_for) {
  PersonModel person(taker());
  PersonView view = offer({0.95, 0.05, 1.0});
  view.held_by_robot = false;
  step_for(person, view, 0.5);
  view.held_by_robot = true;
  step_for(person, view, 1);
  view.T_world_object.translation().z() += 0.05;
  step_for(person, view, 4);
  EXPECT_EQ(person.phase(), PersonPhase::watching);
  view.T_world_object.translation().z() += 0.06;
  step_until(person, view, PersonPhase::pulling, 4);
  EXPECT_EQ(person.phase(), PersonPhase::pulling);
}

/// Returns a person who has pulled an object out of the robot's hand and begins to withdraw; in
/// `view` the robot no longer holds the object.
PersonModel withdrawing_person(const PersonSettings& settings, PersonView& view) {
  PersonModel person(settings);
  step_until(person, view, PersonPhase::pulling, 6);
  view.held_by_robot = false;
  step_until(person, view, PersonPhase::withdrawing, 1);
  EXPECT_EQ(person.phase(), PersonPhase::withdrawing);
  return person;
}

TEST(SimPerson, who_withdraws_gives_way_where_the_object_or_the_hand_is_caught) {
  for (Vector3 PersonView::*const force : {&PersonView::grip_force, &PersonView::arm_force}) {
    PersonView view = offer({0.95, 0.05, 1.05});
    PersonModel person = withdrawing_person(taker(), view);
    step_for(person, view, 0.5);
    const Vector3 caught = person.hand().T_world_body.translation();
    view.*force = Vector3(25, 0, 0);
    step_for(person, view, 0.25);
    const Vector3 eased = person.hand().T_world_body.translation();
    EXPECT_LT(eased.x(), caught.x() - 0.01) << "toward the robot again";
    EXPECT_EQ(person.phase(), PersonPhase::withdrawing);
    (view.*force).setZero();
    step_for(person, view, 2);
    EXPECT_EQ(person.phase(), PersonPhase::keeping);
  }
}

TEST(SimPerson, who_withdraws_is_not_held_back_by_what_the_hand_moves_away_from) {
  PersonView view = offer({0.95, 0.05, 1.05});
  PersonModel person = withdrawing_person(taker(), view);
  view.arm_force = Vector3(-25, 0, 0);
  step_for(person, view, 2.5);
  EXPECT_EQ(person.phase(), PersonPhase::keeping);
}

TEST(SimPerson, who_withdraws_something_long_does_not_press_it_on_the_table) {
  PersonView view = offer({0.95, 0.05, 1.25});
  ObjectModel tall = *view.object;
  for (Vector3& p : tall.mesh.vertices) p.z() -= 0.15;  // 15 cm lower than a mug
  view.object = &tall;
  double lowest = 1e9;
  for (const Vector3& p : tall.mesh.vertices)
    lowest = std::min(lowest, (view.T_world_object * p).z());
  PersonSettings settings = taker();
  settings.furniture = {{make_pose({1.1, 0, (lowest - 0.01) / 2}), {1.4, 1.6, lowest - 0.01}}};
  PersonModel person = withdrawing_person(settings, view);
  const double below = person.hand().T_world_body.translation().z() - lowest;
  for (int i = 0; i < 3000; ++i) {
    person.step(0.001, view);
    const double bottom = person.hand().T_world_body.translation().z() - below;
    ASSERT_GT(bottom, lowest - 0.001) << "toward the table after " << i << " ms";
  }
  EXPECT_EQ(person.phase(), PersonPhase::keeping);
}

TEST(SimPerson, who_hesitates_takes_it_later_and_who_is_early_takes_it_while_it_moves) {
  const auto taken_after = [](const BehaviourProfile& behaviour, double speed) {
    PersonSettings settings;
    settings.feet = Vector3(1.5, 0, 0);
    settings.yaw = M_PI;
    settings.behaviour = behaviour;
    PersonModel person(settings);
    PersonView view = offer({0.95, 0.05, 1.05});
    view.object_velocity = Vector3(speed, 0, 0);
    double clock = 0;
    for (; person.phase() != PersonPhase::pulling && clock < 8; clock += 0.001)
      person.step(0.001, view);
    return clock;
  };
  BehaviourProfile hesitant, early;
  hesitant.hesitation = 1.0;
  early.early = true;
  const double usual = taken_after({}, 0);
  EXPECT_LT(usual, 2.5);
  EXPECT_GT(taken_after(hesitant, 0), usual + 0.9);
  EXPECT_GE(taken_after({}, 0.2), 8) << "who is not early waits for it to stand still";
  EXPECT_LT(taken_after(early, 0.2), 2.5);
}

TEST(SimPerson, looks_at_what_the_robot_holds) {
  PersonSettings settings;
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  PersonModel person(settings);
  const PersonView view = offer({0.3, 0.2, 1.05});
  for (int i = 0; i < 1500; ++i) person.step(0.001, view);
  const Person& body = person.body();
  const Vector3 want = (view.T_world_object.translation() - body.gaze_origin).normalized();
  EXPECT_GT(body.gaze_direction.dot(want), 0.98);
}

TEST(SimPerson, walks_in_from_behind_its_place) {
  PersonSettings settings;
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  settings.approach_from = 1.2;
  PersonModel person(settings);
  EXPECT_NEAR(person.body().joints[joint("waist")].position.x(), 2.7, 0.05);
  for (int i = 0; i < 2500; ++i) person.step(0.001, PersonView{});
  EXPECT_NEAR(person.body().joints[joint("waist")].position.x(), 1.5, 0.05);
  EXPECT_EQ(person.phase(), PersonPhase::watching);
}

TEST(SimPerson, walks_as_fast_as_the_settings_file_says) {
  const handsel::test::TemporaryFolder folder;
  std::filesystem::copy(deploy() / "config/trajectory_controller.txtpb", folder.path());
  folder.write("sim.txtpb", "person_walk_speed: 1.2\n");
  PersonSettings settings = taker();
  settings.approach_from = 1.2;
  const auto arrives_after = [&settings] {
    PersonModel person(settings);
    double clock = 0;
    for (; person.phase() == PersonPhase::arriving && clock < 10; clock += 0.001)
      person.step(0.001, PersonView{});
    return clock;
  };
  EXPECT_NEAR(arrives_after(), 2.0, 0.01);
  settings.manners = load_settings(folder.path()).manners;
  EXPECT_NEAR(arrives_after(), 1.0, 0.01);
}

TEST(SimWorld, who_fetches_a_mug_takes_it_from_where_it_stands_and_goes) {
  config::Scenario scenario = mug_in_hand();
  config::PersonDescription* anna = add_person(scenario, config::FETCHER);
  anna->set_object("mug");
  anna->set_fetches_at(1.0);
  // The arm is raised clear of the person.
  (*scenario.mutable_start())["arm_a2"] = 0.2;
  SimWorld world(jido(), library(), scenario, SimSettings{}, 1);
  GroundTruth ground_truth;
  const Vector3 before = world.T_world_object("mug").translation();
  while (world.time() < 0.95) world.step();
  EXPECT_LT((world.T_world_object("mug").translation() - before).norm(), 0.02) << "not yet";
  while (world.time() < 9) world.step();
  world.ground_truth(ground_truth);
  EXPECT_EQ(ground_truth.carrier, "human");
  EXPECT_FALSE(ground_truth.dropped);
  EXPECT_EQ(world.person_phase(0), PersonPhase::leaving);
  EXPECT_GT((world.T_world_object("mug").translation() - before).norm(), 0.5);
}

TEST(SimWorld, what_a_fetcher_puts_down_stands_where_the_scenario_says) {
  config::Scenario scenario = mug_in_hand();
  config::PersonDescription* anna = add_person(scenario, config::FETCHER);
  anna->set_object("mug");
  anna->set_fetches_at(0.5);
  (*scenario.mutable_start())["arm_a2"] = 0.2;
  const Vector3 p_mug = in_hand();
  const Vector3 goal = p_mug + Vector3(0.05, 0.35, 0);
  config::BoxDescription* bench = scenario.add_boxes();
  bench->set_id("bench");
  bench->set_supports(true);
  bench->mutable_pose()->mutable_xyz()->set_x(goal.x());
  bench->mutable_pose()->mutable_xyz()->set_y(goal.y());
  bench->mutable_pose()->mutable_xyz()->set_z(0.5 * (goal.z() - 0.07));
  bench->mutable_size()->set_x(0.3);
  bench->mutable_size()->set_y(0.3);
  bench->mutable_size()->set_z(goal.z() - 0.07);
  anna->mutable_puts_at()->set_x(goal.x());
  anna->mutable_puts_at()->set_y(goal.y());
  anna->mutable_puts_at()->set_z(goal.z());
  SimWorld world(jido(), library(), scenario, SimSettings{}, 1);
  while (world.time() < 14 && world.person_phase(0) != PersonPhase::putting) world.step();
  ASSERT_EQ(world.person_phase(0), PersonPhase::putting);
  while (world.time() < 18) world.step();
  GroundTruth ground_truth;
  world.ground_truth(ground_truth);
  const Vector3 p = world.T_world_object("mug").translation();
  EXPECT_LT((p - goal).head<2>().norm(), 0.05) << p.transpose();
  EXPECT_EQ(ground_truth.carrier, "surface") << p.transpose() << " for " << goal.transpose();
  EXPECT_FALSE(ground_truth.dropped);
}

TEST(SimWorld, who_fetches_what_is_not_there_is_refused) {
  config::Scenario scenario = mug_in_hand();
  add_person(scenario, config::FETCHER)->set_object("vase");
  try {
    SimWorld(jido(), library(), scenario, SimSettings{}, 1);
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("person anna fetches \"vase\", which is no object of the scenario"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace handsel::sim::sim_person_test
