// SPDX-License-Identifier: Apache-2.0
// Grasps chosen for the next step: goal of the object, visibility for a person, places of the
// platform. Checked on the whole robot's links with FCL at configurations found here.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numeric>
#include <random>

#include "common/model/human/holding_hand.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/platform.hpp"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/choice/hand_at_object.hpp"
#include "components/grasp_planner/choice/visibility.hpp"
#include "tests/support/grasp_lists.hpp"

namespace handsel::grasp_planner::grasp_context_test {
namespace {

constexpr double kTop = 0.72;

const HandOnObject& mug() { return hand_on_object("sah", "mug", 60, 144); }
const ObjectModel* library(const std::string& name) { return object_model(name); }

struct Robot {
  std::filesystem::path file = deploy_folder() / "robots/jido/jido.txtpb";
  std::shared_ptr<const RobotModel> model =
      std::make_shared<const RobotModel>(RobotModel::load(file));
  std::shared_ptr<const RobotModel> mobile =
      std::make_shared<const RobotModel>(on_platform(*model, file).value());
  const Group &arm = model->require_group("arm"), &hand = model->require_group("hand");
};
const Robot& robot() {
  static const Robot r;
  return r;
}

Pose standing(double x, double y, double yaw = 0) {
  return make_pose({x, y, kTop + 0.001 + object_model("mug")->height_above_support},
                   Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3::UnitZ())));
}

Scene table_with_mug(double x = 0.68, double y = -0.42) {
  Scene s;
  s.robot_known = true;
  s.robot_position = robot().model->rest_configuration();
  s.boxes.push_back({"table", make_pose({x + 0.17, y - 0.2, 0.5 * kTop}), {0.7, 0.7, kTop}, true});
  s.objects.push_back({"cup", "mug", standing(x, y), Holder::surface, "table", 0});
  return s;
}

GraspRequest request(std::uint32_t max_grasps = 10) {
  GraspRequest r;
  r.object = "cup";
  r.start = robot().model->rest_configuration();
  r.max_grasps = max_grasps;
  return r;
}

HumanState anna(double x, double y) {
  HumanState people;
  Person p;
  p.id = "anna";
  p.joints = standing_body({x, y, 0}, std::atan2(-y, -x), 1.7);
  people.people.push_back(p);
  return people;
}

Choice choose(const GraspRequest& r, const Scene& scene, const HumanState& people = {},
              const settings::GraspPlannerSettings& settings = {}) {
  const GraspChooser chooser(robot().model, mug().hand_geometry, library, settings, "arm",
                             robot().mobile);
  return chooser.choose({r, mug().list, *mug().object, scene, people});
}

std::uint64_t count(const Choice& c, ChoiceReason r) {
  return c.reasons[static_cast<std::size_t>(r)];
}

Vector posture(const Vector& arm_q, const Vector& hand_q) {
  return RobotModel::with(RobotModel::with(robot().model->rest_configuration(), robot().arm, arm_q),
                          robot().hand, hand_q);
}

void expect_hand_at(const Vector& arm_q, const Vector& hand_q, const Pose& T_world_base,
                    const Pose& wanted) {
  const Pose reached =
      T_world_base * robot().model->link_pose(posture(arm_q, hand_q), robot().model->tool_link());
  EXPECT_LT((reached.translation() - wanted.translation()).norm(), 1e-4);
  EXPECT_LT(
      Eigen::AngleAxisd(Eigen::Matrix3d(reached.linear().transpose() * wanted.linear())).angle(),
      1e-3);
}

