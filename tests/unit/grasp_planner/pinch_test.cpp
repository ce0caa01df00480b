// SPDX-License-Identifier: Apache-2.0
// Grasp lists of the parallel gripper on the project's objects: every property of a listed grasp,
// checked independently.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner::pinch_test {
namespace {

const std::filesystem::path kDeploy = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";

std::shared_ptr<const HandGeometry> gripper() {
  static const auto hand_geometry = std::make_shared<const HandGeometry>(
      HandModel::load(kDeploy / "hands/parallel/parallel.txtpb"));
  return hand_geometry;
}

ObjectModel object(const std::string& name, double scale = 1) {
  ObjectModel o = ObjectModel::load(kDeploy / "objects" / name / (name + ".txtpb"));
  if (scale == 1) return o;
  for (Vector3& v : o.mesh.vertices) v *= scale;
  o.parts.clear();
  return o;
}

GraspListSettings small_settings() {
  GraspListSettings settings;
  settings.positions = 24;
  settings.orientations = 48;
  return settings;
}

std::shared_ptr<const Graspable> graspable(const ObjectModel& o) {
  return std::make_shared<const Graspable>(o, gripper()->tip_radius(),
                                           small_settings().step_fraction, 1);
}

GraspList list_of(const ObjectModel& o, const GraspListSettings& settings = small_settings()) {
  return list_grasps(gripper(),
                     std::make_shared<const FingerWorkspaces>(make_workspaces(*gripper())),
                     graspable(o), settings);
}

/// Signed distance of a point of the object from a pad's plane, positive before it, and where it is
/// on the pad.
Vector3 on_pad(const Grasp& g, std::uint32_t finger, const Vector3& p_object) {
  const HandModel& hand = gripper()->hand;
  const Finger& f = hand.fingers()[finger];
  const Pose T_hand_pad =
      hand.model().link_pose(g.hand_joints, hand.model().link_index(f.tip_link)) * f.pad->T_tip_pad;
  return (g.T_object_hand * T_hand_pad).inverse() * p_object;
}

class PinchedObjects : public testing::TestWithParam<const char*> {};

TEST_P(PinchedObjects, are_held_by_areas_that_close_force) {
  const ObjectModel o = object(GetParam());
  const GraspList list = list_of(o);
  ASSERT_GE(list.grasps.size(), 20U);
  const HandModel& hand = gripper()->hand;
  std::uint64_t counted = 0;
  for (const std::uint64_t r : list.reasons) counted += r;
  EXPECT_EQ(counted, list.frames);
  for (const ListedGrasp& listed : list.grasps) {
    const Grasp& g = listed.grasp;
    ASSERT_EQ(g.hand_joints.size(), 1);
    EXPECT_GE(g.hand_joints[0], hand.lower_contact()[0]);
    EXPECT_LE(g.pregrasp_joints[0], hand.upper_contact()[0] + 1e-9);
    EXPECT_GE(g.pregrasp_joints[0] - g.hand_joints[0], 0.0035) << "opens too little to get there";
    std::set<std::uint32_t> fingers;
    std::vector<PointContact> contacts;
    for (const Contact& c : g.contacts) {
      fingers.insert(c.finger);
      contacts.push_back({c.position, -c.normal, c.friction});
      const Vector3 p = on_pad(g, c.finger, c.position);
      EXPECT_LE(std::abs(p.x()), 0.01 + 1e-9);
      EXPECT_LE(std::abs(p.y()), 0.014 + 1e-9);
      EXPECT_NEAR(p.z(), 0, 6e-4) << "a contact off its pad";
    }
    EXPECT_EQ(fingers.size(), 2U);
    EXPECT_LE(g.contacts.size(), 8U);
    EXPECT_TRUE(force_closure(contact_wrenches(contacts, 8, o.com, 10)));
    EXPECT_GT(g.epsilon, 0);
    EXPECT_GT(g.margin, 0);
    // Both fingers push the axis closed, each within its limit.
    EXPECT_LE(g.hand_effort[0], 0);
    EXPECT_GE(g.hand_effort[0], -2.05 * hand.grip_force());
  }
}

INSTANTIATE_TEST_SUITE_P(Objects, PinchedObjects, testing::Values("box", "can", "bottle"));

/// Distance of a contact from the vertical axis of the object [m].
double off_axis(const Contact& c) { return c.position.head<2>().norm(); }

constexpr double kInsideMug = 0.0362;  // radius of the inner wall [m]

TEST(Pinch, holds_an_empty_mug_by_its_rim_with_one_pad_inside) {
  const ObjectModel o = object("mug");
  const GraspList list = list_of(o);
  std::size_t by_rim = 0;
  for (const ListedGrasp& listed : list.grasps) {
    const Grasp& g = listed.grasp;
    std::array<std::size_t, 2> inside{}, outside{};
    std::array<double, 2> low{1, 1}, high{-1, -1};
    for (const Contact& c : g.contacts) {
      ++(off_axis(c) < kInsideMug ? inside : outside)[c.finger];
      const Vector3 p = on_pad(g, c.finger, c.position);
      low[c.finger] = std::min(low[c.finger], p.x());
      high[c.finger] = std::max(high[c.finger], p.x());
      EXPECT_NEAR(p.z(), 0, 6e-4) << "a contact off its pad";
    }
    for (const std::size_t finger : {0, 1}) {
      const std::size_t other = 1 - finger;
      if (inside[finger] == 0 || outside[finger] > 0 || inside[other] > 0) continue;
      ++by_rim;
      EXPECT_LT(low[finger], -0.005) << "the pad in the hollow rests on one edge only";
      EXPECT_GT(high[finger], 0.005) << "the pad in the hollow rests on one edge only";
      EXPECT_GT(g.margin, 0);
    }
  }
  EXPECT_GE(by_rim, 5U);
}

TEST(Pinch, bridges_no_hollow_deeper_than_the_setting) {
  GraspListSettings flat = small_settings();
  flat.pad_hollow = 0;
  for (const ListedGrasp& listed : list_of(object("mug"), flat).grasps) {
    std::array<double, 2> low{1, 1}, high{-1, -1};
    for (const Contact& c : listed.grasp.contacts) {
      if (off_axis(c) >= kInsideMug) continue;
      const Vector3 p = on_pad(listed.grasp, c.finger, c.position);
      low[c.finger] = std::min(low[c.finger], p.x());
      high[c.finger] = std::max(high[c.finger], p.x());
    }
    for (const std::size_t finger : {0, 1})
      EXPECT_FALSE(low[finger] < -0.005 && high[finger] > 0.005) << "rests on two edges";
  }
}

TEST(Pinch, enters_no_cup_that_is_filled) {
  ObjectModel o = object("mug");
  for (ObjectPart& part : o.parts) part.walls.clear();
  for (const ListedGrasp& listed : list_of(o).grasps) {
    for (const Contact& c : listed.grasp.contacts) EXPECT_GT(off_axis(c), kInsideMug);
  }
}

TEST(Pinch, holds_nothing_wider_than_it_opens) {
  const GraspList list = list_of(object("box", 2.0));
  EXPECT_TRUE(list.grasps.empty());
  EXPECT_GT(list.reasons[static_cast<std::size_t>(FrameReason::nothing_opposite)],
            list.frames * 9 / 10);
}

TEST(Pinch, list_goes_on_where_it_stopped) {
  const ObjectModel o = object("box");
  const auto workspaces = std::make_shared<const FingerWorkspaces>(make_workspaces(*gripper()));
  GraspLister lister(gripper(), workspaces, graspable(o), small_settings());
  while (lister.advance(17)) {
  }
  const GraspList in_parts = lister.list(), whole = list_of(o);
  ASSERT_EQ(in_parts.grasps.size(), whole.grasps.size());
  for (std::size_t i = 0; i < whole.grasps.size(); ++i) {
    EXPECT_EQ(in_parts.grasps[i].grasp.id, whole.grasps[i].grasp.id);
    EXPECT_EQ(in_parts.grasps[i].grasp.quality, whole.grasps[i].grasp.quality);
  }
}

TEST(Pinch, fingers_that_share_an_axis_carry_their_own_links) {
  const HandGeometry& hand_geometry = *gripper();
  ASSERT_EQ(hand_geometry.chains.size(), 2U);
  for (const FingerChain& chain : hand_geometry.chains) {
    EXPECT_EQ(chain.axes(), std::vector<int>{0});
    EXPECT_EQ(chain.steps(), 1);
  }
  const Vector q = Vector::Constant(1, 0.03);
  EXPECT_NEAR((hand_geometry.chains[0].tip(q) - hand_geometry.chains[1].tip(q)).y(), 0.06, 1e-12);
}

}  // namespace
}  // namespace handsel::grasp_planner::pinch_test
