// SPDX-License-Identifier: Apache-2.0
// Grasps for a robot in a scene, and lists on disk.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/regrasp/grasp_cache.hpp"

namespace handsel::grasp_planner::grasp_choice_test {
namespace {

const std::filesystem::path kDeploy = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";

const ObjectModel* library(const std::string& name) {
  static std::map<std::string, ObjectModel> models;
  if (models.find(name) == models.end())
    models[name] = ObjectModel::load(kDeploy / "objects" / name / (name + ".txtpb"));
  return &models[name];
}

std::filesystem::path store_folder() {
  static const auto folder =
      std::filesystem::temp_directory_path() / ("handsel_grasp_test_" + std::to_string(::getpid()));
  return folder;
}

class GraspChoice : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    robot =
        std::make_shared<const RobotModel>(RobotModel::load(kDeploy / "robots/jido/jido.txtpb"));
    hand_geometry =
        std::make_shared<const HandGeometry>(HandModel::load(kDeploy / "hands/sah/sah.txtpb"));
    settings.positions = 40;
    settings.orientations = 72;
    cache = std::make_unique<GraspCache>(hand_geometry, settings, GraspStore(store_folder()));
    page = cache->page(*library("mug"));
  }
  static void TearDownTestSuite() {
    page.reset();
    cache.reset();
    std::filesystem::remove_all(store_folder());
  }

  static Scene scene_with_mug(double x, double y) {
    Scene s;
    s.robot_known = true;
    s.robot_position = robot->rest_configuration();
    s.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
    s.objects.push_back({"cup", "mug",
                         make_pose({x, y, 0.72 + library("mug")->height_above_support}),
                         Holder::surface, "table", 0});
    return s;
  }

  static GraspRequest request() {
    GraspRequest r;
    r.object = "cup";
    r.start = robot->rest_configuration();
    r.max_grasps = 10;
    return r;
  }

  static std::shared_ptr<const RobotModel> robot;
  static std::shared_ptr<const HandGeometry> hand_geometry;
  static GraspListSettings settings;
  static std::unique_ptr<GraspCache> cache;
  static std::shared_ptr<const CachedGrasps> page;
};
std::shared_ptr<const RobotModel> GraspChoice::robot;
std::shared_ptr<const HandGeometry> GraspChoice::hand_geometry;
GraspListSettings GraspChoice::settings;
std::unique_ptr<GraspCache> GraspChoice::cache;
std::shared_ptr<const CachedGrasps> GraspChoice::page;

TEST_F(GraspChoice, refuses_grasps_that_would_not_bear_the_object_and_says_so) {
  const GraspChooser chooser(robot, hand_geometry, library, {});
  const Scene scene = scene_with_mug(0.68, -0.42);
  GraspList firm = page->list;
  firm.min_margin = 0;
  const auto weak = std::count_if(firm.grasps.begin(), firm.grasps.end(),
                                  [](const ListedGrasp& g) { return g.grasp.margin < 0; });
  ASSERT_GT(weak, 0);
  const Choice choice = chooser.choose({request(), firm, *page->object, scene, {}});
  ASSERT_FALSE(choice.grasps.empty());
  for (const Grasp& g : choice.grasps) EXPECT_GE(g.margin, 0);
  EXPECT_EQ(choice.reasons[static_cast<std::size_t>(ChoiceReason::too_weak)],
            static_cast<std::uint64_t>(weak));
  firm.min_margin = 1000;
  const Choice none = chooser.choose({request(), firm, *page->object, scene, {}});
  EXPECT_TRUE(none.grasps.empty());
  EXPECT_NE(none.why_none(firm).find("would not bear"), std::string::npos) << none.why_none(firm);
}

