// SPDX-License-Identifier: Apache-2.0
// Double grasps and regrasp sequences of the robot with two arms on three objects: every step is
// checked by forward kinematics and FCL, and minimality by an exhaustive search of grasps.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/duo_stage.hpp"

namespace handsel::grasp_planner::regrasp_test {
namespace {

const DuoStage& duo() {
  static const DuoStage stage;
  return stage;
}

std::vector<std::string> objects() {
  const char* asked = std::getenv("HANDSEL_OBJECTS");
  if (asked != nullptr && std::string(asked) == "all") return {"bottle", "box", "can"};
  return {"bottle"};
}

const HandOnObject& hand(int arm, const std::string& object) {
  return hand_on_object(arm == 0 ? "sah" : "sah_left", object, 60, 144);
}

void expect_hand_on(int arm, std::size_t grasp, const std::string& object, const Vector& q,
                    const Pose& T_world_object) {
  const Grasp& g = hand(arm, object).list.grasps[grasp].grasp;
  const RegraspArm side = duo().arms(object)[static_cast<std::size_t>(arm)];
  const Pose T = duo().robot.link_pose(q, side.arm.palm), wanted = T_world_object * g.T_object_hand;
  EXPECT_LT((T.translation() - wanted.translation()).norm(), 1e-4);
  EXPECT_LT(Eigen::AngleAxisd(Eigen::Matrix3d(T.linear().transpose() * wanted.linear())).angle(),
            1e-3);
  EXPECT_LT((RobotModel::part(q, *side.arm.fingers) - g.hand_joints).cwiseAbs().maxCoeff(), 1e-12);
}

/// Returns the min distance of the object's surface to the links that `selected` selects, by FCL.
double object_distance(const std::string& object, const Vector& q, const Pose& T_world_object,
                       const std::function<bool(const std::string&)>& selected) {
  const Shape mesh = std::make_shared<TriangleMesh>(hand(0, object).object->mesh());
  std::vector<Pose> T;
  duo().robot.forward(q, T);
  double least = 1;
  for (std::size_t l = 0; l < T.size(); ++l) {
    if (!selected(duo().robot.links()[l].name)) continue;
    for (const PlacedShape& s : duo().robot.links()[l].collision)
      least = std::min(
          least, shape_distance(s.shape, T[l] * s.T_parent_shape, mesh, T_world_object).distance);
  }
  return least;
}

bool is_finger_or_palm(const std::string& link) {
  for (const char* part : {"palm", "thumb", "fore", "middle", "ring"})
    if (link.find(part) != std::string::npos) return true;
  return false;
}

/// Checks the steps in order: the holder of the object and the feasibility of the configurations.
void expect_sequence(const RegraspPlan& plan, const std::string& object, ObjectState state) {
  const RobotModel& robot = duo().robot;
  CollisionWorld world(robot, [](const std::string& name) { return object_model(name); });
  world.set_scene(duo().scene());
  for (const grasp_planner::RegraspStep& s : plan.steps) {
    SCOPED_TRACE(name(s.kind));
    for (int i = 0; i < robot.dof(); ++i) {
      EXPECT_GE(s.q[i], robot.axes()[static_cast<std::size_t>(i)].lower - 1e-9);
      EXPECT_LE(s.q[i], robot.axes()[static_cast<std::size_t>(i)].upper + 1e-9);
    }
    const CollisionVerdict v = world.check(s.q);
    EXPECT_TRUE(v.free) << v.first << " touches " << v.second;
    EXPECT_GT(object_distance(object, s.q, s.T_world_object,
                              [](const std::string& link) { return !is_finger_or_palm(link); }),
              0);
    if (s.kind == RegraspStepKind::pick) {
      EXPECT_EQ(state.arm, -1);
      EXPECT_LT((state.T_world_object.matrix() - s.T_world_object.matrix()).cwiseAbs().maxCoeff(),
                1e-12);
    } else {
      EXPECT_EQ(state.arm, s.from);
      EXPECT_EQ(state.grasp, s.grasp_from);
      expect_hand_on(s.from, s.grasp_from, object, s.q, s.T_world_object);
    }
    if (s.kind == RegraspStepKind::place) {
      state = {-1, {}, s.T_world_object};
      continue;
    }
    expect_hand_on(s.to, s.grasp_to, object, s.q, s.T_world_object);
    // The taking hand is opened, clear of the object, and its approach is free of collision.
    EXPECT_GT(object_distance(object, s.before, s.T_world_object,
                              [&](const std::string& link) {
                                return is_finger_or_palm(link) &&
                                       (link.starts_with("left_") == (s.to == 1));
                              }),
              0.001);
    Vector there =
        RobotModel::with(s.q, *duo().arms(object)[static_cast<std::size_t>(s.to)].arm.fingers,
                         hand(s.to, object).list.grasps[s.grasp_to].grasp.pregrasp_joints);
    for (int n = 0; n <= 4; ++n) {
      const CollisionVerdict way = world.check(s.before + n / 4.0 * (there - s.before));
      EXPECT_TRUE(way.free) << n << "/4 of the way: " << way.first << " touches " << way.second;
    }
    state = {s.to, s.grasp_to, Pose::Identity()};
  }
}

void print(const RegraspPlan& plan, const std::string& object, const char* what) {
  std::printf("%-7s %s:", object.c_str(), what);
  for (const grasp_planner::RegraspStep& s : plan.steps)
    std::printf(" %s%s", name(s.kind),
                s.kind == RegraspStepKind::pass ? (s.to == 1 ? " right to left" : " left to right")
                : s.to == 0 || s.from == 0      ? " right"
                                                : " left");
  std::printf(" (%llu checked, %llu double grasps)\n",
              static_cast<unsigned long long>(plan.checked),
              static_cast<unsigned long long>(plan.double_grasps));
}

/// Whether some grasp of an arm, reached at both places by inverse kinematics alone, would do
/// without passing.
bool one_hand_reaches_both(int arm, const std::string& object, const Pose& a, const Pose& b) {
  const RegraspArm side = duo().arms(object)[static_cast<std::size_t>(arm)];
  return std::any_of(side.list->grasps.begin(), side.list->grasps.end(), [&](const ListedGrasp& g) {
    return duo().robot.inverse(*side.arm.arm, a * g.grasp.T_object_hand,
                               duo().robot.rest_configuration()) &&
           duo().robot.inverse(*side.arm.arm, b * g.grasp.T_object_hand,
                               duo().robot.rest_configuration());
  });
}

TEST(Duo, its_description_lacks_nothing_and_it_is_its_own_mirror_image) {
  const RobotModel& robot = duo().robot;
  const auto arms = manipulators(duo().file, robot);
  ASSERT_EQ(arms.size(), 2U);
  EXPECT_EQ(arms[1].hand, "sah_left");
  Vector q = robot.rest_configuration();
  for (std::size_t i = 0; i < 7; ++i) {
    q[arms[0].arm->axes[i]] += 0.1 * static_cast<double>(i);
    q[arms[1].arm->axes[i]] = -q[arms[0].arm->axes[i]];
  }
  const Pose right = robot.link_pose(q, arms[0].palm), left = robot.link_pose(q, arms[1].palm);
  const Eigen::Matrix3d mirror = Vector3(1, -1, 1).asDiagonal();
  EXPECT_LT((mirror * right.translation() - left.translation()).norm(), 1e-6);
  EXPECT_LT((mirror * right.linear() * mirror - left.linear()).cwiseAbs().maxCoeff(), 1e-6);
  // The chest stays upright for every lean of the torso.
  q[robot.require_group("torso").axes[1]] = 0.7;
  EXPECT_GT(robot.link_pose(q, robot.link_index("chest")).linear()(2, 2), 1 - 1e-9);
}

TEST(Regrasp, from_one_side_of_the_table_to_the_other_the_object_changes_hands_once) {
  for (const std::string& object : objects()) {
    RegraspPlanner planner = duo().planner(object);
    RegraspTask task;
    task.start.T_world_object = DuoStage::standing(object, 0.5, -0.55);
    task.goal.T_world_object = DuoStage::standing(object, 0.5, 0.55);
    const RegraspPlan plan = planner.plan(task);
    ASSERT_TRUE(plan.solved) << object << ": " << plan.reason;
    print(plan, object, "across the table");
    EXPECT_GT(plan.double_grasps, 20U);
    for (int arm = 0; arm < 2; ++arm)
      EXPECT_FALSE(
          one_hand_reaches_both(arm, object, task.start.T_world_object, task.goal.T_world_object));
    ASSERT_GE(plan.steps.size(), 3U);
    EXPECT_LE(plan.steps.size(),
              object == "can" ? 5U : 3U);  // the can has room for few pairs
    for (std::size_t n = 1; n + 1 < plan.steps.size(); ++n)
      EXPECT_EQ(plan.steps[n].kind, RegraspStepKind::pass);
    expect_sequence(plan, object, task.start);
  }
}

TEST(Regrasp, a_hand_changes_its_own_grasp_through_the_other_hand) {
  for (const std::string& object : objects()) {
    RegraspPlanner planner = duo().planner(object);
    // Two grasps with a valid pass, one search each; the second far from the first.
    RegraspTask first;
    first.start.T_world_object = DuoStage::standing(object, 0.5, -0.35);
    first.goal.arm = 1;
    const RegraspPlan picked = planner.plan(first);
    ASSERT_TRUE(picked.solved) << object << ": " << picked.reason;
    RegraspTask task;
    task.start = {0, picked.steps.front().grasp_to, Pose::Identity()};
    const GraspList& list = hand(0, object).list;
    const Pose& held = list.grasps[*task.start.grasp].grasp.T_object_hand;
    RegraspPlan plan;
    int tried = 0;
    for (std::size_t i = 0; i < list.grasps.size() && !plan.solved && tried < 12; ++i) {
      if ((list.grasps[i].grasp.T_object_hand.linear().transpose() * held.linear()).trace() > 1)
        continue;  // turned by less than 90 degrees
      ++tried;
      task.goal = {0, i, Pose::Identity()};
      plan = planner.plan(task);
    }
    ASSERT_TRUE(plan.solved) << object << ": " << plan.reason;
    print(plan, object, "another grasp of the same hand");
    ASSERT_GE(plan.steps.size(), 2U);
    EXPECT_LE(plan.steps.size(), object == "can" ? 4U : 2U);
    for (const grasp_planner::RegraspStep& s : plan.steps) EXPECT_EQ(s.kind, RegraspStepKind::pass);
    EXPECT_EQ(plan.steps.back().grasp_to, *task.goal.grasp);
    expect_sequence(plan, object, task.start);
  }
}

/// Lets a task begin with the grasp by which the right hand picks the object up for the left.
void hold_in_right_hand(RegraspPlanner& planner, const std::string& object, RegraspTask& task) {
  RegraspTask first;
  first.start.T_world_object = DuoStage::standing(object, 0.5, -0.35);
  first.goal.arm = 1;
  const RegraspPlan picked = planner.plan(first);
  ASSERT_TRUE(picked.solved) << picked.reason;
  task.start = {0, picked.steps.front().grasp_to, Pose::Identity()};
}

TEST(Regrasp, what_one_hand_holds_the_other_puts_down_at_any_of_the_places) {
  const std::string object = "bottle";
  RegraspPlanner planner = duo().planner(object);
  RegraspTask task;
  ASSERT_NO_FATAL_FAILURE(hold_in_right_hand(planner, object, task));
  task.goal.T_world_object = DuoStage::standing(object, 3, 0.5);
  const RegraspPlan none = planner.plan(task);
  EXPECT_FALSE(none.solved);
  const Pose T_reached = DuoStage::standing(object, 0.5, 0.5, 1.0);
  task.other_goals = {DuoStage::standing(object, 0.5, 3), T_reached};
  const RegraspPlan plan = planner.plan(task);
  ASSERT_TRUE(plan.solved) << plan.reason;
  print(plan, object, "from the hand to the table");
  ASSERT_EQ(plan.steps.size(), 2U);
  EXPECT_EQ(plan.steps[0].kind, RegraspStepKind::pass);
  EXPECT_EQ(plan.steps[1].kind, RegraspStepKind::place);
  EXPECT_TRUE(plan.steps[1].T_world_object.isApprox(T_reached));
  expect_sequence(plan, object, task.start);
}

TEST(Regrasp, the_one_place_in_reach_is_found_among_a_hundred) {
  const std::string object = "bottle";
  RegraspPlanner planner = duo().planner(object);
  RegraspTask task;
  ASSERT_NO_FATAL_FAILURE(hold_in_right_hand(planner, object, task));
  task.goal.T_world_object = DuoStage::standing(object, 1.5, 0);
  for (int i = 1; i < 100; ++i)
    task.other_goals.push_back(DuoStage::standing(object, 1.5, 0.02 * i));
  task.other_goals.push_back(DuoStage::standing(object, 0.5, 0.5, 1.0));
  const RegraspPlan plan = planner.plan(task);
  print(plan, object, "to the one place in reach");
  ASSERT_TRUE(plan.solved) << plan.reason;
  EXPECT_TRUE(plan.steps.back().T_world_object.isApprox(task.other_goals.back()));
  EXPECT_LT(plan.checked, 300U);
  expect_sequence(plan, object, task.start);
}

TEST(Regrasp, with_one_arm_it_puts_down_and_takes_up_again) {
  const std::string object = "bottle";
  RegraspPlanner planner = duo().planner(object, 1);
  RegraspTask task;
  task.start.T_world_object = DuoStage::standing(object, 0.5, -0.4);
  task.goal.arm = 0;
  const RegraspPlan picked = planner.plan(task);
  ASSERT_TRUE(picked.solved) << picked.reason;
  task.start = {0, picked.steps.front().grasp_to, Pose::Identity()};
  for (const double yaw : {0.0, 1.0, 2.0, -1.0, -2.0, 3.1})
    task.placements.push_back(DuoStage::standing(object, 0.55, -0.35, yaw));
  const GraspList& list = hand(0, object).list;
  RegraspPlan plan;
  for (std::size_t i = 0; i < list.grasps.size() && plan.steps.size() != 2; i += 3) {
    if (i == *task.start.grasp) continue;
    task.goal = {0, i, Pose::Identity()};
    plan = planner.plan(task);
    // For any number of steps: places and picks alternate.
    for (std::size_t n = 0; n < plan.steps.size(); ++n)
      EXPECT_EQ(plan.steps[n].kind, n % 2 == 0 ? RegraspStepKind::place : RegraspStepKind::pick);
    expect_sequence(plan, object, task.start);
  }
  ASSERT_TRUE(plan.solved) << plan.reason;
  print(plan, object, "another grasp, one arm");
  ASSERT_EQ(plan.steps.size(), 2U);
}

TEST(Regrasp, says_what_stands_in_the_way) {
  const std::string object = "bottle";
  RegraspPlanner planner = duo().planner(object, 1);
  RegraspTask task;
  task.start.T_world_object = DuoStage::standing(object, 0.5, -0.4);
  task.goal.T_world_object = make_pose({3, 0, 1});
  const RegraspPlan plan = planner.plan(task);
  EXPECT_FALSE(plan.solved);
  EXPECT_TRUE(plan.steps.empty());
  EXPECT_NE(plan.reason.find("no configuration of the arm reaches it"), std::string::npos)
      << plan.reason;
  ASSERT_FALSE(plan.rejected.empty());
  task.goal.arm = 2;
  EXPECT_THROW(planner.plan(task), ConfigError);
}

TEST(Together, the_tray_is_taken_where_both_hands_bear_it_and_not_when_it_is_heavier) {
  const HandOnObject &right = hand_on_object("sah", "tray", 60, 72),
                     &left = hand_on_object("sah_left", "tray", 60, 72);
  const std::vector<Manipulator> hands = manipulators(duo().file, duo().robot);
  const std::vector<RegraspArm> arms{{hands[0], right.hand_geometry.get(), &right.list},
                                     {hands[1], left.hand_geometry.get(), &left.list}};
  const auto library = [](const std::string& name) { return object_model(name); };
  const Pose T_start = DuoStage::standing("tray", 0.50, 0, M_PI / 2),
             T_goal = DuoStage::standing("tray", 0.60, 0, M_PI / 2);
  RegraspPlanner planner(duo().robot, arms, *right.object, library, duo().scene(), "thing");
  const RegraspPlan plan = planner.plan_together({T_start, T_goal});
  ASSERT_TRUE(plan.solved) << plan.reason;
  ASSERT_EQ(plan.steps.size(), 3U);
  ASSERT_EQ(plan.load_shares.size(), 2U);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_GT(plan.load_shares[a].margin, 0);
    EXPECT_EQ(plan.load_shares[a].effort.size(),
              arms[a].list->grasps[plan.steps[a].grasp_to].grasp.hand_joints.size());
    // The same hand alone, with the load hanging at its side.
    const BearingHand alone{arms[a].hand_geometry,
                            &arms[a].list->grasps[plan.steps[a].grasp_to].grasp};
    const GripLoad load = carried_load(right.object->mass(), T_start.linear(), {});
    EXPECT_LT(share_load({alone}, right.object->com(), load, {}).front().margin, 0);
  }
  ObjectModel heavy = *object_model("tray");
  heavy.mass = 12;
  const Graspable weight(heavy, right.hand_geometry->tip_radius(),
                         GraspListSettings{}.step_fraction, 1);
  const RegraspPlan refused =
      RegraspPlanner(duo().robot, arms, weight, library, duo().scene(), "thing")
          .plan_together({T_start, T_goal});
  EXPECT_FALSE(refused.solved);
  EXPECT_NE(refused.reason.find("bear"), std::string::npos) << refused.reason;
}

}  // namespace
}  // namespace handsel::grasp_planner::regrasp_test
