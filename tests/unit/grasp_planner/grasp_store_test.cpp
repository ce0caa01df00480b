// SPDX-License-Identifier: Apache-2.0
// Grasp lists on disk under two writers that are killed at random times, and lists that are
// continued.
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <set>

#include "components/grasp_planner/list/grasp_fit.hpp"
#include "components/grasp_planner/regrasp/grasp_cache.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::grasp_planner::grasp_store_test {
namespace {

using test::TemporaryFolder;

const std::filesystem::path kDeploy = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";

/// Returns a list in which every number identifies its writer.
GraspList list_of(std::uint64_t writer) {
  GraspList list;
  list.hand = "hand";
  list.object = "object";
  list.frames = 500;
  for (std::uint64_t i = 0; i < 400; ++i) {
    ListedGrasp g;
    g.grasp.id = i;
    g.grasp.quality = static_cast<double>(writer);
    g.grasp.hand_joints = g.grasp.pregrasp_joints = g.grasp.hand_effort =
        Vector::Constant(13, static_cast<double>(writer));
    for (std::uint32_t f = 0; f < 4; ++f)
      g.grasp.contacts.push_back({f, Vector3::Constant(static_cast<double>(writer)),
                                  Vector3::UnitZ(), f, Vector3::Zero(), 0.5, 0});
    list.grasps.push_back(g);
  }
  return list;
}

bool whole(const GraspList& list) {
  if (list.grasps.size() != 400) return false;
  const double writer = list.grasps.front().grasp.quality;
  return std::all_of(list.grasps.begin(), list.grasps.end(), [writer](const ListedGrasp& g) {
    return g.grasp.quality == writer && g.grasp.hand_joints == Vector::Constant(13, writer) &&
           g.grasp.contacts.size() == 4 &&
           g.grasp.contacts[3].position == Vector3::Constant(writer);
  });
}

pid_t writer(const std::filesystem::path& folder, std::uint64_t name) {
  const pid_t child = fork();
  if (child != 0) return child;
  const GraspStore store(folder);
  const GraspList list = list_of(name);
  while (true) store.save(list, 77);
}

TEST(GraspStore, two_writers_killed_at_any_moment_leave_a_whole_list) {
  const TemporaryFolder folder;
  const GraspStore store(folder.path());
  ASSERT_TRUE(store.save(list_of(9), 77));
  int by_either = 0;
  std::set<double> writers;
  for (int round = 0; round < 25; ++round) {
    const pid_t children[] = {writer(folder.path(), 1), writer(folder.path(), 2)};
    for (int look = 0; look < 20 + round; ++look) {
      const auto list = store.load("hand", "object", 77, 500);
      ASSERT_TRUE(list.has_value()) << "round " << round;
      ASSERT_TRUE(whole(*list)) << "round " << round;
      by_either += list->grasps.front().grasp.quality != 9;
      writers.insert(list->grasps.front().grasp.quality);
    }
    for (const pid_t child : children) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
    }
    const auto list = store.load("hand", "object", 77, 500);
    ASSERT_TRUE(list && whole(*list)) << "after the kill of round " << round;
  }
  EXPECT_GT(by_either, 100);
  EXPECT_GE(writers.size(), 2U);
}

TEST(GraspStore, finds_the_longest_list_that_is_not_too_long_and_passes_over_damaged_ones) {
  const TemporaryFolder folder;
  const GraspStore store(folder.path());
  for (const std::uint64_t frames : {100, 300, 900}) {
    GraspList list = list_of(1);
    list.frames = frames;
    ASSERT_TRUE(store.save(list, 5));
  }
  EXPECT_EQ(store.load("hand", "object", 5, 1000)->frames, 900U);
  EXPECT_EQ(store.load("hand", "object", 5, 899)->frames, 300U);
  EXPECT_FALSE(store.load("hand", "object", 5, 99).has_value());
  std::filesystem::resize_file(store.file("hand", "object", 5, 300), 1000);
  EXPECT_EQ(store.load("hand", "object", 5, 899)->frames, 100U);
}

