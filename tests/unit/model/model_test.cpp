// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "common/config/resources.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/object_model.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::model_test {
namespace {

const RobotModel& jido() {
  static const RobotModel robot = RobotModel::load(robot_description("jido"));
  return robot;
}

const HandModel& sah() {
  static const HandModel hand = HandModel::load(hand_description("sah"));
  return hand;
}

Vector random_axes(const RobotModel& robot, const Group& group, std::mt19937_64& engine,
                   const Vector& base) {
  Vector q = base;
  for (int a : group.axes)
    q[a] = std::uniform_real_distribution<double>(robot.axes()[a].lower,
                                                  robot.axes()[a].upper)(engine);
  return q;
}

TEST(Jido, has_the_axes_of_arm_hand_and_head_in_order) {
  EXPECT_EQ(jido().dof(), 22);
  EXPECT_EQ(jido().require_group("arm").axes.size(), 7u);
  EXPECT_EQ(jido().require_group("hand").axes.front(), 7);
  EXPECT_EQ(jido().require_group("head").axes.back(), 21);
  EXPECT_EQ(jido().links()[jido().tool_link()].name, "palm");
  EXPECT_EQ(jido().redundancy_axis(), 2);
}

TEST(Jido, flange_is_where_the_arms_kinematics_put_it) {
  Vector q = Vector::Zero(jido().dof());
  q.head<7>() << 0.3, -0.5, 0.7, 1.1, -0.4, 0.6, 0.2;
  std::vector<Pose> T;
  jido().forward(q, T);
  const Pose flange =
      T[jido().link_index("arm_base")].inverse() * T[jido().link_index("arm_link_7")];
  Eigen::Matrix3d R;
  R << 0.270952, -0.855858, 0.440558, 0.562252, 0.512203, 0.649246, -0.781318, 0.071791, 0.619991;
  EXPECT_LT((flange.translation() - Vector3(0.455296, 0.415230, 0.737690)).norm(), 1e-4);
  EXPECT_LT((flange.linear() - R).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Sah, tip_centres_are_those_of_the_hand) {
  const auto tips = [](const Vector& q) {
    std::vector<Pose> T;
    sah().model().forward(q, T);
    std::vector<Vector3> out;
    for (const auto& finger : sah().fingers())
      out.push_back(T[sah().model().link_index(finger.tip_link)].translation());
    return out;
  };
  const auto expect = [](const std::vector<Vector3>& got, const std::vector<Vector3>& want) {
    for (std::size_t i = 0; i < want.size(); ++i)
      EXPECT_LT((got[i] - want[i]).norm(), 5e-4) << sah().fingers()[i].name;
  };
  Vector q = Vector::Zero(13);
  expect(tips(q), {{-0.00145, 0.18532, 0.20668},
                   {-0.003, 0.04475, 0.28256},
                   {-0.003, 0, 0.28736},
                   {-0.003, -0.0446, 0.28257}});
  q << 1.0, 0, 0.3, 0.4, 0.1, 0.5, 0.7, 0.1, 0.5, 0.7, 0.1, 0.5, 0.7;
  expect(tips(q), {{0.07335, 0.07466, 0.22284},
                   {0.08491, 0.03632, 0.21671},
                   {0.08491, -0.00609, 0.22125},
                   {0.08491, -0.04842, 0.21629}});
}

TEST(Sah, distal_joints_follow_middle_joints_one_to_one) {
  const auto& model = sah().model();
  EXPECT_EQ(model.dof(), 13);
  int coupled = 0;
  for (const auto& joint : model.joints()) {
    if (!joint.is_mimic) continue;
    ++coupled;
    EXPECT_EQ(joint.mimic_factor, 1.0);
    EXPECT_EQ(model.axes()[joint.dof].name, joint.name.substr(0, joint.name.find('_')) + "_middle");
  }
  EXPECT_EQ(coupled, 4);
}

TEST(Sah, is_the_hand_jido_carries) {
  const auto& group = jido().require_group("hand");
  ASSERT_EQ(group.axes.size(), sah().model().axes().size());
  for (std::size_t i = 0; i < group.axes.size(); ++i)
    EXPECT_EQ(jido().axes()[group.axes[i]].name, sah().model().axes()[i].name);
  std::vector<Pose> alone, carried;
  Vector q = jido().rest_configuration();
  q.segment(7, 13) = sah().pregrasp();
  sah().model().forward(sah().pregrasp(), alone);
  jido().forward(q, carried);
  const Pose palm = carried[jido().tool_link()];
  for (const auto& finger : sah().fingers()) {
    const Vector3 tip =
        (palm.inverse() * carried[jido().link_index(finger.tip_link)]).translation();
    EXPECT_LT((tip - alone[sah().model().link_index(finger.tip_link)].translation()).norm(), 1e-9);
  }
}

TEST(Jido, rest_posture_is_inside_limits_with_the_hand_in_front) {
  const Vector& q = jido().rest_configuration();
  for (int i = 0; i < jido().dof(); ++i) {
    EXPECT_GE(q[i], jido().axes()[i].lower);
    EXPECT_LE(q[i], jido().axes()[i].upper);
  }
  const Pose palm = jido().link_pose(q, jido().tool_link());
  EXPECT_GT(palm.translation().x(), 0.4);
  EXPECT_GT(palm.translation().z(), 0.9);
  EXPECT_LT(palm.translation().z(), 1.1);
}

TEST(Jido, limits_are_ordered) {
  const auto ordered = [](const Vector& comfort, const Vector& stop, const Vector& guard) {
    EXPECT_TRUE((comfort.array() * 1.1 <= guard.array() * (1 + 1e-9)).all());
    EXPECT_TRUE((stop.array() <= guard.array()).all());
    EXPECT_TRUE((comfort.array() <= stop.array()).all());
  };
  const auto &c = jido().comfort_limits(), &s = jido().stop_limits(), &g = jido().guard_limits();
  ordered(c.velocity, s.velocity, g.velocity);
  ordered(c.acceleration, s.acceleration, g.acceleration);
  ordered(c.jerk, s.jerk, g.jerk);
  for (int i = 0; i < jido().dof(); ++i)
    EXPECT_LE(g.velocity[i], jido().joints()[jido().axes()[i].joint].max_velocity + 1e-9);
}

TEST(Kinematics, jacobian_is_the_derivative_of_forward) {
  std::mt19937_64 engine(11);
  const auto& arm = jido().require_group("arm");
  for (int trial = 0; trial < 20; ++trial) {
    const Vector q = random_axes(jido(), arm, engine, jido().rest_configuration());
    const Eigen::MatrixXd J = jido().jacobian(q, arm);
    const double h = 1e-6;
    for (std::size_t i = 0; i < arm.axes.size(); ++i) {
      Vector low = q, high = q;
      low[arm.axes[i]] -= h;
      high[arm.axes[i]] += h;
      const Pose a = jido().link_pose(low, arm.tip), b = jido().link_pose(high, arm.tip);
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(b.linear() * a.linear().transpose()));
      EXPECT_LT(
          ((b.translation() - a.translation()) / (2 * h) - J.block<3, 1>(0, static_cast<int>(i)))
              .norm(),
          1e-6);
      EXPECT_LT(
          (turn.angle() / (2 * h) * turn.axis() - J.block<3, 1>(3, static_cast<int>(i))).norm(),
          1e-5);
    }
  }
}

TEST(Kinematics, jacobian_of_a_finger_counts_the_coupled_joint) {
  const auto& hand = sah().model();
  const auto& fore = hand.require_group("fore");
  const Vector q = Vector::Constant(hand.dof(), 0.2);
  Vector high = q;
  high[fore.axes[2]] += 1e-6;
  const Vector3 moved =
      (hand.link_pose(high, fore.tip).translation() - hand.link_pose(q, fore.tip).translation()) /
      1e-6;
  EXPECT_LT((moved - hand.jacobian(q, fore).block<3, 1>(0, 2)).norm(), 1e-5);
}

TEST(InverseKinematics, finds_every_reachable_pose_inside_the_limits) {
  constexpr std::uint64_t seed = 21;
  std::mt19937_64 engine(seed);
  const auto& arm = jido().require_group("arm");
  for (int trial = 0; trial < 300; ++trial) {
    const Vector q = random_axes(jido(), arm, engine, jido().rest_configuration());
    const Pose wanted = jido().link_pose(q, arm.tip);
    const auto found = jido().inverse(arm, wanted, jido().rest_configuration());
    ASSERT_TRUE(found.has_value()) << "trial " << trial << " of seed " << seed;
    const Vector full = RobotModel::with(jido().rest_configuration(), arm, *found);
    const Pose got = jido().link_pose(full, arm.tip);
    EXPECT_LT((got.translation() - wanted.translation()).norm(), 2e-5);
    EXPECT_LT(
        Eigen::AngleAxisd(Eigen::Matrix3d(got.linear() * wanted.linear().transpose())).angle(),
        2e-4);
    for (int a : arm.axes) {
      EXPECT_GE(full[a], jido().axes()[a].lower);
      EXPECT_LE(full[a], jido().axes()[a].upper);
    }
  }
}

TEST(InverseKinematics, stays_near_its_seed_for_a_nearby_pose) {
  const auto& arm = jido().require_group("arm");
  Pose wanted = jido().link_pose(jido().rest_configuration(), arm.tip);
  wanted.translation().z() += 0.02;
  const auto found = jido().inverse(arm, wanted, jido().rest_configuration());
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - RobotModel::part(jido().rest_configuration(), arm)).cwiseAbs().maxCoeff(),
            0.1);
}