// Checks a place: motion down, release, retreat of the hand; the only contacts are hand with object
// and object with support.
void expect_put_down(const Choice& c, std::size_t i, const Scene& scene, const Pose& T_world_goal) {
  const Grasp& g = c.grasps[i];
  const PuttingDown& down = c.goals[i];
  Scene put = scene;
  put.objects[0].T_world_object = T_world_goal;
  expect_hand_at(down.at, g.hand_joints, scene.T_world_base, T_world_goal * g.T_object_hand);
  Pose T_above = T_world_goal * g.T_object_hand;
  T_above.translation().z() += 0.12;
  expect_hand_at(down.above, g.hand_joints, scene.T_world_base, T_above);
  CollisionWorld carrying(*robot().model, library), left(*robot().model, library);
  carrying.set_scene(scene);
  carrying.set_attachment({"cup", g.T_object_hand.inverse()}, {});
  left.set_scene(put);
  const Vector above = posture(down.above, g.hand_joints), at = posture(down.at, g.hand_joints);
  const Vector opened = posture(down.at, g.pregrasp_joints),
               off = posture(down.off, g.pregrasp_joints);
  for (int k = 0; k <= 20; ++k) {
    const CollisionVerdict carried = carrying.check(above + k / 20.0 * (at - above));
    EXPECT_TRUE(carried.free) << "carried down, " << k << "/20: " << carried.first << " touches "
                              << carried.second;
    const CollisionVerdict gone = left.check(opened + k / 20.0 * (off - opened));
    EXPECT_TRUE(gone.free) << "leaving, " << k << "/20: " << gone.first << " touches "
                           << gone.second;
  }
}

TEST(Goal, every_grasp_is_free_at_both_ends) {
  const char* asked = std::getenv("HANDSEL_RUNS");
  const int runs = asked != nullptr ? std::max(1, std::atoi(asked)) : 12;
  std::size_t judged = 0, without = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    std::uniform_real_distribution<double> unit(-1, 1);
    Scene scene = table_with_mug();
    // A low and a high obstacle.
    scene.boxes.push_back(
        {"book",
         make_pose({0.8 + 0.2 * unit(random), -0.7 + 0.1 * unit(random), kTop + 0.03}),
         {0.2, 0.15, 0.06},
         true});
    scene.boxes.push_back({"shelf",
                           make_pose({0.85 + 0.1 * unit(random), -0.8, kTop + 0.3}),
                           {0.5, 0.25, 0.03},
                           false});
    GraspRequest r = request(4);
    r.has_goal = true;
    r.T_world_goal =
        standing(0.73 + 0.15 * unit(random), -0.52 + 0.15 * unit(random), 1.2 * unit(random));
    const Choice c = choose(r, scene);
    ASSERT_EQ(c.goals.size(), c.grasps.size());
    if (c.grasps.empty()) ++without;
    CollisionWorld start(*robot().model, library);
    start.set_scene(scene);
    start.set_attachment({}, {"cup"});
    for (std::size_t i = 0; i < c.grasps.size(); ++i, ++judged) {
      const Grasp& g = c.grasps[i];
      SCOPED_TRACE("grasp " + std::to_string(g.id));
      expect_hand_at(g.arm_joints, g.hand_joints, scene.T_world_base,
                     scene.objects[0].T_world_object * g.T_object_hand);
      EXPECT_TRUE(start.check(posture(g.arm_joints, g.hand_joints)).free);
      expect_put_down(c, i, scene, r.T_world_goal);
    }
  }
  std::printf("%zu grasps judged at start and goal; %zu of %d goals with none\n", judged, without,
              runs);
  EXPECT_GE(judged, static_cast<std::size_t>(runs));
}

TEST(Goal, what_serves_at_the_start_may_not_serve_there) {
  const Scene scene = table_with_mug();
  GraspRequest r = request();
  ASSERT_GE(choose(r, scene).grasps.size(), 5U);
  r.has_goal = true;

  r.T_world_goal = standing(2.6, -0.4);
  Choice c = choose(r, scene);
  EXPECT_TRUE(c.grasps.empty());
  EXPECT_GT(count(c, ChoiceReason::goal_out_of_reach), 0U);
  EXPECT_NE(c.why_none(mug().list).find("to be put"), std::string::npos) << c.why_none(mug().list);

  // With the object on its side, every hand from below would be in the table.
  r.T_world_goal = standing(0.72, -0.55);
  r.T_world_goal.linear() = Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitX()).toRotationMatrix();
  r.T_world_goal.translation().z() = kTop + 0.05;
  c = choose(r, scene);
  EXPECT_GT(count(c, ChoiceReason::goal_support), 0U);

  Scene full = scene;
  full.objects.push_back({"other", "can",
                          make_pose({0.75, -0.6, kTop + object_model("can")->height_above_support}),
                          Holder::surface, "table", 0});
  r.T_world_goal = standing(0.77, -0.6);
  c = choose(r, full);
  EXPECT_TRUE(c.grasps.empty());
  EXPECT_GT(count(c, ChoiceReason::goal_taken), 0U);

  // A shelf above blocks the motion down.
  Scene low = scene;
  low.boxes.push_back({"shelf", make_pose({0.9, -0.73, kTop + 0.16}), {0.3, 0.3, 0.02}, false});
  r.T_world_goal = standing(0.82, -0.65);
  ASSERT_FALSE(choose(r, scene).grasps.empty());
  c = choose(r, low);
  EXPECT_TRUE(c.grasps.empty());
  EXPECT_GT(count(c, ChoiceReason::goal_collision) + count(c, ChoiceReason::goal_lowering), 0U);
}

