// SPDX-License-Identifier: Apache-2.0
// Search of object transfer points: place and pose of a handover.
#include "components/manipulation_planner/handover/otp_search.hpp"

#include <limits>
#include <numbers>

#include "common/model/human/human_wrist.hpp"

#include "tests/support/cost_layer.hpp"
#include "tests/unit/manipulation_planner/manipulation_rig.hpp"
#include "tests/unit/manipulation_planner/partner_grasps.hpp"

namespace handsel::manipulation_planner::otp_search_test {
namespace {

using rig::from_all_sides;
using rig::from_side;
using rig::mirrored;
using rig::Rig;

class OtpSearchTest : public ::testing::Test {
 protected:
  OtpSearch find(const LayersNow& layers = {},
                 const std::vector<settings::PersonProfile>& people = {},
                 const std::vector<PartnerGrasp>& partners = {}, const ReceiverHands& hands = {}) {
    auto many = rig::settings();
    many.w_preference = 0.4;
    many.people = people;
    many.exchange_goals = 20;
    const Pose T_world_mug = rig_.tool() * rig_.T_tool_mug,
               T_tool_mug = make_pose({0.08, 0.02, 0.23});
    const OtpQuery query{rig_.scene, anna_, layers, T_world_mug, T_tool_mug, {}, partners, hands};
    return find_otp(*rig_.robot, rig_.robot->require_group("arm"), query, rig_.q, many);
  }
  Rig rig_;
  Person& anna_{rig_.people.people[0]};
};

TEST_F(OtpSearchTest, places_under_a_table_are_none) {
  const OtpSearch before = find();
  ASSERT_FALSE(before.poses.empty()) << before.reason;
  const double middle = before.poses.front().T_world_object.translation().z();
  rig_.scene.boxes.push_back(
      {"high table", make_pose({0.95, 0, middle + 0.1}), {0.9, 2, 0.04}, true});
  const OtpSearch search = find();
  for (const OtpPose& pose : search.poses)
    EXPECT_GT(pose.T_world_object.translation().z(), middle + 0.1) << "under or in the table";
}

TEST_F(OtpSearchTest, is_where_the_profile_of_the_person_says) {
  const auto across_and_away = [&](const settings::PersonProfile& profile) {
    const OtpSearch search = find({}, {profile});
    EXPECT_FALSE(search.poses.empty()) << search.reason;
    const auto joint = [&](const char* name) {
      return anna_.joints[static_cast<std::size_t>(body_joint_index(name))].position;
    };
    const Vector3 from_torso = search.poses.front().T_world_object.translation() - joint("torso");
    return std::pair(from_torso.dot((joint("l_shoulder") - joint("r_shoulder")).normalized()),
                     from_torso.head<2>().norm());
  };
  settings::PersonProfile profile;
  profile.id = anna_.id;
  profile.handed = settings::Handedness::left;
  EXPECT_GT(across_and_away(profile).first, -1e-6);
  profile.handed = settings::Handedness::right;
  EXPECT_LT(across_and_away(profile).first, 1e-6);
  profile.handed = settings::Handedness::either;
  profile.preferred_distance = 0.45;
  const double near = across_and_away(profile).second;
  profile.preferred_distance = 0.8;
  EXPECT_GT(across_and_away(profile).second, near + 0.05);
  const double usual = find().poses.front().cost;
  profile.id = "somebody else";
  EXPECT_EQ(find({}, {profile}).poses.front().cost, usual);
}

TEST_F(OtpSearchTest, turns_the_object_so_that_the_wrist_of_the_person_is_comfortable) {
  const OtpSearch without = find();
  ASSERT_FALSE(without.poses.empty()) << without.reason;
  EXPECT_FALSE(without.poses.front().partner);
  const auto arm = human_arm(anna_, Side::right);
  ASSERT_TRUE(arm);
  int fitting = 0, better = 0;
  for (int k = 0; k < 8; ++k) {
    const PartnerGrasp partner = from_side(2 * std::numbers::pi * k / 8);
    const OtpSearch with = find({}, {}, {partner});
    ASSERT_FALSE(with.poses.empty()) << with.reason;
    const OtpPose& pose = with.poses.front();
    if (!pose.partner) continue;  // beside the robot's hand: out of the person's reach
    ++fitting;
    EXPECT_EQ(pose.partner->id, 7U);
    EXPECT_TRUE(pose.partner->T_world_wrist.isApprox(pose.T_world_object * partner.T_object_wrist));
    const auto before =
        wrist_posture(*arm, without.poses.front().T_world_object * partner.T_object_wrist);
    const double strain_before = before ? before->strain : std::numeric_limits<double>::infinity();
    EXPECT_LE(pose.partner->strain, strain_before + 1e-9) << "side " << k;
    better += pose.partner->strain < strain_before - 0.05;
  }
  EXPECT_GE(fitting, 4);
  EXPECT_GE(better, 2) << "the grasp of the person has no influence";
}

TEST_F(OtpSearchTest, takes_the_grasp_of_the_person_that_strains_the_wrist_least) {
  std::vector<PartnerGrasp> partners;
  for (int k = 0; k < 8; ++k) {
    partners.push_back(from_side(2 * std::numbers::pi * k / 8));
    partners.back().id = static_cast<std::uint64_t>(k);
  }
  const OtpSearch search = find({}, {}, partners);
  ASSERT_FALSE(search.poses.empty()) << search.reason;
  const OtpPose& pose = search.poses.front();
  ASSERT_TRUE(pose.partner);
  const auto arm = human_arm(anna_, Side::right);
  EXPECT_EQ(pose.partner->side, Side::right);
  for (const PartnerGrasp& partner : partners)
    if (const auto wrist = wrist_posture(*arm, pose.T_world_object * partner.T_object_wrist)) {
      EXPECT_GE(wrist->strain, pose.partner->strain - 1e-9) << partner.id;
    }
}

TEST_F(OtpSearchTest, a_left_hand_strains_as_its_mirror_image_does) {
  // Anna is symmetric about the x-z plane of the world.
  const std::vector<TakingArm> arms = taking_arms(anna_, {}, rig::settings());
  ASSERT_EQ(arms.size(), 2U);
  EXPECT_EQ(arms[0].hand_cost, 0);
  EXPECT_GT(arms[1].hand_cost, 0) << "most people take with the right hand";
  int fitting = 0;
  for (int k = 0; k < 8; ++k) {
    const PartnerGrasp right = from_side(2 * std::numbers::pi * k / 8);
    const Pose T_right = make_pose({1.0, 0.15, 1.15}), T_left = make_pose({1.0, -0.15, 1.15});
    const auto by_right = easiest_partner({arms[0]}, {right}, T_right),
               by_left = easiest_partner({arms[1]}, {mirrored(right)}, T_left);
    ASSERT_EQ(by_right.has_value(), by_left.has_value());
    if (!by_right) continue;
    ++fitting;
    EXPECT_NEAR(by_right->strain, by_left->strain, 1e-3);
    EXPECT_EQ(by_right->side, Side::right);
    EXPECT_EQ(by_left->side, Side::left);
    EXPECT_FALSE(easiest_partner({arms[0]}, {mirrored(right)}, T_left));
  }
  EXPECT_GE(fitting, 3);
}

TEST_F(OtpSearchTest, an_arm_across_the_body_strains_more_than_one_before_its_shoulder) {
  const auto arm = human_arm(anna_, Side::right);
  ASSERT_TRUE(arm);
  const auto posture_at = [&](double aside) {
    Pose T_world_wrist = make_pose(arm->shoulder + Vector3(-0.35, aside, -0.3));
    // Fingers away from the shoulder, thumb up.
    const Vector3 fingers = Vector3(-0.35, aside, 0).normalized();
    T_world_wrist.linear() << fingers.cross(-Vector3::UnitZ()), Vector3::UnitZ(), fingers;
    return wrist_posture(*arm, T_world_wrist);
  };
  // She faces -x: her right shoulder is at +y.
  const auto before = posture_at(0), across = posture_at(-0.25);
  ASSERT_TRUE(before && across);
  EXPECT_GT(across->adduction, before->adduction + 0.1);
  EXPECT_GE(across->strain, across->adduction / kWristRanges.adduction - 1e-9);
  EXPECT_GT(across->strain, before->strain + 0.05);
}

TEST_F(OtpSearchTest, the_hand_that_is_ready_changes_the_exchange_point_and_the_wrist) {
  const std::vector<PartnerGrasp> partners = from_all_sides();
  const auto plan = [&](Side ready) {
    ReceiverHands hands;
    hands.ready = ready;
    const OtpSearch search = find({}, {}, partners, hands);
    EXPECT_FALSE(search.poses.empty()) << search.reason;
    return search.poses.front();
  };
  const OtpPose right = plan(Side::right), left = plan(Side::left);
  ASSERT_TRUE(right.partner);
  ASSERT_TRUE(left.partner);
  EXPECT_EQ(right.partner->side, Side::right);
  EXPECT_EQ(left.partner->side, Side::left);
  EXPECT_FALSE(left.T_world_object.isApprox(right.T_world_object, 1e-3)) << "the same pose";
  EXPECT_GT((left.partner->T_world_wrist.translation() - right.partner->T_world_wrist.translation())
                .norm(),
            0.05);
  // A pose planned for one hand has more strain for the other.
  const auto strain = [&](Side ready, const OtpPose& pose) {
    ReceiverHands hands;
    hands.ready = ready;
    const auto partner =
        easiest_partner(taking_arms(anna_, hands, rig::settings()), partners, pose.T_world_object);
    return partner ? partner->strain + partner->hand_cost : 2.0;
  };
  EXPECT_GT(strain(Side::left, right), left.partner->strain);
  EXPECT_GT(strain(Side::right, left), right.partner->strain);
}

TEST_F(OtpSearchTest, a_hand_that_holds_something_takes_nothing) {
  ReceiverHands hands;
  hands.right_free = false;
  const OtpSearch search = find({}, {}, from_all_sides(), hands);
  ASSERT_FALSE(search.poses.empty()) << search.reason;
  for (const OtpPose& pose : search.poses) {
    if (pose.partner) {
      EXPECT_EQ(pose.partner->side, Side::left);
    }
    EXPECT_LT(arm_comfort_cost(anna_, Side::left, pose.T_world_object.translation()), 1);
  }
  hands.left_free = false;
  EXPECT_TRUE(taking_arms(anna_, hands, rig::settings()).empty());
}

TEST_F(OtpSearchTest, the_ready_hand_is_the_one_extended_toward_the_robot) {
  const settings::ManipulationPlannerSettings settings = rig::settings();
  const auto hands = [&](const ReceiverHands* before) {
    return hands_of(anna_, rig_.scene, Vector3::Zero(), settings, before);
  };
  const auto hand = [&](const char* name) -> Vector3& {
    return anna_.joints[static_cast<std::size_t>(body_joint_index(name))].position;
  };
  EXPECT_FALSE(hands(nullptr).ready) << "both hang";
  const Vector3 hanging = hand("l_hand");
  hand("l_hand") += Vector3(-0.3, 0, 0.3);
  const ReceiverHands left = hands(nullptr);
  EXPECT_EQ(left.ready, Side::left);
  hand("l_hand") = hanging;
  EXPECT_EQ(hands(&left).ready, Side::left) << "until the other is ready";
  hand("r_hand") += Vector3(-0.3, 0, 0.3);
  EXPECT_EQ(hands(&left).ready, Side::right);
  rig_.scene.objects.push_back(
      {"phone", "", make_pose(hand("r_hand")), Holder::human, anna_.id, 0});
  EXPECT_FALSE(hands(&left).right_free);
  EXPECT_TRUE(hands(&left).left_free);
  EXPECT_EQ(hands(&left).ready, Side::left) << "the right hand is busy";
}

TEST_F(OtpSearchTest, behind_a_wall_there_is_none_and_the_reason_says_so) {
  ASSERT_FALSE(find().poses.empty());
  rig_.scene.boxes.push_back({"glass", make_pose({1.2, 0, 1}), {0.02, 4, 3}, false});
  const OtpSearch search = find();
  EXPECT_TRUE(search.poses.empty());
  EXPECT_NE(search.reason.find("behind furniture"), std::string::npos) << search.reason;
}

TEST_F(OtpSearchTest, keeps_off_what_a_layer_from_outside_forbids_and_costs) {
  const OtpSearch before = find();
  ASSERT_FALSE(before.poses.empty());
  const Vector3 best = before.poses.front().T_world_object.translation(), room(3, 3, 3),
                near(0.12, 0.12, 0.12);
  for (const std::uint8_t value : {std::uint8_t{254}, std::uint8_t{255}}) {
    LayersNow layers;
    layers.outside = {std::make_shared<const CostGrid>(
        test::box_layer("crowd", best - room, best + room, best - near, best + near, value, 5))};
    const OtpSearch search = find(layers);
    ASSERT_FALSE(search.poses.empty()) << search.reason;
    EXPECT_FALSE(
        ((search.poses.front().T_world_object.translation() - best).cwiseAbs() - near).maxCoeff() <
        0);
  }
  LayersNow everywhere;
  everywhere.outside = {std::make_shared<const CostGrid>(
      test::box_layer("crowd", best - room, best + room, best - room, best + room, 255, 1))};
  const OtpSearch nowhere = find(everywhere);
  EXPECT_TRUE(nowhere.poses.empty());
  EXPECT_NE(nowhere.reason.find("forbidden by a cost layer"), std::string::npos) << nowhere.reason;
}

TEST_F(OtpSearchTest, poses_are_sorted_apart_and_cost_what_they_are_said_to_cost) {
  const OtpSearch search = find();
  ASSERT_GT(search.poses.size(), 1u) << search.reason;
  const Pose T_world_mug = rig_.tool() * rig_.T_tool_mug,
             T_tool_mug = make_pose({0.08, 0.02, 0.23});
  const LayersNow layers;
  auto many = rig::settings();
  many.w_preference = 0.4;
  const OtpQuery query{rig_.scene, anna_, layers, T_world_mug, T_tool_mug, {}, {}};
  for (std::size_t i = 0; i < search.poses.size(); ++i) {
    const OtpPose& pose = search.poses[i];
    const std::optional<double> cost = otp_cost(query, pose.T_world_object, many);
    ASSERT_TRUE(cost);
    EXPECT_DOUBLE_EQ(*cost, pose.cost);
    const Vector q = RobotModel::with(rig_.q, rig_.robot->require_group("arm"), pose.arm_joints);
    const Pose T_reached = rig_.robot->link_pose(q, rig_.robot->tool_link()) * T_tool_mug;
    EXPECT_LT((T_reached.translation() - pose.T_world_object.translation()).norm(), 1e-3);
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_LE(search.poses[k].cost, pose.cost);
      const Vector3 between =
          search.poses[k].T_world_object.translation() - pose.T_world_object.translation();
      EXPECT_GE(between.norm(), 0.05);
    }
  }
}

TEST_F(OtpSearchTest, a_finger_in_the_direction_of_the_pull_makes_a_pose_impossible) {
  const OtpSearch search = find();
  ASSERT_FALSE(search.poses.empty()) << search.reason;
  const Pose T_world_mug = rig_.tool() * rig_.T_tool_mug,
             T_tool_mug = make_pose({0.08, 0.02, 0.23});
  const LayersNow layers;
  const Pose& T_best = search.poses.front().T_world_object;
  const Vector3 torso = anna_.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  Vector3 to_person = torso - rig_.scene.T_world_base.translation();
  to_person.z() = 0;
  const std::vector<Vector3> barred{T_best.linear().transpose() * to_person.normalized()};
  const OtpQuery query{rig_.scene, anna_, layers, T_world_mug, T_tool_mug, barred, {}};
  EXPECT_FALSE(otp_cost(query, T_best, rig::settings()));
}

TEST_F(OtpSearchTest, alternatives_cost_no_more_than_the_setting_allows) {
  const Pose T_world_mug = rig_.tool() * rig_.T_tool_mug,
             T_tool_mug = make_pose({0.08, 0.02, 0.23});
  const LayersNow layers;
  const OtpQuery query{rig_.scene, anna_, layers, T_world_mug, T_tool_mug, {}, {}};
  auto settings = rig::settings();
  settings.exchange_goals = 20;
  std::size_t before = 0;
  for (const double extra : {0.0, 0.05, 0.3}) {
    settings.otp_extra_cost = extra;
    const OtpSearch search =
        find_otp(*rig_.robot, rig_.robot->require_group("arm"), query, rig_.q, settings);
    ASSERT_FALSE(search.poses.empty()) << search.reason;
    for (const OtpPose& pose : search.poses)
      EXPECT_LE(pose.cost, search.poses.front().cost + extra);
    EXPECT_GT(search.poses.size(), before) << extra;
    before = search.poses.size();
  }
}

TEST_F(OtpSearchTest, poses_from_which_the_hand_cannot_retreat_are_left_out) {
  auto settings = rig::settings();
  settings.exchange_goals = 20;
  settings.otp_extra_cost = 10;
  settings.min_retreat = 0.25;
  const Pose T_world_mug = rig_.tool() * rig_.T_tool_mug,
             T_tool_mug = make_pose({0.08, 0.02, 0.23});
  const LayersNow layers;
  const Vector3 back = -Vector3::UnitZ();
  const Group& arm = rig_.robot->require_group("arm");
  const auto count_confined = [&](const OtpSearch& search) {
    return std::count_if(search.poses.begin(), search.poses.end(), [&](const OtpPose& pose) {
      Pose T = rig_.scene.T_world_base.inverse() * pose.T_world_object * T_tool_mug.inverse();
      T.translation() += settings.min_retreat * (T.linear() * back);
      const Vector from = RobotModel::with(rig_.q, arm, pose.arm_joints);
      IkOptions options;
      options.restarts = 0;
      return !rig_.robot->inverse(arm, T, from, options);
    });
  };
  OtpQuery query{rig_.scene, anna_, layers, T_world_mug, T_tool_mug, {}, {}};
  const OtpSearch any = find_otp(*rig_.robot, arm, query, rig_.q, settings);
  EXPECT_GT(count_confined(any), 0);
  query.back = back;
  const OtpSearch search = find_otp(*rig_.robot, arm, query, rig_.q, settings);
  ASSERT_FALSE(search.poses.empty()) << search.reason;
  EXPECT_EQ(count_confined(search), 0);
  settings.min_retreat = 2;
  const OtpSearch nowhere = find_otp(*rig_.robot, arm, query, rig_.q, settings);
  EXPECT_EQ(nowhere.poses.size(), 1u) << "better than no handover";
}

TEST_F(OtpSearchTest, is_elsewhere_or_turned_after_an_offer_in_vain) {
  auto settings = rig::settings();
  const Pose T_world_mug = rig_.tool() * rig_.T_tool_mug,
             T_tool_mug = make_pose({0.08, 0.02, 0.23});
  const LayersNow layers;
  const Group& arm = rig_.robot->require_group("arm");
  OtpQuery query{rig_.scene, anna_, layers, T_world_mug, T_tool_mug, {}, {}};
  const auto best = [&]() -> Pose {
    const OtpSearch search = find_otp(*rig_.robot, arm, query, rig_.q, settings);
    EXPECT_FALSE(search.poses.empty()) << search.reason;
    return search.poses.empty() ? Pose::Identity() : search.poses.front().T_world_object;
  };
  const auto is_near = [&](const Pose& a, const Pose& b) {
    const Eigen::Matrix3d R = a.linear().transpose() * b.linear();
    return (a.translation() - b.translation()).norm() < settings.vain_offer_range &&
           Eigen::AngleAxisd(R).angle() < settings.vain_offer_turn;
  };
  for (int offers = 0; offers < 3; ++offers) {
    const Pose next = best();
    for (const Pose& before : query.vain_offers) EXPECT_FALSE(is_near(before, next)) << offers;
    const auto cost = otp_cost(query, next, settings);
    query.vain_offers.push_back(next);
    const auto repeated = otp_cost(query, next, settings);
    ASSERT_TRUE(cost && repeated);
    EXPECT_NEAR(*repeated - *cost, settings.w_vain_offer, 1e-9);
  }
  settings.w_vain_offer = 0;
  EXPECT_TRUE(is_near(best(), query.vain_offers.front()));
}

TEST_F(OtpSearchTest, is_shifted_as_asked_for_but_never_to_where_there_is_no_exchange_point) {
  const auto settings = rig::settings();
  const Pose T_world_mug = rig_.tool() * rig_.T_tool_mug,
             T_tool_mug = make_pose({0.08, 0.02, 0.23});
  const LayersNow layers;
  const Group& arm = rig_.robot->require_group("arm");
  const OtpQuery query{rig_.scene, anna_, layers, T_world_mug, T_tool_mug, {}, {}};
  const OtpSearch search = find_otp(*rig_.robot, arm, query, rig_.q, settings);
  ASSERT_FALSE(search.poses.empty()) << search.reason;
  const Pose chosen = search.poses.front().T_world_object;
  const auto shifted_by = [&](const Vector3& shift) {
    const Vector3 p_wanted = chosen.translation() + shift;
    return shifted_otp(*rig_.robot, arm, query, {chosen, p_wanted}, rig_.q, settings);
  };
  int followed = 0, refused = 0;
  for (const Vector3& direction : {Vector3(0, 1, 0), Vector3(0, -1, 0), Vector3(0, 0, -1),
                                   Vector3(1, 0, 0), Vector3(0, 0, 1)}) {
    for (const double length : {0.08, 0.3, 1.2}) {
      const OtpSearch shifted = shifted_by(length * direction);
      refused += shifted.poses.empty();
      EXPECT_EQ(shifted.poses.empty(), !shifted.reason.empty());
      if (shifted.poses.empty()) continue;
      const OtpPose& pose = shifted.poses.front();
      EXPECT_TRUE(otp_cost(query, pose.T_world_object, settings));
      const Vector3 moved = pose.T_world_object.translation() - chosen.translation();
      EXPECT_NEAR(moved.normalized().dot(direction), 1, 1e-9);
      EXPECT_LE(moved.norm(), length + 1e-9);
      EXPECT_GT((chosen.linear().transpose() * pose.T_world_object.linear()).trace(), 2 - 1e-9)
          << "turned by more than 60 degrees";
      const Vector q = RobotModel::with(rig_.q, arm, pose.arm_joints);
      const Pose T_object =
          rig_.scene.T_world_base * rig_.robot->link_pose(q, rig_.robot->tool_link()) * T_tool_mug;
      EXPECT_LT((T_object.translation() - pose.T_world_object.translation()).norm(), 1e-3);
      followed += std::abs(moved.norm() - length) < 1e-9;
    }
  }
  EXPECT_GE(followed, 2) << "asked for places that are good";
  EXPECT_GE(refused, 1) << "asked for places out of reach";
  rig_.scene.boxes.push_back(
      {"screen", make_pose(chosen.translation() + Vector3(0, 0.1, 0)), {0.6, 0.06, 1.5}, false});
  EXPECT_TRUE(shifted_by({0, 0.1, 0}).poses.empty()) << "into or behind the screen";
}

TEST_F(OtpSearchTest, only_a_hand_that_pinches_bars_directions) {
  Grasp grasp;
  grasp.contacts.resize(3);
  for (std::uint32_t i = 0; i < 3; ++i) grasp.contacts[i].finger = i;
  EXPECT_TRUE(barred_directions(grasp).empty());
  grasp.contacts[2].finger = 0;
  EXPECT_EQ(barred_directions(grasp).size(), 3u);
}

TEST_F(OtpSearchTest, arm_comfort_comes_from_the_map_of_that_person) {
  const OtpSearch before = find();
  const Vector3 best = before.poses.front().T_world_object.translation(), room(1, 1, 1);
  Costmap map =
      test::box_layer("arm_comfort", best - room, best + room, best - room, best + room, 255, 1);
  LayersNow layers;
  map.person = "ben";
  layers.comfort = std::make_shared<const CostGrid>(map);
  EXPECT_EQ(find(layers).poses.size(), before.poses.size()) << "somebody else's";
  map.person = anna_.id;
  layers.comfort = std::make_shared<const CostGrid>(map);
  EXPECT_TRUE(find(layers).poses.empty()) << "out of reach everywhere";
}

}  // namespace
}  // namespace handsel::manipulation_planner::otp_search_test