TEST_F(GraspChoice, grasps_of_the_reply_can_be_carried_out) {
  const GraspChooser chooser(robot, hand_geometry, library, {});
  const Scene scene = scene_with_mug(0.68, -0.42);
  const Choice choice = chooser.choose({request(), page->list, *page->object, scene, {}});
  ASSERT_GE(choice.grasps.size(), 5U);
  std::uint64_t counted = 0;
  for (const std::uint64_t r : choice.reasons) counted += r;
  EXPECT_EQ(counted, page->list.grasps.size());
  const Group &arm = robot->require_group("arm"), &hand = robot->require_group("hand");
  CollisionWorld strict(*robot, library), allowed(*robot, library);
  for (CollisionWorld* w : {&strict, &allowed}) w->set_scene(scene);
  strict.set_attachment({}, {});
  allowed.set_attachment({}, {"cup"});
  for (const Grasp& g : choice.grasps) {
    const auto posture = [&](const Vector& arm_q, const Vector& hand_q) {
      return RobotModel::with(RobotModel::with(robot->rest_configuration(), arm, arm_q), hand,
                              hand_q);
    };
    const Pose reached = robot->link_pose(posture(g.arm_joints, g.hand_joints), robot->tool_link());
    const Pose wanted = scene.objects[0].T_world_object * g.T_object_hand;
    EXPECT_LT((reached.translation() - wanted.translation()).norm(), 1e-4);
    EXPECT_LT(
        Eigen::AngleAxisd(Eigen::Matrix3d(reached.linear().transpose() * wanted.linear())).angle(),
        1e-3);
    const Pose before =
        robot->link_pose(posture(g.approach_joints, g.pregrasp_joints), robot->tool_link());
    EXPECT_NEAR((before.translation() - wanted.translation()).norm(), 0.09, 1e-3);
    EXPECT_TRUE(allowed.check(posture(g.arm_joints, g.hand_joints)).free);
    const Vector from = posture(g.approach_joints, g.pregrasp_joints),
                 to = posture(g.arm_joints, g.pregrasp_joints);
    for (int i = 0; i <= 20; ++i) {
      const CollisionVerdict v = strict.check(from + i / 20.0 * (to - from));
      EXPECT_TRUE(v.free) << "at " << i << "/20 of the approach of grasp " << g.id << ": "
                          << v.first << " touches " << v.second;
    }
    for (const Contact& c : g.contacts)
      EXPECT_GT((scene.objects[0].T_world_object * c.position).z(), 0.72);
  }
}

TEST_F(GraspChoice, is_the_same_every_time) {
  const GraspChooser chooser(robot, hand_geometry, library, {});
  const Scene scene = scene_with_mug(0.7, -0.4);
  const Choice a = chooser.choose({request(), page->list, *page->object, scene, {}}),
               b = chooser.choose({request(), page->list, *page->object, scene, {}});
  ASSERT_EQ(a.grasps.size(), b.grasps.size());
  for (std::size_t i = 0; i < a.grasps.size(); ++i) {
    EXPECT_EQ(a.grasps[i].id, b.grasps[i].id);
    EXPECT_EQ(a.grasps[i].arm_joints, b.grasps[i].arm_joints);
    EXPECT_EQ(a.grasps[i].approach_joints, b.grasps[i].approach_joints);
  }
}

TEST_F(GraspChoice, an_object_out_of_reach_gives_a_reason) {
  const GraspChooser chooser(robot, hand_geometry, library, {});
  const Choice choice =
      chooser.choose({request(), page->list, *page->object, scene_with_mug(2.5, -0.5), {}});
  EXPECT_TRUE(choice.grasps.empty());
  EXPECT_NE(choice.why_none(page->list).find("reaches"), std::string::npos)
      << choice.why_none(page->list);
}