// Returns the visible fraction, from lines of sight sampled in small steps against the links'
// shapes.
double seen_by_steps(const Grasp& g, const Vector3& eye) {
  const HandGeometry& hand_geometry = *mug().hand_geometry;
  std::vector<Pose> T;
  hand_geometry.hand.model().forward(g.hand_joints, T);
  std::size_t facing = 0, seen = 0;
  const auto& points = mug().object->points();
  for (std::size_t i = 0; i < points.size(); i += points.size() / 150 + 1) {
    const Vector3 to_eye = eye - points[i].position, along = to_eye.normalized();
    if (to_eye.dot(points[i].normal) <= 0) continue;
    const Vector3 from = points[i].position + 0.001 * points[i].normal;
    std::vector<SurfaceHit> hits;
    mug().object->triangles().hits(from, along, 0.5, hits);
    if (!hits.empty()) continue;
    ++facing;
    bool hidden = false;
    for (double s = 0; s < 0.35 && !hidden; s += 0.003) {
      const Pose at = make_pose(from + s * along);
      for (std::size_t l = 0; l < T.size() && !hidden; ++l) {
        for (const PlacedShape& shape : hand_geometry.hand.model().links()[l].collision)
          hidden = hidden || shape_distance(Sphere{0.0002}, at, shape.shape,
                                            g.T_object_hand * T[l] * shape.T_parent_shape)
                                 .collide;
      }
    }
    if (!hidden) ++seen;
  }
  return facing == 0 ? 0 : static_cast<double>(seen) / static_cast<double>(facing);
}

TEST(Visibility, is_what_lines_of_sight_past_the_links_say) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<std::vector<Pose>> T_step;
  double difference = 0, lowest = 1, highest = 0;
  int grasps = 0;
  for (std::size_t i = 0; i < mug().list.grasps.size(); i += mug().list.grasps.size() / 8 + 1) {
    const Grasp& g = mug().list.grasps[i].grasp;
    const Vector3 eye = mug().object->box().center() +
                        0.9 * Vector3(normal(random), normal(random), normal(random)).normalized();
    mug().hand_geometry->forward(g.hand_joints, T_step);
    const double seen_fraction = visible_fraction(
        *mug().object, mug().hand_geometry->shape.placed(T_step, g.T_object_hand), eye);
    const double expected = seen_by_steps(g, eye);
    // The sets of points differ.
    EXPECT_NEAR(seen_fraction, expected, 0.18) << "grasp " << g.id;
    difference += std::abs(seen_fraction - expected);
    ++grasps;
    lowest = std::min(lowest, seen_fraction);
    highest = std::max(highest, seen_fraction);
  }
  std::printf("ratios %.2f to %.2f, on average %.3f beside those by steps\n", lowest, highest,
              difference / grasps);
  EXPECT_LT(difference / grasps, 0.07);
  EXPECT_LT(lowest, highest - 0.2);
  // A distant hand hides nothing.
  mug().hand_geometry->forward(mug().list.grasps[0].grasp.hand_joints, T_step);
  EXPECT_EQ(
      visible_fraction(*mug().object,
                       mug().hand_geometry->shape.placed(T_step, make_pose({0, 0, -3})), {0, 0, 2}),
      1.0);
}

