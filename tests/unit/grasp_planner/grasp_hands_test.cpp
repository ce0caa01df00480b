// SPDX-License-Identifier: Apache-2.0
// Hands known by description alone, and imperfect meshes: the properties of a listed grasp hold for
// fingers with any number of axes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/base/errors.hpp"
#include "components/grasp_planner/list/epsilon.hpp"
#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner::grasp_hands_test {
namespace {

using testing::HasSubstr;

const std::filesystem::path kDeploy = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";

ObjectModel object(const std::string& name) {
  return ObjectModel::load(kDeploy / "objects" / name / (name + ".txtpb"));
}

class Hands : public testing::TestWithParam<const char*> {};

TEST_P(Hands, every_contact_is_touched_nothing_is_pierced_and_the_opened_hand_is_off_the_object) {
  const std::string name = GetParam();
  const auto hand_geometry = std::make_shared<const HandGeometry>(
      HandModel::load(kDeploy / "hands" / name / (name + ".txtpb")));
  const auto workspaces = std::make_shared<const FingerWorkspaces>(make_workspaces(*hand_geometry));
  GraspListSettings settings;
  settings.positions = 16;
  settings.orientations = 36;
  // A person's hand and a Schunk hand differ in size: the can is small enough for both.
  const auto can = std::make_shared<const Graspable>(object("can"), hand_geometry->tip_radius(),
                                                     settings.step_fraction, 1);
  const GraspList list = list_grasps(hand_geometry, workspaces, can, settings);
  ASSERT_GE(list.grasps.size(), 10U);
  std::vector<std::vector<Pose>> T;
  for (const ListedGrasp& listed : list.grasps) {
    const Grasp& g = listed.grasp;
    ASSERT_GE(g.contacts.size(), 3U);
    hand_geometry->forward(g.hand_joints, T);
    std::vector<PointContact> contacts;
    for (const Contact& c : g.contacts) {
      const FingerChain& chain = hand_geometry->chains[c.finger];
      EXPECT_LT(
          (g.T_object_hand * chain.tip(T[c.finger]) - c.position - chain.tip_radius() * c.normal)
              .norm(),
          chain.axes().size() < 3 ? 4e-3 : 2e-4);
      EXPECT_NEAR((g.T_object_hand * chain.tip(T[c.finger]) - c.position).norm(),
                  chain.tip_radius(), 3e-4);
      for (const int a : chain.axes()) {
        EXPECT_GE(g.hand_joints[a], hand_geometry->hand.lower_contact()[a] - 1e-9);
        EXPECT_LE(g.hand_joints[a], hand_geometry->hand.upper_contact()[a] + 1e-9);
      }
      contacts.push_back({c.position, -c.normal, c.friction});
    }
    EXPECT_FALSE(hand_geometry->shape.touches(T, *can, g.T_object_hand, -0.001)) << g.id;
    for (std::size_t a = 0; a < T.size(); ++a) {
      EXPECT_FALSE(hand_geometry->shape.finger_touches_palm(static_cast<int>(a), T[a])) << g.id;
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_FALSE(hand_geometry->shape.fingers_touch(static_cast<int>(a), T[a],
                                                        static_cast<int>(b), T[b]))
            << g.id;
    }
    EXPECT_TRUE(force_closure(contact_wrenches(contacts, 8, can->com(), 1 / can->radius())));
    hand_geometry->forward(g.pregrasp_joints, T);
    EXPECT_FALSE(hand_geometry->shape.touches(T, *can, g.T_object_hand, 0.0))
        << g.id << ": the opened hand touches";
    for (Eigen::Index a = 0; a < g.hand_joints.size(); ++a) {
      if (!hand_geometry->shared(static_cast<int>(a))) continue;
      EXPECT_EQ(g.hand_joints[a], g.pregrasp_joints[a])
          << "a shared axis does not move as the hand opens";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Descriptions, Hands,
                         testing::Values("sah", "sah_left", "human_right", "allegro", "barrett"),
                         [](const auto& hand) { return std::string(hand.param); });

std::string refusal(const ObjectModel& o) {
  try {
    const Graspable g(o, 0.013, 0.6, 1);
    return "";
  } catch (const ConfigError& e) {
    return e.what();
  }
}

TEST(Meshes,
     what_no_hand_can_hold_is_refused_with_a_sentence_and_the_rest_is_taken_with_its_findings) {
  ObjectModel o = object("box");
  EXPECT_EQ(refusal(o), "");
  ObjectModel empty = o;
  empty.mesh = {};
  EXPECT_THAT(refusal(empty), HasSubstr("no triangles"));
  ObjectModel flat = o;
  for (Vector3& v : flat.mesh.vertices) v = Vector3(v.x(), 0, 0);
  EXPECT_THAT(refusal(flat), HasSubstr("no triangle of its mesh has an area"));
  for (const double scale : {0.001, 1000.0}) {
    ObjectModel other = o;
    for (Vector3& v : other.mesh.vertices) v *= scale;
    EXPECT_THAT(refusal(other), HasSubstr("scale it")) << scale;
  }
  ObjectModel two = o;
  const auto shift = static_cast<int>(two.mesh.vertices.size());
  for (int i = 0; i < shift; ++i)
    two.mesh.vertices.push_back(o.mesh.vertices[static_cast<std::size_t>(i)] + Vector3(0.3, 0, 0));
  for (const auto& t : o.mesh.triangles)
    two.mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  two.mesh.triangles.erase(two.mesh.triangles.begin());
  const Graspable taken(two, 0.013, 0.6, 1);
  const auto said = sentences(taken.findings());
  ASSERT_EQ(said.size(), 2U);
  EXPECT_THAT(said[0], HasSubstr("holes were left open"));
  EXPECT_THAT(said[1], HasSubstr("2 parts are not connected; they were taken as one rigid object"));
}

}  // namespace
}  // namespace handsel::grasp_planner::grasp_hands_test