TEST(InverseKinematics, finds_the_solution_beside_its_seed) {
  constexpr std::uint64_t seed = 33;
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> share(0.12, 0.88), noise(-0.05, 0.05);
  const auto& arm = jido().require_group("arm");
  for (int trial = 0; trial < 200; ++trial) {
    Vector q = jido().rest_configuration(), near = q;
    for (int a : arm.axes) {
      q[a] = jido().axes()[a].lower +
             share(engine) * (jido().axes()[a].upper - jido().axes()[a].lower);
      near[a] = q[a] + noise(engine);
    }
    const auto found = jido().inverse(arm, jido().link_pose(q, arm.tip), near);
    ASSERT_TRUE(found.has_value()) << "trial " << trial << " of seed " << seed;
    EXPECT_LT((*found - RobotModel::part(near, arm)).norm(), 0.6)
        << "trial " << trial << " of seed " << seed;
  }
}

TEST(InverseKinematics, is_numeric_for_other_chains) {
  std::mt19937_64 engine(5);
  const auto& hand = sah().model();
  for (const char* name : {"thumb", "fore"}) {
    const auto& finger = hand.require_group(name);
    for (int trial = 0; trial < 50; ++trial) {
      const Vector q = random_axes(hand, finger, engine, sah().rest());
      const auto found = hand.inverse(finger, hand.link_pose(q, finger.tip), sah().rest());
      ASSERT_TRUE(found.has_value()) << name << " trial " << trial;
      EXPECT_LT((*found - RobotModel::part(q, finger)).cwiseAbs().maxCoeff(), 1e-2)
          << name << " trial " << trial;
    }
  }
}

