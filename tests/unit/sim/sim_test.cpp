// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

#include "sim/robot/robot_grasp.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace handsel::sim::sim_test {
namespace {

using namespace test;

SimWorld make(const config::Scenario& scenario, std::uint64_t seed = 1,
              const SimSettings& settings = {}) {
  return {jido(), library(), scenario, settings, seed};
}

Vector start() { return opened(jido().rest_configuration()); }

config::Scenario from_open(config::Scenario scenario) {
  const Vector q = start();
  for (int i = 0; i < jido().dof(); ++i) (*scenario.mutable_start())[jido().axes()[i].name] = q[i];
  return scenario;
}

TEST(SimServo, follows_a_motion_of_all_axes_within_three_milliradians) {
  SimWorld world = make(from_open(config::Scenario{}));
  Driver driver(world, start());
  Vector to = start();
  for (int axis : jido().require_group("arm").axes) to[axis] += 0.4;
  RobotState state;
  double worst = 0;
  driver.move(to, 1.5, [&] {
    world.robot_state(state);
    worst = std::max(worst, (state.position - driver.q()).cwiseAbs().maxCoeff());
  });
  EXPECT_LT(worst, 3e-3);
  driver.hold(0.5);
  world.robot_state(state);
  EXPECT_LT((state.position - to).cwiseAbs().maxCoeff(), 2e-4) << "gravity must not make it sag";
}

TEST(SimServo, reports_efforts_within_the_torque_limits) {
  SimWorld world = make(from_open(config::Scenario{}));
  Driver driver(world, start());
  Vector to = start();
  to[0] += 1.0;
  RobotState state;
  driver.move(to, 0.4, [&] {
    world.robot_state(state);
    for (int i = 0; i < jido().dof(); ++i)
      ASSERT_LE(std::abs(state.effort[i]), 2 * jido().axes()[i].max_effort + 1e-9)
          << jido().axes()[i].name;
  });
}

TEST(SimRobotSide,
     stops_softly_twenty_milliseconds_after_the_last_set_point_and_resumes_with_matching_ones) {
  RobotSide side(jido(), start(), RobotSideSettings{});
  JointCommand c;
  c.position = start();
  c.velocity = c.acceleration = Vector::Zero(jido().dof());
  c.velocity[0] = 0.5;
  double now = 0;
  for (int i = 0; i < 100; ++i, now += 0.001) {
    c.position[0] += 0.0005;
    side.command(c, now);
    side.step(now, 0.001);
  }
  const double last = now - 0.001;
  while (side.follows() && now < last + 1) side.step(now += 0.001, 0.001);
  EXPECT_EQ(side.mode(), DriveMode::enabled) << "nobody has stopped the drives";
  EXPECT_NE(side.refusal().find("no set-point for more than 20 ms"), std::string::npos)
      << side.refusal();
  EXPECT_NEAR(now - last, 0.021, 0.0015);
  const double A = jido().stop_limits().acceleration[0], J = jido().stop_limits().jerk[0];
  const double expected = measure_stop(0.5, 0, A, J).duration;
  const double began = now;
  double v = side.velocity()[0], a = side.acceleration()[0];
  while (!side.stopped() && now < began + 2) {
    side.step(now += 0.001, 0.001);
    ASSERT_LE(std::abs(side.acceleration()[0] - a), J * 0.001 * (1 + 1e-6));
    ASSERT_LE(std::abs(side.velocity()[0] - v), A * 0.001 * (1 + 1e-6));
    v = side.velocity()[0], a = side.acceleration()[0];
  }
  EXPECT_NEAR(now - began, expected, 0.003);
  const Vector held = side.position();
  for (int i = 0; i < 20; ++i)
    EXPECT_FALSE(side.command(c, now += 0.001)) << "set-points that move are not at rest";
  c.velocity.setZero();
  c.position = held;
  c.position[1] += 0.1;
  for (int i = 0; i < 20; ++i)
    EXPECT_FALSE(side.command(c, now += 0.001)) << "the robot is elsewhere";
  c.position = held;
  for (int i = 0; i < 10; ++i) side.command(c, now += 0.001);
  EXPECT_TRUE(side.follows());
  EXPECT_EQ(side.refusal(), "");
}

TEST(SimRobotSide, follows_set_points_at_the_measured_posture_though_the_held_one_is_elsewhere) {
  RobotSide side(jido(), start(), RobotSideSettings{});
  JointCommand c;
  c.position = start();
  c.velocity = c.acceleration = Vector::Zero(jido().dof());
  side.command(c, 0.0);
  double now = 0;
  while (!side.stopped() && now < 1) side.step(now += 0.001, 0.001);
  ASSERT_TRUE(side.stopped());
  Vector bent = side.position();
  bent[3] += 0.05;
  side.measured(bent);
  c.position = bent;
  double v = 0;
  for (int i = 0; i < 2000 && !side.follows(); ++i) {
    side.command(c, now);
    side.step(now += 0.001, 0.001);
    EXPECT_LE(std::abs(side.velocity()[3] - v),
              jido().stop_limits().acceleration[3] * 0.001 * (1 + 1e-6))
        << "the reference does not jump";
    v = side.velocity()[3];
  }
  EXPECT_TRUE(side.follows());
  EXPECT_EQ(side.position()[3], bent[3]);
}

TEST(SimRobotSide, a_user_stop_while_set_points_are_away_still_ends_only_by_enable) {
  RobotSide side(jido(), start(), RobotSideSettings{});
  JointCommand c;
  c.position = start();
  c.velocity = c.acceleration = Vector::Zero(jido().dof());
  side.command(c, 0.0);
  double now = 0;
  while (!side.stopped() && now < 1) side.step(now += 0.001, 0.001);
  side.user_stop();
  EXPECT_EQ(side.refusal(), "") << "the mode says it";
  while (now < 2) {
    side.step(now += 0.001, 0.001);
    EXPECT_FALSE(side.command(c, now));
  }
  EXPECT_EQ(side.mode(), DriveMode::user_stop);
}

TEST(SimRobotSide, a_protective_stop_at_rest_lasts_until_every_process_has_heard_of_it) {
  RobotSide side(jido(), start(), RobotSideSettings{});
  JointCommand c;
  c.position = start();
  c.velocity = c.acceleration = Vector::Zero(jido().dof());
  side.command(c, 0.0);
  side.step(0.001, 0.001);
  side.stop(DriveMode::protective_stop);
  double now = 0.001, ended = 0.0;
  while (side.mode() != DriveMode::enabled && now < 2.0) {
    side.command(c, now);
    side.step(now += 0.001, 0.001);
    ended = now;
  }
  EXPECT_NEAR(ended, RobotSideSettings{}.min_stop, 0.01);
}

TEST(SimRobotSide, user_stop_ends_only_by_enable) {
  RobotSide side(jido(), start(), RobotSideSettings{});
  side.user_stop();
  JointCommand c;
  c.position = start();
  c.velocity = c.acceleration = Vector::Zero(jido().dof());
  double now = 0;
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(side.command(c, now));
    side.step(now += 0.001, 0.001);
  }
  EXPECT_EQ(side.mode(), DriveMode::user_stop);
  side.enable();
  EXPECT_TRUE(side.command(c, now));
}