TEST_F(GraspChoice, for_a_person_the_mean_room_left_is_larger) {
  settings::GraspPlannerSettings s;
  s.rank_room = 10;       // other criteria of a person
  s.rank_handover = 0.0;  // have little effect
  const GraspChooser chooser(robot, hand_geometry, library, s);
  const Scene scene = scene_with_mug(0.68, -0.42);
  HumanState people;
  Person anna;
  anna.id = "anna";
  anna.joints = standing_body({1.45, 0.25, 0}, 3.14, 1.7);
  people.people.push_back(anna);
  GraspRequest plain = request(), given = request();
  given.for_human = "anna";
  const auto room = [&](const Choice& c) {
    double sum = 0;
    for (const Grasp& g : c.grasps) {
      sum += std::find_if(page->list.grasps.begin(), page->list.grasps.end(),
                          [&](const ListedGrasp& l) { return l.grasp.id == g.id; })
                 ->room;
    }
    return sum / static_cast<double>(c.grasps.size());
  };
  EXPECT_GT(room(chooser.choose({given, page->list, *page->object, scene, people})),
            room(chooser.choose({plain, page->list, *page->object, scene, people})));
}

TEST_F(GraspChoice, a_robot_with_another_hand_is_refused) {
  const auto bare =
      std::make_shared<const RobotModel>(RobotModel::load_urdf(kDeploy / "robots/jido/jido.urdf"));
  EXPECT_THROW(GraspChooser(bare, hand_geometry, library, {}), ConfigError);
}

TEST_F(GraspChoice, lists_come_back_from_disk_as_they_were) {
  const std::uint64_t key = list_key(hand_geometry->hand, *library("mug"), settings);
  const GraspStore store(store_folder());
  const auto back = store.load("sah", "mug", key, page->list.frames);
  ASSERT_TRUE(back.has_value());
  ASSERT_EQ(back->grasps.size(), page->list.grasps.size());
  EXPECT_EQ(back->frames, page->list.frames);
  EXPECT_EQ(back->reasons, page->list.reasons);
  for (std::size_t i = 0; i < back->grasps.size(); ++i) {
    const Grasp &a = back->grasps[i].grasp, &b = page->list.grasps[i].grasp;
    EXPECT_EQ(a.T_object_hand.matrix(), b.T_object_hand.matrix());
    EXPECT_EQ(a.hand_joints, b.hand_joints);
    EXPECT_EQ(a.pregrasp_joints, b.pregrasp_joints);
    ASSERT_EQ(a.contacts.size(), b.contacts.size());
    EXPECT_EQ(a.contacts.back().position, b.contacts.back().position);
    EXPECT_EQ(back->grasps[i].room, page->list.grasps[i].room);
  }
  GraspCache second(hand_geometry, settings, store);
  EXPECT_EQ(second.page(*library("mug"))->list.grasps.size(), page->list.grasps.size());
}

TEST_F(GraspChoice, a_damaged_or_foreign_list_is_not_used) {
  const std::uint64_t key = list_key(hand_geometry->hand, *library("mug"), settings);
  const GraspStore store(store_folder() / "damaged");
  ASSERT_TRUE(store.save(page->list, key));
  const auto file = store.file("sah", "mug", key, page->list.frames);
  const auto size = std::filesystem::file_size(file);
  std::fstream io(file, std::ios::in | std::ios::out | std::ios::binary);
  io.seekp(static_cast<std::streamoff>(size / 2));
  io.put('\x55');
  io.put('\x2a');
  io.close();
  EXPECT_FALSE(store.load("sah", "mug", key, page->list.frames).has_value());
  ASSERT_TRUE(store.save(page->list, key));
  EXPECT_TRUE(store.load("sah", "mug", key, page->list.frames).has_value());
  std::filesystem::resize_file(file, size / 3);
  EXPECT_FALSE(store.load("sah", "mug", key, page->list.frames).has_value());
  std::filesystem::resize_file(file, 0);
  EXPECT_FALSE(store.load("sah", "mug", key, page->list.frames).has_value());
  GraspListSettings other = settings;
  other.opening *= 2;
  EXPECT_NE(list_key(hand_geometry->hand, *library("mug"), other), key);
  EXPECT_NE(list_key(hand_geometry->hand, *library("box"), settings), key);
  EXPECT_FALSE(store.load("sah", "mug", key + 1, page->list.frames).has_value());
  EXPECT_FALSE(GraspStore("").save(page->list, key));
}

}  // namespace
}  // namespace handsel::grasp_planner::grasp_choice_test