TEST(InverseKinematics, says_no_out_of_reach) {
  const auto& arm = jido().require_group("arm");
  Pose far = jido().link_pose(jido().rest_configuration(), arm.tip);
  far.translation().x() += 2;
  EXPECT_FALSE(jido().inverse(arm, far, jido().rest_configuration()).has_value());
  far.translation().x() = std::nan("");
  EXPECT_FALSE(jido().inverse(arm, far, jido().rest_configuration()).has_value());
}

TEST(InverseKinematics, is_the_same_for_the_same_seed) {
  const auto& arm = jido().require_group("arm");
  const Pose wanted = make_pose(
      {0.7, -0.3, 0.8}, Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Vector3(1, 1, 0).normalized())));
  const auto first = jido().inverse(arm, wanted, jido().rest_configuration());
  const auto second = jido().inverse(arm, wanted, jido().rest_configuration());
  ASSERT_EQ(first.has_value(), second.has_value());
  if (first) {
    EXPECT_EQ(*first, *second);
  }
}

TEST(RobotModel, forward_reuses_its_output) {
  std::vector<Pose> T;
  jido().forward(jido().rest_configuration(), T);
  const Pose* data = T.data();
  jido().forward(Vector::Zero(jido().dof()), T);
  EXPECT_EQ(T.data(), data);
}

TEST(RobotModel, pairs_disabled_are_adjacent_rigid_or_in_the_srdf) {
  const auto link = [](const char* name) { return jido().link_index(name); };
  EXPECT_TRUE(jido().pair_disabled(link("arm_link_1"), link("arm_link_2")));
  EXPECT_TRUE(jido().pair_disabled(link("base_link"), link("arm_base")));
  EXPECT_TRUE(jido().pair_disabled(link("palm"), link("arm_link_6")));
  EXPECT_FALSE(jido().pair_disabled(link("base_link"), link("palm")));
  EXPECT_FALSE(jido().pair_disabled(link("fore_distal_link"), link("thumb_distal_link")));
}

TEST(ObjectModel, objects_are_closed_and_stand_on_their_lowest_point) {
  for (const char* name : {"mug", "bottle", "can", "box", "ball"}) {
    const auto object = ObjectModel::load(object_description(name));
    EXPECT_EQ(object.name, name);
    EXPECT_GT(object.mass, 0);
    double lowest = 1, volume = 0;
    for (const auto& v : object.mesh.vertices) lowest = std::min(lowest, v.z());
    for (const auto& t : object.mesh.triangles)
      volume += object.mesh.vertices[t[0]].dot(
                    object.mesh.vertices[t[1]].cross(object.mesh.vertices[t[2]])) /
                6;
    EXPECT_NEAR(object.height_above_support, -lowest, 1e-9);
    EXPECT_GT(volume, 1e-5) << name;
  }
}

}  // namespace
}  // namespace handsel::model_test