TEST(SimGrasp, exists_only_while_the_contacts_are_force_closed) {
  SimWorld world = make(from_open(mug_in_hand()));
  Driver driver(world, start());
  driver.hold(0.2);
  EXPECT_FALSE(world.robot_grips());
  driver.move(closed(start()), 1.5);
  driver.hold(0.3);
  ASSERT_GT(world.robot_pressure(), 1.0);
  EXPECT_TRUE(world.robot_grips());
  driver.move(start(), 1.0);
  EXPECT_FALSE(world.robot_grips());
}

TEST(SimGrasp, two_points_do_not_hold_but_two_patches_or_three_points_do) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld dynamics(&dispatcher, &broadphase, &solver, &configuration);
  ShapeStore shapes;
  RobotBody robot(jido(), Pose::Identity(), start(), ServoSettings{}, PadSettings{},
                  BodyWorld{dynamics, shapes, kRobot, kObject});
  RobotGrasp grasp(jido().tool_link(), robot, 0.2, 0.02, 0.05);
  const int palm = grasp.palm();
  const auto touch = [&](double angle, double force, double torsion) {
    const Vector3 outward(std::cos(angle), std::sin(angle), 0);
    Touch t;
    t.a = Owner::robot, t.index_a = palm, t.b = Owner::object, t.index_b = 0;
    t.point = 0.04 * outward, t.normal = outward, t.normal_force = force, t.friction = 0.6,
    t.torsion = torsion;
    return t;
  };
  EXPECT_FALSE(grasp.closed({touch(0, 5, 0), touch(M_PI, 5, 0)}, 0, Vector3::Zero()))
      << "it turns about the line between the points";
  EXPECT_TRUE(grasp.closed({touch(0, 5, 0.003), touch(M_PI, 5, 0.003)}, 0, Vector3::Zero()));
  EXPECT_TRUE(
      grasp.closed({touch(0, 5, 0), touch(2.1, 5, 0), touch(4.2, 5, 0)}, 0, Vector3::Zero()));
  EXPECT_FALSE(
      grasp.closed({touch(0, 5, 0), touch(2.1, 0.1, 0), touch(4.2, 0.1, 0)}, 0, Vector3::Zero()))
      << "two of them hardly touch";
  EXPECT_FALSE(grasp.closed({touch(0, 5, 0.003), touch(0.5, 5, 0.003), touch(-0.5, 5, 0.003)}, 0,
                            Vector3::Zero()))
      << "all from one side";
  EXPECT_FALSE(grasp.closed({touch(0, 5, 0.003), touch(M_PI, 5, 0.003)}, 1, Vector3::Zero()))
      << "another object";
}

