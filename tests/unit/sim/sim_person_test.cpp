#include <gtest/gtest.h>

#include <fstream>

#include "common/geometry/segments.hpp"
#include "common/model/object_surface.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace handsel::sim {
namespace {

using namespace test;

std::filesystem::path recording_folder() {
  const char* data = std::getenv("HANDSEL_DATA");
  return data == nullptr ? std::filesystem::path()
                         : std::filesystem::path(data) / "motion/kth_handover/handover_sample";
}

PersonView offer(const Vector3& where) {
  PersonView view;
  view.object = library()("mug");
  view.T_world_object = make_pose(where);
  view.robot_hand = where + Vector3(-0.2, 0, 0);
  view.held_by_robot = true;
  return view;
}

int joint(const char* name) { return body_joint_index(name); }

/// Lets a person live until they are in a phase, `max_time` [s] at most.
void step_until(PersonModel& person, const PersonView& view, PersonPhase phase, double max_time) {
  for (int i = 0; i < 1000 * max_time && person.phase() != phase; ++i) person.step(0.001, view);
}

/// Lets a person live for a while [s].
void step_for(PersonModel& person, const PersonView& view, double time) {
  for (int i = 0; i < 1000 * time; ++i) person.step(0.001, view);
}

/// A person who stands before what offer() offers.
PersonSettings taker() {
  PersonSettings settings;
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  return settings;
}

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
  EXPECT_NEAR(gap, PersonModel::kPalm, 0.013);
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
  const HandShape shape = person.hand_shape(1);
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
          i <
          6000;  // the hold is lost: the person ends with the hand back at rest, or with the mug
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

PersonSettings giver() {
  PersonSettings settings;
  settings.id = "anna";
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  settings.kind = PersonKind::giver;
  return settings;
}

/// What a giver sees while it holds the mug: it goes with the hand.
PersonView holding(const PersonModel& person, const Vector3& robot_hand, bool robot_holds_it) {
  PersonView view = offer(person.hand().T_world_body * Vector3(0.08, 0, 0));
  view.robot_hand = robot_hand;
  view.held_by_robot = view.held_firmly = robot_holds_it;
  return view;
}

void live(PersonModel& person, double seconds, const Vector3& robot_hand,
          bool robot_holds_it = false) {
  for (int i = 0; i < static_cast<int>(seconds * 1000); ++i)
    person.step(0.001, holding(person, robot_hand, robot_holds_it));
}

TEST(SimPerson, who_gives_holds_it_out_toward_the_robot_and_lets_go_once_the_robot_has_it) {
  PersonModel person(giver());
  const Vector3 robot_hand(0.4, 0.3, 1.0);
  const double before = (person.hand().T_world_body.translation() - robot_hand).norm();
  EXPECT_TRUE(person.wants_grip());
  live(person, 3, robot_hand);
  EXPECT_EQ(person.phase(), PersonPhase::offering);
  EXPECT_LT((person.hand().T_world_body.translation() - robot_hand).norm(), before - 0.15);
  live(person, 0.4, robot_hand, true);
  EXPECT_TRUE(person.wants_grip()) << "not at the first touch";
  live(person, 0.3, robot_hand, true);
  EXPECT_FALSE(person.wants_grip());
  live(person, 2, robot_hand, true);
  EXPECT_EQ(person.phase(), PersonPhase::watching);
}

TEST(SimPerson, who_gives_keeps_what_the_robot_only_touches) {
  PersonModel person(giver());
  const Vector3 robot_hand(0.4, 0.3, 1.0);
  live(person, 3, robot_hand);
  for (int i = 0; i < 3000; ++i) {
    PersonView view = holding(person, robot_hand, true);
    view.held_firmly = false;
    person.step(0.001, view);
  }
  EXPECT_TRUE(person.wants_grip());
  live(person, 0.7, robot_hand, true);
  EXPECT_FALSE(person.wants_grip());
}

TEST(SimPerson, giver_takes_back_what_the_robot_hands_back_and_offers_it_when_asked) {
  PersonModel person(giver());
  live(person, 3, {0.4, 0.3, 1.0});
  live(person, 0.7, {0.4, 0.3, 1.0}, true);
  ASSERT_FALSE(person.wants_grip());
  const PersonView view = offer({0.95, 0.05, 1.05});
  for (int i = 0; i < 5000; ++i) person.step(0.001, view);
  ASSERT_EQ(person.phase(), PersonPhase::watching) << "the robot does not hand it back";
  person.announce(Announcement::offers);
  for (int i = 0; i < 6000 && person.phase() != PersonPhase::pulling; ++i) person.step(0.001, view);
  ASSERT_EQ(person.phase(), PersonPhase::pulling);
  person.announce(Announcement::asks);
  live(person, 6, {0.4, 0.5, 1.0});
  EXPECT_EQ(person.phase(), PersonPhase::offering);
}

TEST(SimPerson, giver_who_moves_and_is_ignored_then_holds_it_out_anew_upright) {
  PersonSettings settings = giver();
  settings.moving.duration = 3;
  settings.moving.start_low = settings.moving.next_low = Vector3(0.86, -0.3, 0.9);
  settings.moving.start_high = settings.moving.next_high = Vector3(1.06, 0.3, 1.1);
  settings.moving.spread = 0.1;
  settings.moving.min_speed = settings.moving.max_speed = 0.1;
  settings.moving.min_turn_speed = settings.moving.max_turn_speed = 0.3;
  settings.moving.max_turn = 0.9;
  settings.moving.seed = 3;
  PersonModel person(settings);
  const Vector3 robot_hand(0.3, 0.3, 1.0);
  const auto turn = [&] {
    const Eigen::Quaterniond facing(Eigen::AngleAxisd(settings.yaw, Vector3::UnitZ()));
    return facing.angularDistance(Eigen::Quaterniond(person.hand().T_world_body.linear()));
  };
  live(person, 8, robot_hand);
  EXPECT_GT(turn(), 0.3);
  const Vector3 stays = person.hand().T_world_body.translation();
  live(person, 2, robot_hand);
  EXPECT_LT((person.hand().T_world_body.translation() - stays).norm(), 0.01);
  live(person, 12, robot_hand);
  EXPECT_EQ(person.phase(), PersonPhase::offering);
  EXPECT_LT(turn(), 0.02);
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

TEST(SimPerson, partner_takes_and_gives_back_when_asked_again_and_again) {
  PersonSettings settings = giver();
  settings.feet = Vector3(1.35, 0, 0);
  settings.kind = PersonKind::partner;
  PersonModel person(settings);
  const Vector3 aside(0.4, 0.5, 1.0);
  for (int round = 0; round < 3; ++round) {
    const PersonView view = offer({0.95, 0.05, 1.05});
    for (int i = 0; i < 3000; ++i) person.step(0.001, view);
    ASSERT_EQ(person.phase(), PersonPhase::watching) << "the robot does not offer the mug";
    person.announce(Announcement::offers);
    for (int i = 0; i < 6000 && person.phase() != PersonPhase::pulling; ++i)
      person.step(0.001, view);
    ASSERT_EQ(person.phase(), PersonPhase::pulling) << round;
    live(person, 4, aside);
    EXPECT_EQ(person.phase(), PersonPhase::keeping) << round;
    live(person, 4, aside);
    EXPECT_EQ(person.phase(), PersonPhase::keeping) << "unasked";
    const Vector3 kept = person.hand().T_world_body.translation();

    person.announce(Announcement::asks);
    live(person, 1.5 * settings.reaction, aside);
    person.announce(Announcement::none);
    live(person, 2, aside);
    EXPECT_EQ(person.phase(), PersonPhase::keeping) << "the robot no longer asks";
    const Vector3 moved = person.hand().T_world_body.translation() - kept;
    EXPECT_LT(moved.cwiseProduct(Vector3(0, 1, 1)).norm(), 1e-3);
    EXPECT_LE(std::abs(moved.x()), 0.2) << "no more than the step forward again";

    person.announce(Announcement::asks);
    live(person, 4, aside);
    EXPECT_EQ(person.phase(), PersonPhase::offering) << round;
    EXPECT_GT((person.hand().T_world_body.translation() - kept).norm(), 0.15);
    live(person, 0.8, aside, true);
    person.announce(Announcement::none);
    for (int i = 0; i < 4000; ++i) person.step(0.001, PersonView{});
    EXPECT_EQ(person.phase(), PersonPhase::watching);
    EXPECT_FALSE(person.wants_grip());
    EXPECT_NEAR(person.body().joints[static_cast<std::size_t>(joint("torso"))].position.x(), 1.35,
                0.1)
        << "where it stood at first";
  }
}

TEST(SimPerson, who_gives_never_holds_it_into_the_robots_hand) {
  PersonModel person(giver());
  live(person, 3, {1.0, -0.2, 1.2});
  EXPECT_GT((person.hand().T_world_body.translation() - Vector3(1.0, -0.2, 1.2)).norm(), 0.3);
}

TEST(SimPerson, who_holds_something_keeps_it_above_the_table_they_sit_at) {
  PersonSettings settings = giver();
  settings.behaviour.seated = true;
  PersonModel free(settings);
  const Vector3 where = free.hand().T_world_body.translation();
  EXPECT_LT(where.z(), 0.8);
  const Furniture table{make_pose({where.x() - 0.2, where.y(), 0.36}), {0.5, 0.5, 0.72}},
      far{make_pose({where.x() - 5, 0, 0.36}), {1, 1, 2}},
      shelf{make_pose({where.x(), where.y(), 1.6}), {0.5, 0.5, 0.1}};
  settings.furniture = {far, shelf};
  PersonModel same(settings);
  EXPECT_EQ(same.hand().T_world_body.translation(), where);
  settings.furniture.push_back(table);
  PersonModel person(settings);
  Vector3 before = person.hand().T_world_body.translation();
  for (int i = 0; i < 20000; ++i) {
    person.step(0.001, holding(person, {0.3, 0.4, 1.0}, false));
    const Vector3 hand = person.hand().T_world_body.translation();
    ASSERT_GT(hand.z(), 0.72 + 0.1) << i;
    ASSERT_LT((hand - before).norm(), 0.004) << i;
    before = hand;
  }
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

/// A person who has drawn an object out of the robot's hand and begins to withdraw it; in `view`
/// the robot then holds the object no more.
PersonModel withdrawing_person(const PersonSettings& settings, PersonView& view) {
  PersonModel person(settings);
  step_until(person, view, PersonPhase::pulling, 6);
  view.held_by_robot = false;
  step_until(person, view, PersonPhase::withdrawing, 1);
  EXPECT_EQ(person.phase(), PersonPhase::withdrawing);
  return person;
}

TEST(SimPerson, who_withdraws_gives_way_where_the_object_is_caught) {
  PersonView view = offer({0.95, 0.05, 1.05});
  PersonModel person = withdrawing_person(taker(), view);
  step_for(person, view, 0.5);
  const Vector3 caught = person.hand().T_world_body.translation();
  view.grip_force = Vector3(25, 0, 0);
  step_for(person, view, 0.25);
  const Vector3 eased = person.hand().T_world_body.translation();
  EXPECT_LT(eased.x(), caught.x() - 0.01) << "toward the robot again";
  EXPECT_EQ(person.phase(), PersonPhase::withdrawing);
  view.grip_force.setZero();
  step_for(person, view, 2);
  EXPECT_EQ(person.phase(), PersonPhase::keeping);
}

TEST(SimPerson, who_withdraws_something_long_does_not_press_it_on_the_table) {
  PersonView view = offer({0.95, 0.05, 1.25});
  ObjectModel tall = *view.object;
  for (Vector3& p : tall.mesh.vertices) p.z() -= 0.15;  // 15 cm farther down than a mug
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

TEST(SimPerson, who_is_ignored_comes_nearer_and_holds_it_out_anew_twice) {
  PersonModel person(giver());
  const double before = person.body().joints[joint("torso")].position.x();
  live(person, 40, {0.3, 0, 1.0});
  EXPECT_NEAR(before - person.body().joints[joint("torso")].position.x(), 0.24, 0.03);
  EXPECT_EQ(person.phase(), PersonPhase::offering);
}

TEST(SimPerson, who_is_ignored_steps_nearer_only_where_the_robots_hand_leaves_room) {
  PersonModel person(giver());
  const Vector3 robot_hand(0.66, -0.1, 1.05);
  live(person, 8, robot_hand);
  const auto extension = [&] {
    return (person.hand().T_world_body.translation() -
            person.body().joints[joint("r_shoulder")].position)
        .head<2>()
        .norm();
  };
  const double before = extension();
  double nearest = 1;
  for (int i = 0; i < 40000; ++i) {
    person.step(0.001, holding(person, robot_hand, false));
    nearest = std::min(nearest, (person.hand().T_world_body.translation() - robot_hand).norm());
  }
  EXPECT_GT(nearest, 0.43) << "the object is within the fingers' length of the palm";
  EXPECT_GT(extension(), before - 0.03) << "the arm was bent for a step";
}

/// Whatever the steps of people are to be answered by assumes that a trunk accelerates by at most
/// 10 m/s^2 (StopProofSettings::people).
TEST(SimPerson, a_step_nearer_is_no_faster_than_people_step) {
  PersonModel person(giver());
  Vector3 before = Vector3::Zero();
  double fastest = 0, most = 0;
  for (int i = 0; i < 40000; ++i) {
    person.step(0.001, holding(person, {0.3, 0, 1.0}, false));
    const Vector3 velocity = person.body().joints[joint("torso")].velocity;
    if (i > 1) most = std::max(most, (velocity - before).norm() / 0.001);
    fastest = std::max(fastest, velocity.norm());
    before = velocity;
  }
  EXPECT_LT(most, 4.5);
  EXPECT_GT(fastest, 0.3) << "no step was made";
}

TEST(SimPerson, who_changes_their_mind_draws_it_back_once_and_offers_again) {
  PersonSettings settings = giver();
  settings.behaviour.withdraws = true;
  PersonModel person(settings);
  live(person, 4, {0.4, 0, 1.0});
  ASSERT_EQ(person.phase(), PersonPhase::offering);
  const Vector3 near = person.hand().T_world_body.translation() + Vector3(-0.25, 0, 0);
  live(person, 0.5, near);
  EXPECT_EQ(person.phase(), PersonPhase::keeping);
  EXPECT_TRUE(person.wants_grip());
  live(person, 6, near);
  EXPECT_EQ(person.phase(), PersonPhase::offering) << "and now stays";
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

TEST(SimRecording, the_taker_of_the_kth_sample_faces_forward_and_reaches_with_the_right_hand) {
  if (recording_folder().empty()) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const Recording recording = load_recording(recording_folder());
  EXPECT_EQ(recording.frames.size(), 801u);
  EXPECT_EQ(recording.taking, Side::right);
  EXPECT_NEAR(recording.contact, 3.05, 0.25);
  const BodyPoints& first = recording.frames.front();
  EXPECT_GT(first[joint("l_shoulder")].y(), first[joint("r_shoulder")].y())
      << "left is left of someone who faces +x";
  EXPECT_LT(std::abs(first[joint("l_shoulder")].x() - first[joint("r_shoulder")].x()), 0.02);
  EXPECT_NEAR(first[joint("waist")].head<2>().norm(), 0, 1e-9);
  EXPECT_GT(first[joint("head")].z(), 1.3);
  BodyPoints reaching;
  recording.sample(recording.contact, reaching);
  EXPECT_GT(reaching[joint("r_hand")].x(), 0.45);
}

TEST(SimRecording,
     the_hand_is_warped_by_at_most_ten_centimetres_at_the_end_and_the_feet_by_thirty) {
  if (recording_folder().empty()) GTEST_SKIP() << "HANDSEL_DATA is not set";
  PersonSettings settings;
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  settings.kind = PersonKind::recording;
  settings.recording = std::make_shared<const Recording>(load_recording(recording_folder()));
  const auto recorded_at = [&](double t, const char* name) {
    BodyPoints points;
    settings.recording->sample(t, points);
    return Vector3(settings.feet + Eigen::AngleAxisd(M_PI, Vector3::UnitZ()) * points[joint(name)]);
  };
  const double contact = settings.recording->contact;
  for (const Vector3& off : {Vector3(0.02, 0.03, -0.04), Vector3(0.15, -0.1, 0.0),
                             Vector3(0.2, 0.2, 0.25), Vector3(0.65, 0, 0)}) {
    PersonModel person(settings);
    const PersonView view = offer(recorded_at(contact, "r_hand") + Vector3(-0.07, 0, 0) + off);
    double clock = 0, t = 0, warp = 0, step = 0;
    while (clock < 6 && person.phase() != PersonPhase::closing) {
      person.step(0.001, view);
      clock += 0.001;
      if (person.phase() != PersonPhase::reaching) continue;
      t = std::min(t + 0.001, contact);
      const Vector3 moved = person.body().joints[joint("waist")].position - recorded_at(t, "waist");
      const double bent =
          (person.hand().T_world_body.translation() - recorded_at(t, "r_hand") - moved).norm();
      if (t < contact - settings.warp_time - 0.002) {
        ASSERT_LT(bent, 0.005) << "at " << t;
      }
      warp = std::max(warp, bent);
      step = std::max(step, moved.norm());
    }
    EXPECT_LT(warp, settings.max_warp + 0.005);
    EXPECT_LT(step, 0.305);
    const bool within = off.head<2>().norm() < 0.3 && std::abs(off.z()) < 0.1;
    EXPECT_EQ(person.phase() == PersonPhase::closing, within) << off.transpose();
  }
}

TEST(SimWorld, who_fetches_a_mug_takes_it_from_where_it_stands_and_goes) {
  config::Scenario scenario = mug_in_hand();
  config::PersonDescription* anna = add_person(scenario, config::FETCHER);
  anna->set_object("mug");
  anna->set_fetches_at(1.0);
  // The arm is raised out of the way.
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

class BadRecording : public ::testing::Test {
 protected:
  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("recording_" + std::to_string(getpid()));
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    for (const char* part :
         {"hip", "chest", "neck", "head", "LUArm", "RUArm", "LFArm", "RFArm", "LHand", "RHand"}) {
      const std::string row = std::string("0,") + (part[0] == 'L' ? "0.2" : "-0.2") +
                              (part == std::string("head") ? ",1.65" : ",1") + ",0,0,0,1\n";
      write(part, "x,y,z,q0,q1,q2,q3\n" + row + row);
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& part, const std::string& text) {
    std::ofstream(folder_ / ("taker_" + part + "_pose_saved.csv")) << text;
  }
  std::string sentence() {
    try {
      load_recording(folder_);
    } catch (const std::runtime_error& error) {
      const std::string text = error.what();
      return text.substr(text.rfind('/') == std::string::npos ? 0 : text.rfind('/') + 1);
    }
    return "accepted";
  }
};

TEST_F(BadRecording, names_file_line_and_fault) {
  EXPECT_EQ(sentence(), "accepted");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0,1\n0,0,oops,0,0,0,1\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:3: column 3 is not a finite number");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,nan,0,0,0,1\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:2: column 3 is not a finite number");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0,2\n");
  EXPECT_EQ(sentence(),
            "taker_neck_pose_saved.csv:2: the quaternion's length is 2.000000, must be 1");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:2: expected 7 numbers separated by commas");
  write("neck", "a,b\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:1: the first line must be x,y,z,q0,q1,q2,q3");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0,1\n");
  EXPECT_EQ(sentence(), "taker_neck_pose_saved.csv:2: needs at least two rows");
  write("neck", "x,y,z,q0,q1,q2,q3\n0,0,1,0,0,0,1\n0,0,1,0,0,0,1\n0,0,1,0,0,0,1\n");
  EXPECT_NE(sentence().find("rows, they must agree"), std::string::npos);
  std::filesystem::remove(folder_ / "taker_neck_pose_saved.csv");
  EXPECT_NE(sentence().find("cannot be opened"), std::string::npos);
}

TEST(SimRecording, a_missing_folder_is_missing) {
  EXPECT_THROW(load_recording("no/such/folder"), MissingError);
}

}  // namespace
}  // namespace handsel::sim