TEST(Visibility, of_the_robot_and_of_the_person_filters_and_ranks) {
  const Scene scene = table_with_mug();
  GraspRequest r = request(30);
  const auto lowest = [](const Choice& c) {
    double seen_fraction = 1;
    for (const Grasp& g : c.grasps) seen_fraction = std::min(seen_fraction, g.visible);
    return seen_fraction;
  };
  const auto mean = [](const Choice& c) {
    double sum = 0;
    for (const Grasp& g : c.grasps) sum += g.visible;
    return sum / static_cast<double>(c.grasps.size());
  };
  for (const char* human : {"", "anna"}) {
    SCOPED_TRACE(human);
    r.for_human = human;
    r.min_visible = 0;
    const Choice any = choose(r, scene, anna(1.35, 0.3));
    ASSERT_GE(any.grasps.size(), 10U);
    r.min_visible = 0.5 * (lowest(any) + mean(any));
    EXPECT_LT(lowest(any), r.min_visible);
    const Choice some = choose(r, scene, anna(1.35, 0.3));
    ASSERT_FALSE(some.grasps.empty());
    EXPECT_GE(lowest(some), r.min_visible);
    EXPECT_GT(count(some, ChoiceReason::hidden), 0U);
    r.min_visible = 1;
    const Choice none = choose(r, scene, anna(1.35, 0.3));
    for (const Grasp& g : none.grasps) EXPECT_GE(g.visible, 1);
  }
  settings::GraspPlannerSettings sight;
  sight.rank_visible = 10;
  settings::GraspPlannerSettings blind;
  blind.rank_visible = 0;
  r.min_visible = 0;
  r.for_human = "anna";
  r.max_grasps = 5;
  EXPECT_GT(mean(choose(r, scene, anna(1.35, 0.3), sight)),
            mean(choose(r, scene, anna(1.35, 0.3), blind)));
}

/// Held out by anna at her right hand, toward the robot.
Scene held_out(HumanState& people) {
  Scene scene = table_with_mug();
  people = anna(1.45, 0.0);
  Person& who = people.people.front();
  const auto at = [&](const char* joint) -> Vector3& {
    return who.joints[static_cast<std::size_t>(body_joint_index(joint))].position;
  };
  at("r_hand") = {0.97, 0.0, 1.1};
  at("r_wrist") = {1.05, 0.0, 1.1};
  at("r_elbow") = {1.28, 0.1, 1.1};
  scene.objects[0].T_world_object = make_pose({0.88, 0.0, 1.12});
  scene.objects[0].holder = Holder::human;
  scene.objects[0].holder_id = "anna";
  return scene;
}

TEST(HeldOut, grasps_keep_off_fingers_and_body_of_who_holds_it) {
  HumanState people;
  const Scene scene = held_out(people);
  const Choice c = choose(request(), scene, people);
  ASSERT_FALSE(c.grasps.empty()) << c.why_none(mug().list);
  HumanState around = people;
  around.people.front().inflation = settings::GraspPlannerSettings{}.off_giver - 0.001;
  CollisionWorld body(*robot().model, library);
  body.set_scene(scene);
  body.set_people(around, PeopleParts::without_forearms_and_hands);
  around.people.front() =
      with_fingers_bent(around.people.front(), scene.objects[0].T_world_object.translation());
  around.people.front().inflation = settings::GraspPlannerSettings{}.off_fingers - 0.001;
  CollisionWorld all(*robot().model, library);
  all.set_scene(scene);
  all.set_people(around);
  for (CollisionWorld* world : {&body, &all}) world->set_attachment({}, {scene.objects[0].id});
  for (const Grasp& g : c.grasps) {
    EXPECT_TRUE(body.check_people(posture(g.arm_joints, g.pregrasp_joints)).free) << g.id;
    EXPECT_TRUE(all.check_people(posture(g.arm_joints, g.hand_joints)).free) << g.id;
  }
  settings::GraspPlannerSettings far;
  far.off_giver = 0.6;
  const Choice none = choose(request(), scene, people, far);
  EXPECT_TRUE(none.grasps.empty());
  EXPECT_GT(count(none, ChoiceReason::near_giver), 0U);
}