TEST(SimGrasp, carries_the_mug_with_help_and_measures_its_weight) {
  config::Scenario scenario = from_open(mug_in_hand());
  scenario.set_help_hold(true);
  SimWorld world = make(scenario);
  Driver driver(world, start());
  driver.move(closed(start()), 1.5);
  driver.move(raised(driver.q()), 2.0);
  driver.hold(1.0);
  const GroundTruth ground_truth = truth_of(world);
  EXPECT_EQ(ground_truth.carrier, "robot");
  EXPECT_NEAR(ground_truth.lifted, 0.15, 0.01);
  EXPECT_FALSE(ground_truth.dropped);
  RobotState state;
  world.robot_state(state);
  EXPECT_NEAR(state.payload, library()("mug")->mass, 0.05);
  const Vector3 force =
      jido().link_pose(driver.q(), jido().tool_link()).linear() * state.wrist_wrench.force;
  EXPECT_NEAR(force.z(), -library()("mug")->mass * 9.81, 0.8);
  EXPECT_LT(std::hypot(force.x(), force.y()), 0.8);
  EXPECT_GT(state.hand_effort, 0.1);
}

/// Grasps, lifts, and opens the hand once someone pulls at the mug with 4 N.
GroundTruth perform(SimWorld& world, double patience = 8) {
  Driver driver(world, start());
  driver.move(closed(start()), 1.5);
  driver.move(raised(driver.q()), 2.0);
  RobotState state;
  Vector3 unpulled = Vector3::Zero();
  bool pulled = false;
  for (int i = 0; i < static_cast<int>(patience * 100) && !pulled; ++i) {
    driver.hold(0.01);
    world.robot_state(state);
    if (i == 20) unpulled = state.wrist_wrench.force;
    pulled = i > 20 && (state.wrist_wrench.force - unpulled).norm() > 4;
  }
  if (pulled) driver.move(opened(driver.q()), 0.8);
  driver.hold(4);
  return truth_of(world);
}

TEST(SimHandover, a_taker_reaches_pulls_and_carries_the_mug_alone) {
  config::Scenario scenario = from_open(mug_in_hand());
  add_person(scenario, config::TAKER);
  SimWorld world = make(scenario);
  const GroundTruth ground_truth = perform(world);
  EXPECT_TRUE(ground_truth.handover_done);
  EXPECT_EQ(ground_truth.carrier, "human");
  EXPECT_GE(ground_truth.max_lifted, 0.10);
  EXPECT_GE(ground_truth.human_contact_before_release, 0.2);
  EXPECT_EQ(world.person_phase(0), PersonPhase::keeping);
  EXPECT_EQ(ground_truth.limit_violations, 0u) << world.first_limit_violation();
}

TEST(SimHandover, fails_with_a_person_who_never_moves) {
  config::Scenario scenario = from_open(mug_in_hand());
  add_person(scenario, config::STILL);
  SimWorld world = make(scenario);
  const GroundTruth ground_truth = perform(world);
  EXPECT_FALSE(ground_truth.handover_done);
  EXPECT_EQ(ground_truth.carrier, "robot");
}