TEST(GraspStore, a_list_that_names_joints_fingers_or_triangles_that_are_not_there_does_not_fit) {
  const HandModel hand = HandModel::load(kDeploy / "hands/sah/sah.txtpb");
  const ObjectModel box = ObjectModel::load(kDeploy / "objects/box/box.txtpb");
  const auto with = [&](const auto& change) {
    GraspList list = list_of(1);
    for (ListedGrasp& g : list.grasps)
      g.grasp.hand_joints = g.grasp.pregrasp_joints = g.grasp.hand_effort =
          Vector::Zero(hand.model().dof());
    change(list.grasps[7]);
    return fits(list, hand, box);
  };
  EXPECT_TRUE(with([](ListedGrasp&) {}));
  EXPECT_FALSE(with([](ListedGrasp& g) { g.grasp.hand_joints.conservativeResize(3); }));
  EXPECT_FALSE(with([](ListedGrasp& g) { g.grasp.hand_effort[2] = std::nan(""); }));
  EXPECT_FALSE(with([](ListedGrasp& g) { g.grasp.contacts[1].finger = 4; }));
  EXPECT_FALSE(with([](ListedGrasp& g) { g.grasp.contacts[1].triangle = 99999999; }));
  EXPECT_FALSE(with([](ListedGrasp& g) {
    g.grasp.T_object_hand.translation().x() = std::numeric_limits<double>::infinity();
  }));
  EXPECT_FALSE(with([](ListedGrasp& g) { g.room = std::nan(""); }));
}

TEST(GraspCache,
     more_orientations_go_on_with_the_list_on_disk_and_come_to_the_same_as_a_list_made_at_once) {
  const TemporaryFolder folder;
  const auto hand_geometry =
      std::make_shared<const HandGeometry>(HandModel::load(kDeploy / "hands/sah/sah.txtpb"));
  const ObjectModel box = ObjectModel::load(kDeploy / "objects/box/box.txtpb");
  GraspListSettings few, more;
  few.positions = more.positions = 8;
  few.orientations = 20;
  more.orientations = 30;
  const auto first = GraspCache(hand_geometry, few, GraspStore(folder.path())).page(box);
  const auto longer = GraspCache(hand_geometry, more, GraspStore(folder.path())).page(box);
  const auto at_once = GraspCache(hand_geometry, more, GraspStore("")).page(box);
  EXPECT_GT(longer->list.frames, first->list.frames);
  EXPECT_EQ(longer->list.frames, at_once->list.frames);
  EXPECT_EQ(longer->list.reasons, at_once->list.reasons);
  EXPECT_EQ(longer->list.finger_solutions, at_once->list.finger_solutions);
  ASSERT_EQ(longer->list.grasps.size(), at_once->list.grasps.size());
  for (std::size_t i = 0; i < at_once->list.grasps.size(); ++i) {
    EXPECT_EQ(longer->list.grasps[i].grasp.id, at_once->list.grasps[i].grasp.id);
    EXPECT_EQ(longer->list.grasps[i].grasp.hand_joints, at_once->list.grasps[i].grasp.hand_joints);
  }
  const auto again = GraspCache(hand_geometry, few, GraspStore(folder.path())).page(box);
  EXPECT_EQ(again->list.frames, first->list.frames)
      << "a longer list on disk does not lengthen a shorter one";
  EXPECT_EQ(again->list.grasps.size(), first->list.grasps.size());
}

TEST(GraspStore, shared_among_listers_it_is_the_list_of_one) {
  const auto hand_geometry =
      std::make_shared<const HandGeometry>(HandModel::load(kDeploy / "hands/sah/sah.txtpb"));
  const auto workspaces = std::make_shared<const FingerWorkspaces>(make_workspaces(*hand_geometry));
  const auto box = std::make_shared<const Graspable>(
      ObjectModel::load(kDeploy / "objects/box/box.txtpb"), hand_geometry->tip_radius(), 0.6, 1);
  GraspListSettings settings;
  settings.positions = 8;
  settings.orientations = 30;
  const GraspList one = list_grasps(hand_geometry, workspaces, box, settings);
  GraspLister a(hand_geometry, workspaces, box, settings),
      b(hand_geometry, workspaces, box, settings);
  for (std::uint64_t first = 0; first < a.frames(); first += 32)
    (first / 32 % 2 ? a : b).test(first, 32);
  const GraspList both = merged({a.list(), b.list()});
  EXPECT_EQ(both.frames, one.frames);
  EXPECT_EQ(both.reasons, one.reasons);
  ASSERT_EQ(both.grasps.size(), one.grasps.size());
  for (std::size_t i = 0; i < one.grasps.size(); ++i)
    EXPECT_EQ(both.grasps[i].grasp.id, one.grasps[i].grasp.id);
}

}  // namespace
}  // namespace handsel::grasp_planner::grasp_store_test