// Returns a scene in which the palm is beside the lower half of the mug, the fingers along its far
// side, and the digits of that hand in the frame of the mug.
Scene mug_in_fingers(HumanState& people, std::vector<HandPart>& digits) {
  Scene scene = held_out(people);
  Person& giver = people.people.front();
  const Pose& T_world_object = scene.objects[0].T_world_object;
  const auto at = [&](const char* joint) -> Vector3& {
    return giver.joints[static_cast<std::size_t>(body_joint_index(joint))].position;
  };
  at("r_hand") = T_world_object * Vector3(0.04, 0.07, -0.03);
  at("r_wrist") = at("r_hand") + Vector3(0.09, 0.0, 0.0);
  digits = assumed_digits(giver, *object_model("mug"), T_world_object);
  EXPECT_EQ(digits.size(), static_cast<std::size_t>(kDigits * kDigitSegments));
  return scene;
}

// Checks that the robot keeps this distance from the digits [m], with spheres along them as objects
// of the scene.
void expect_clear_of_digits(const Choice& c, const Scene& scene,
                            const std::vector<HandPart>& digits, double distance) {
  const Pose& T_world_object = scene.objects[0].T_world_object;
  Scene with_digits = scene;
  for (const HandPart& part : digits) {
    for (const Vector3& p : {part.a, part.b}) {
      SceneObject ball;
      ball.id = "ball" + std::to_string(with_digits.objects.size());
      ball.T_world_object = T_world_object * Eigen::Translation3d(p);
      const double radius = part.radius + distance - 0.001;
      ball.primitive = {PrimitiveKind::sphere, Vector3::Constant(2 * radius)};
      with_digits.objects.push_back(ball);
    }
  }
  CollisionWorld world(*robot().model, [](const std::string& name) {
    return name.empty() ? nullptr : object_model(name);
  });
  world.set_scene(with_digits);
  world.set_attachment({}, {scene.objects[0].id});
  for (const Grasp& g : c.grasps) {
    for (int k = 0; k <= 4; ++k) {
      const double s = 0.25 * k;
      const Vector closing = g.pregrasp_joints + s * (g.hand_joints - g.pregrasp_joints),
                   coming = g.approach_joints + s * (g.arm_joints - g.approach_joints);
      EXPECT_TRUE(world.check_scene(posture(g.arm_joints, closing)).free) << g.id << " at " << s;
      EXPECT_TRUE(world.check_scene(posture(coming, g.pregrasp_joints)).free)
          << g.id << " at " << s;
    }
  }
}

TEST(HeldOut, grasps_keep_off_the_digits_around_the_object) {
  HumanState people;
  std::vector<HandPart> digits;
  const Scene scene = mug_in_fingers(people, digits);
  const Choice c = choose(request(), scene, people);
  ASSERT_FALSE(c.grasps.empty()) << c.why_none(mug().list);
  expect_clear_of_digits(c, scene, digits, settings::GraspPlannerSettings{}.off_digits);
}

TEST(HeldOut, where_no_grasp_keeps_the_distance_from_the_digits_a_smaller_one_serves) {
  HumanState people;
  std::vector<HandPart> digits;
  const Scene scene = mug_in_fingers(people, digits);
  settings::GraspPlannerSettings settings;
  settings.off_digits = settings.min_off_digits = 0.4;
  const Choice none = choose(request(), scene, people, settings);
  ASSERT_TRUE(none.grasps.empty());
  settings.min_off_digits = 0.01;
  const Choice c = choose(request(), scene, people, settings);
  ASSERT_FALSE(c.grasps.empty()) << c.why_none(mug().list);
  expect_clear_of_digits(c, scene, digits, settings.min_off_digits);
  const auto sum = [](const Choice& of) {
    return std::accumulate(of.reasons.begin(), of.reasons.end(), std::uint64_t{0});
  };
  EXPECT_EQ(sum(c), mug().list.grasps.size()) << "each grasp has one reason";
}

