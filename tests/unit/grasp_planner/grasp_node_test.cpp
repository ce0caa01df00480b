// SPDX-License-Identifier: Apache-2.0
// The grasp planner's node on LocalBus: requests, their repetition, refusals, candidates.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "common/bus/local_bus.hpp"
#include "components/grasp_planner/node.hpp"

namespace handsel::grasp_planner::grasp_node_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

const fs::path kDeploy = fs::path(HANDSEL_SOURCE_DIR) / "deploy";

const ObjectModel* library(const std::string& name) {
  static std::map<std::string, ObjectModel> models;
  const fs::path file = kDeploy / "objects" / name / (name + ".txtpb");
  if (!fs::exists(file)) return nullptr;
  if (models.find(name) == models.end()) models[name] = ObjectModel::load(file);
  return &models[name];
}

class GraspNode : public testing::Test {
 protected:
  GraspNode()
      : folder_(fs::temp_directory_path() / ("handsel_grasp_node_" + std::to_string(::getpid()))),
        network_(3) {
    fs::create_directories(folder_);
    setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
    setenv("HANDSEL_HOME", kDeploy.c_str(), 1);
    std::ifstream in(kDeploy / "config/grasp_planner.txtpb");
    std::ofstream out(folder_ / "grasp_planner.txtpb");
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("positions:")) line = "positions: 40";
      if (line.starts_with("orientations:")) line = "orientations: 72";
      out << line << '\n';
    }
    out.close();
    context_.description = kDeploy / "robots/jido/jido.txtpb";
    context_.robot = std::make_shared<const RobotModel>(RobotModel::load(context_.description));
    context_.objects = library;
    context_.settings = folder_;
    node_ = std::make_unique<Node>(network_.add("grasp_planner"), context_);
    Bus& spark = network_.add("spark");
    Bus& planner = network_.add("manipulation_planner");
    scene_out_ = spark.advertise<Scene>();
    people_out_ = spark.advertise<HumanState>();
    request_out_ = planner.advertise<GraspRequest>();
    planner.subscribe<GraspReply>(
        [this](const GraspReply& r, const Receipt&) { replies_.push_back(r); });
    planner.subscribe<GraspCandidates>(
        [this](const GraspCandidates& c, const Receipt&) { candidates_.push_back(c); });
    scene_.robot_known = true;
    scene_.robot_position = context_.robot->rest_configuration();
    scene_.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
    scene_.objects.push_back({"cup", "mug",
                              make_pose({0.68, -0.42, 0.72 + library("mug")->height_above_support}),
                              Holder::surface, "table", 0});
    publish_scene();
  }
  ~GraspNode() override { fs::remove_all(folder_); }

  void publish_scene() {
    ++scene_.revision;
    scene_out_->publish(scene_);
    people_out_->publish(HumanState{});
    network_.run_for(milliseconds(50));
  }

  void ask(std::uint64_t number, const std::string& object, GraspRequest r = {}) {
    r.id = {7, number};
    r.object = object;
    r.start = context_.robot->rest_configuration();
    r.max_grasps = 5;
    request_out_->publish(r);
  }

  bool wait(const std::function<bool()>& done) {
    return network_.run_until(done, network_.now() + seconds(20));
  }

  fs::path folder_;
  LocalNetwork network_;
  NodeContext context_;
  std::unique_ptr<Node> node_;
  std::unique_ptr<Publisher<Scene>> scene_out_;
  std::unique_ptr<Publisher<HumanState>> people_out_;
  std::unique_ptr<Publisher<GraspRequest>> request_out_;
  std::vector<GraspReply> replies_;
  std::vector<GraspCandidates> candidates_;
  Scene scene_;
};

TEST_F(GraspNode, answers_once_works_once_and_repeats_itself_when_asked_again) {
  ask(1, "cup");
  ASSERT_TRUE(wait([&] { return replies_.size() == 1; }));
  EXPECT_EQ(replies_[0].id, (RequestId{7, 1}));
  ASSERT_EQ(replies_[0].grasps.size(), 5U) << replies_[0].reason;
  EXPECT_TRUE(replies_[0].reason.empty());
  EXPECT_FALSE(replies_[0].rejected.empty());
  for (const Grasp& g : replies_[0].grasps) {
    EXPECT_EQ(g.arm_joints.size(), 7);
    EXPECT_EQ(g.approach_joints.size(), 7);
    EXPECT_EQ(g.hand_joints.size(), 13);
    EXPECT_EQ(g.pregrasp_joints.size(), 13);
  }
  ask(1, "cup");
  ASSERT_TRUE(wait([&] { return replies_.size() == 2; }));
  ASSERT_EQ(replies_[1].grasps.size(), 5U);
  EXPECT_EQ(replies_[1].grasps[0].id, replies_[0].grasps[0].id);
}