TEST(SimHandover, fails_with_a_robot_that_never_releases) {
  config::Scenario scenario = from_open(mug_in_hand());
  add_person(scenario, config::TAKER);
  scenario.set_robot_never_releases(true);
  SimWorld world = make(scenario);
  const GroundTruth ground_truth = perform(world);
  EXPECT_FALSE(ground_truth.handover_done);
  EXPECT_NE(ground_truth.carrier, "human");
}

TEST(SimWorldTest, same_seed_same_hash_other_seed_other_hash) {
  config::Scenario scenario = from_open(mug_in_hand());
  add_person(scenario, config::TAKER)->set_jitter(0.05);
  const auto run = [&](std::uint64_t seed) {
    SimWorld world = make(scenario, seed);
    Driver driver(world, start());
    driver.move(closed(start()), 1.0);
    RobotState state;
    world.robot_state(state);
    return truth_of(world).hash;
  };
  EXPECT_EQ(run(7), run(7));
  EXPECT_NE(run(7), run(8));
}

TEST(SimWorldTest, a_darting_hand_touches_the_robot_and_the_touch_is_counted) {
  config::Scenario scenario = from_open(config::Scenario{});
  add_person(scenario, config::TAKER);
  SimWorld world = make(scenario);
  Driver driver(world, start());
  driver.hold(0.2);
  EXPECT_EQ(world.control({0, SimAction::person_dart, "anna", 1.5}), "");
  EXPECT_EQ(world.control({0, SimAction::person_dart, "bob", 1.5}), "there is no person bob");
  driver.hold(1.0);
  const GroundTruth ground_truth = truth_of(world);
  EXPECT_LT(ground_truth.min_separation, 0.02);
  EXPECT_GT(ground_truth.peak_closing_speed, 0.8);
  EXPECT_GT(ground_truth.contact_force, 0.0);
  EXPECT_LT(ground_truth.contact_force, 5000.0);
}

TEST(SimWorldTest, hitting_a_table_with_force_is_a_collision_with_a_name) {
  config::Scenario scenario = from_open(mug_in_hand());
  scenario.mutable_boxes(0)->mutable_size()->set_x(0.6);
  const Group& arm = jido().require_group("arm");
  Pose T = jido().link_pose(start(), arm.tip);
  T.translation().z() -= 0.15;
  const auto down = jido().inverse(arm, T, start());
  ASSERT_TRUE(down.has_value());
  const auto push_down = [&](const SimSettings& settings) {
    SimWorld world = make(scenario, 1, settings);
    Driver driver(world, start());
    driver.move(RobotModel::with(start(), arm, *down), 1.0);
    return std::pair(truth_of(world).self_or_scene_collisions, world.last_collision());
  };
  const auto [collisions, name] = push_down({});
  EXPECT_GT(collisions, 0u);
  EXPECT_NE(name.find("hits column"), std::string::npos) << name;
  SimSettings tolerant;
  tolerant.collision_force = 1e6;
  EXPECT_EQ(push_down(tolerant).first, 0u) << "the force is below the setting";
}

TEST(SimSensors, silence_ends_by_itself) {
  config::Scenario scenario = from_open(config::Scenario{});
  add_person(scenario, config::STILL);
  auto* sensor = scenario.add_human_sensors();
  sensor->set_source("kinect");
  sensor->set_rate(30);
  sensor->set_latency(0.04);
  SimWorld world = make(scenario);
  std::vector<Delivery<HumanObservation>> seen;
  const auto count = [&](double seconds) {
    std::size_t n = 0;
    for (int i = 0; i < static_cast<int>(seconds * 1000); ++i) {
      world.step();
      seen.clear();
      world.human_observations(seen);
      n += seen.size();
      for (const auto& d : seen) {
        EXPECT_NEAR(d.due - d.seen, 0.04, 1e-12);
        EXPECT_EQ(d.message.people.size(), 1u);
      }
    }
    return n;
  };
  EXPECT_NEAR(static_cast<double>(count(1.0)), 29, 1.5);
  world.control({0, SimAction::silence_human, "", 0.5});
  EXPECT_EQ(count(0.49), 0u);
  EXPECT_GT(count(0.5), 10u);
}