TEST(HeldOut, a_hand_that_touches_only_while_it_closes_is_seen_to_touch) {
  const HandGeometry& geometry = *mug().hand_geometry;
  HandAtObject hand(geometry, *mug().object, 0.0);
  const Person far = anna(9, 9).people.front();
  int cases = 0;
  for (const ListedGrasp& listed : mug().list.grasps) {
    const Grasp& g = listed.grasp;
    const auto at = [&](double closure) {
      std::vector<std::vector<Pose>> T_hand_step;
      geometry.forward(g.pregrasp_joints + closure * (g.hand_joints - g.pregrasp_joints),
                       T_hand_step);
      return T_hand_step;
    };
    const std::vector<std::vector<Pose>> half = at(0.5);
    for (const std::vector<Pose>& finger : half) {
      // A small sphere at the last finger joint, half-way in its motion.
      const Vector3 p = g.T_object_hand * finger.back().translation();
      const HandShape::PlacedHand ball = body_at_object(far, Pose::Identity(), {{p, p, 0.001}});
      const auto touches = [&](double closure) {
        return HandShape::hands_touch(geometry.shape.placed(at(closure), g.T_object_hand), ball, 0);
      };
      if (touches(0) || touches(1)) continue;
      ++cases;
      std::uint64_t tests = 0;
      EXPECT_TRUE(hand.touches(ball, g, tests)) << g.id;
      EXPECT_GT(tests, 2U);
    }
  }
  EXPECT_GT(cases, 0);
}

TEST(HeldOut, weaker_grasps_serve_from_a_hand_only_and_where_few_others_do) {
  HumanState people;
  const Scene held = held_out(people), standing_mug = table_with_mug();
  GraspList list = mug().list;
  list.min_margin = 1000;  // no grasp reaches the min margin
  const auto serving = [&](const Scene& scene, double min_margin, std::size_t min_grasps) {
    settings::GraspPlannerSettings settings;
    settings.min_margin_held = min_margin;
    settings.min_grasps_held = min_grasps;
    const GraspChooser chooser(robot().model, mug().hand_geometry, library, settings, "arm");
    return chooser.choose({request(), list, *mug().object, scene, people}).grasps.size();
  };
  EXPECT_EQ(serving(held, -1000, 0), 0U);
  EXPECT_EQ(serving(held, -1000, 2), 2U);
  EXPECT_EQ(serving(held, 1000, 2), 0U);
  EXPECT_EQ(serving(standing_mug, -1000, 2), 0U) << "nobody holds the mug";
}

TEST(HeldOut, as_shipped_no_grip_that_may_slip_is_used_from_a_hand) {
  HumanState people;
  const Scene scene = held_out(people);
  settings::GraspPlannerSettings settings;
  GraspList list = mug().list;
  list.min_margin = settings.min_margin;
  for (ListedGrasp& listed : list.grasps) listed.grasp.margin = settings.min_margin - 1;
  const auto chosen = [&] {
    const GraspChooser chooser(robot().model, mug().hand_geometry, library, settings, "arm");
    return chooser.choose({request(), list, *mug().object, scene, people}).grasps.size();
  };
  EXPECT_EQ(chosen(), 0U);
  settings.min_margin_held = settings.min_margin - 2;
  EXPECT_GT(chosen(), 0U) << "only the setting excludes them";
}

TEST(HeldOut, a_failed_choice_names_what_the_hand_would_touch) {
  HumanState people;
  const Scene scene = held_out(people);
  settings::GraspPlannerSettings settings;
  settings.off_digits = settings.off_fingers = 0.4;
  settings.off_giver = 0.5;
  const Choice none = choose(request(), scene, people, settings);
  ASSERT_TRUE(none.grasps.empty());
  EXPECT_NE(none.why_none(mug().list).find("(most often the hand and that of anna)"),
            std::string::npos)
      << none.why_none(mug().list);
}

TEST(HeldOut, grasps_that_touch_who_holds_it_cost_no_inverse_kinematics) {
  HumanState people;
  const Scene scene = held_out(people);
  settings::GraspPlannerSettings settings;
  settings.rank_away = -1;  // grasps on the giver's side come first
  settings.rank_stands = 0;
  settings.reach_budget = 60;
  const Choice c = choose(request(), scene, people, settings);
  EXPECT_FALSE(c.grasps.empty()) << c.why_none(mug().list);
  EXPECT_GT(count(c, ChoiceReason::collision), c.reaches);
}