TEST_F(GraspNode, says_what_is_wrong_with_a_request) {
  ask(1, "teapot");
  ASSERT_TRUE(wait([&] { return replies_.size() == 1; }));
  EXPECT_TRUE(replies_[0].grasps.empty());
  EXPECT_NE(replies_[0].reason.find("teapot"), std::string::npos);
  scene_.objects[0].model = "unknown_thing";
  publish_scene();
  ask(2, "cup");
  ASSERT_TRUE(wait([&] { return replies_.size() == 2; }));
  EXPECT_NE(replies_[1].reason.find("unknown_thing"), std::string::npos);
  scene_.objects[0].model = "mug";
  scene_.objects[0].T_world_object.translation().x() = 3;
  publish_scene();
  ask(3, "cup");
  ASSERT_TRUE(wait([&] { return replies_.size() == 3; }));
  EXPECT_TRUE(replies_[2].grasps.empty());
  EXPECT_NE(replies_[2].reason.find("none of"), std::string::npos) << replies_[2].reason;
}

TEST_F(GraspNode, heeds_goal_sight_and_platform) {
  GraspRequest goal;
  goal.has_goal = true;
  goal.T_world_goal = make_pose({3, -0.5, 0.8});
  ask(1, "cup", goal);
  ASSERT_TRUE(wait([&] { return replies_.size() == 1; }));
  EXPECT_TRUE(replies_[0].grasps.empty());
  EXPECT_NE(replies_[0].reason.find("to be put"), std::string::npos) << replies_[0].reason;
  GraspRequest sight;
  sight.min_visible = 0.7;
  ask(2, "cup", sight);
  ASSERT_TRUE(wait([&] { return replies_.size() == 2; }));
  ASSERT_FALSE(replies_[1].grasps.empty()) << replies_[1].reason;
  for (const Grasp& g : replies_[1].grasps) EXPECT_GE(g.visible, 0.7);
  GraspRequest left;
  left.group = "left_arm";
  ask(3, "cup", left);
  ASSERT_TRUE(wait([&] { return replies_.size() == 3; }));
  EXPECT_NE(replies_[2].reason.find("left_arm"), std::string::npos) << replies_[2].reason;
  scene_.boxes[0].T_world_box.translation().x() += 2;
  scene_.objects[0].T_world_object.translation().x() += 2;
  publish_scene();
  GraspRequest drive;
  drive.move_platform = true;
  ask(4, "cup", drive);
  ASSERT_TRUE(wait([&] { return replies_.size() == 4; }));
  ASSERT_FALSE(replies_[3].grasps.empty()) << replies_[3].reason;
  EXPECT_TRUE(replies_[3].grasps[0].has_platform);
  EXPECT_GT(replies_[3].grasps[0].platform.x(), 1.0);
}

TEST_F(GraspNode, candidates_follow_the_object_until_it_is_in_a_hand) {
  ask(1, "cup");
  ASSERT_TRUE(wait([&] { return candidates_.size() == 3; }));
  EXPECT_EQ(candidates_.back().object, "cup");
  EXPECT_EQ(candidates_.back().grasps[0].arm_joints, replies_[0].grasps[0].arm_joints);
  scene_.objects[0].T_world_object.translation().x() += 0.04;
  publish_scene();
  EXPECT_TRUE(wait(
      [&] { return candidates_.back().grasps[0].arm_joints != replies_[0].grasps[0].arm_joints; }));
  scene_.objects[0].holder = Holder::robot;
  publish_scene();
  const std::size_t before = candidates_.size();
  network_.run_for(seconds(3));
  EXPECT_EQ(candidates_.size(), before);
  EXPECT_EQ(replies_.size(), 1U);
}

}  // namespace
}  // namespace handsel::grasp_planner::grasp_node_test