TEST(SimScenario, what_is_wrong_is_named) {
  const auto sentence = [](config::Scenario scenario) -> std::string {
    scenario.set_name("s");
    try {
      make(scenario);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  config::Scenario s = mug_in_hand();
  s.mutable_objects(0)->set_model("unicorn");
  EXPECT_EQ(
      sentence(s),
      "scenario s: object mug has the unknown model \"unicorn\"; a model is named without "
      "folder and ending, as \"mug\", and searched in the folders of --path and HANDSEL_PATH, "
      "the working directory and objects/");
  s = mug_in_hand();
  s.mutable_objects(0)->set_on("cloud");
  EXPECT_EQ(sentence(s), "scenario s: object mug stands on cloud, which is no box of the scenario");
  s = mug_in_hand();
  (*s.mutable_start())["arm_a9"] = 0;
  EXPECT_EQ(sentence(s), "scenario s: start names joint arm_a9, which robot jido does not have");
  s = mug_in_hand();
  s.add_disturbances()->set_action("earthquake");
  EXPECT_NE(sentence(s).find("disturbance earthquake is unknown; there are pause, resume"),
            std::string::npos);
}

TEST(SimScenario, people_differ_from_trial_to_trial_and_the_same_seed_gives_the_same) {
  config::Scenario s = mug_in_hand();
  s.set_name("s");
  s.clear_people();
  auto& person = *s.add_people();
  person.set_id("anna");
  person.set_x(1.5);
  auto& varies = *person.mutable_varies();
  varies.set_absent(0.25);
  varies.set_place(0.1);
  varies.set_left_handed(0.5);
  varies.set_slowest(0.5);
  varies.set_fastest(2);
  varies.set_seated(0.5);
  varies.set_sidesteps(1);
  varies.set_sidestep(0.3);
  int there = 0, left = 0, seated = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const SceneSetup setup = set_up(s, jido(), library(), 4, {}, seed),
                     again = set_up(s, jido(), library(), 4, {}, seed);
    ASSERT_EQ(setup.people.size(), again.people.size());
    if (setup.people.empty()) continue;
    ++there;
    const PersonSettings &one = setup.people[0].settings, &two = again.people[0].settings;
    EXPECT_EQ(one.feet, two.feet);
    EXPECT_LE((one.feet - Vector3(1.5, 0, 0)).cwiseAbs().maxCoeff(), 0.1);
    EXPECT_GE(one.behaviour.speed_scale, 0.5);
    EXPECT_LE(one.behaviour.speed_scale, 2.0);
    left += one.left_handed;
    seated += one.behaviour.seated;
    EXPECT_TRUE(!one.behaviour.seated || one.behaviour.sidestep.norm() == 0);
    EXPECT_LT(one.behaviour.sidestep.dot(-one.feet), 1e-9) << "toward the robot";
  }
  EXPECT_NEAR(there, 150, 30);
  EXPECT_NEAR(left, there / 2, 30);
  EXPECT_NEAR(seated, there / 2, 30);
  varies.set_seated(1.5);
  EXPECT_THROW(set_up(s, jido(), library(), 4, {}, 1), ConfigError);
}

TEST(SimRobotBody, a_bare_urdf_holds_its_posture_too) {
  const char* data = std::getenv("HANDSEL_DATA");
  if (data == nullptr) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const std::filesystem::path folder = std::filesystem::path(data) / "robots/kuka_lwr4plus";
  std::filesystem::path urdf;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".urdf") urdf = entry.path();
  }
  ASSERT_FALSE(urdf.empty());
  const RobotModel model = RobotModel::load_urdf(urdf);
  SimWorld world(model, library(), config::Scenario{}, SimSettings{}, 1);
  RobotState before, after;
  world.robot_state(before);
  for (int i = 0; i < 1000; ++i) world.step();
  world.robot_state(after);
  EXPECT_LT((after.position - before.position).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(SimPeople, a_giver_offers_before_the_nearer_hand_of_the_robot) {
  const RobotModel duo = RobotModel::load(deploy() / "robots/duo/duo.txtpb");
  for (const char* palm : {"palm", "left_palm"}) {
    const Vector3 p_palm =
        duo.link_pose(duo.rest_configuration(), duo.link_index(palm)).translation();
    config::Scenario scenario = mug_in_hand();
    auto* person = add_person(scenario, config::GIVER);
    person->set_object("mug");
    person->set_x(p_palm.x() + 0.75);
    person->set_y(p_palm.y());
    SimWorld world(duo, library(), scenario, SimSettings{}, 1);
    while (world.time() < 6) world.step();
    EXPECT_EQ(world.person_phase(0), PersonPhase::offering);
    EXPECT_GT((world.T_world_object("mug").translation() - p_palm).norm(), 0.4) << palm;
  }
}

}  // namespace
}  // namespace handsel::sim::sim_test