TEST(Platform, drives_to_what_is_out_of_reach_and_stays_clear) {
  const Scene scene = table_with_mug(2.4, 0.3);
  const HumanState people = anna(2.0, 1.2);
  GraspRequest r = request(5);
  EXPECT_TRUE(choose(r, scene, people).grasps.empty());
  r.move_platform = true;
  const auto begin = std::chrono::steady_clock::now();
  const Choice c = choose(r, scene, people);
  std::printf(
      "%zu grasps from elsewhere; %llu places (%llu blocked, %llu near a person, %llu useless), "
      "%llu reaches, %.0f ms\n",
      c.grasps.size(), static_cast<unsigned long long>(c.platform.places),
      static_cast<unsigned long long>(c.platform.blocked),
      static_cast<unsigned long long>(c.platform.near_person),
      static_cast<unsigned long long>(c.platform.useless),
      static_cast<unsigned long long>(c.reaches),
      1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  ASSERT_FALSE(c.grasps.empty()) << c.why_none(mug().list);
  Scene from_world = scene;
  CollisionWorld driven(*robot().mobile, library);
  driven.set_scene(from_world);
  driven.set_people(people);
  for (const Grasp& g : c.grasps) {
    ASSERT_TRUE(g.has_platform);
    const Pose T_world_base =
        make_pose({g.platform.x(), g.platform.y(), 0},
                  Eigen::Quaterniond(Eigen::AngleAxisd(g.platform.z(), Vector3::UnitZ())));
    expect_hand_at(g.arm_joints, g.hand_joints, T_world_base,
                   scene.objects[0].T_world_object * g.T_object_hand);
    const Vector there = with_platform(robot().model->rest_configuration(), T_world_base);
    driven.set_attachment({}, {});
    EXPECT_TRUE(driven.check(there).free);
    EXPECT_GE(driven.distance_to_people(there), 0.5);
    EXPECT_TRUE(
        driven.check(with_platform(posture(g.approach_joints, g.pregrasp_joints), T_world_base))
            .free);
    driven.set_attachment({}, {"cup"});
    const CollisionVerdict grasping =
        driven.check(with_platform(posture(g.arm_joints, g.hand_joints), T_world_base));
    EXPECT_TRUE(grasping.free) << grasping.first << " touches " << grasping.second;
  }
}

TEST(Platform, says_why_it_does_not_drive) {
  GraspRequest r = request(5);
  r.move_platform = true;
  // Grasps are feasible from the present place: the platform stays.
  for (const Grasp& g : choose(r, table_with_mug()).grasps) EXPECT_FALSE(g.has_platform);
  // Walls all around the table.
  Scene walled = table_with_mug(2.4, 0.3);
  for (int k = 0; k < 4; ++k) {
    const double turn = 0.5 * M_PI * k;
    walled.boxes.push_back(
        {"wall " + std::to_string(k),
         make_pose(Vector3(2.57 + 0.5 * std::cos(turn), 0.1 + 0.5 * std::sin(turn), 1),
                   Eigen::Quaterniond(Eigen::AngleAxisd(turn, Vector3::UnitZ()))),
         {0.04, 1.0, 2.0},
         false});
  }
  const Choice none = choose(r, walled);
  EXPECT_TRUE(none.grasps.empty());
  EXPECT_GT(none.platform.blocked, 0U);
  EXPECT_NE(none.why_none(mug().list).find("places of the platform"), std::string::npos)
      << none.why_none(mug().list);
  const GraspChooser fixed(robot().model, mug().hand_geometry, library, {});
  const Choice still = fixed.choose({r, mug().list, *mug().object, table_with_mug(2.4, 0.3), {}});
  EXPECT_TRUE(still.grasps.empty());
  EXPECT_NE(still.why_none(mug().list).find("no platform"), std::string::npos)
      << still.why_none(mug().list);
}

}  // namespace
}  // namespace handsel::grasp_planner::grasp_context_test
