// SPDX-License-Identifier: Apache-2.0
// The ROS 2 bridge in virtual time: ROS 2 topics on one side, system topics on the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/bus/local_bus.hpp"
#include "common/bus/node_context.hpp"
#include "common/messages/system.hpp"
#include "common/wire/ros2.hpp"
#include "components/ros2_lane/node.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::ros2_lane::ros2_lane_test {
namespace {

using testing::HasSubstr;

template <class M>
ros2::Transform frame(const std::string& parent, const std::string& child, const M& at,
                      Stamp stamp = 1) {
  return {stamp, parent, child, make_pose(at)};
}

/// Of one wire sample after a change to the value that goes there.
template <class M>
std::string rejected(const M& message) {
  const auto type = ros2_type<M>("x", Profile::goal);
  const auto wire = type->new_wire();
  std::string why;
  EXPECT_TRUE(type->to_wire(&message, 0, wire.get(), why));
  M back;
  return type->from_wire(wire.get(), &back, why) ? "" : why;
}

TEST(Ros2Wire, is_called_as_ros_calls_it_and_keeps_every_value) {
  const auto type = ros2_type<ros2::JointState>("joint_states", Profile::goal);
  EXPECT_STREQ(type->row().topic, "rt/joint_states");
  EXPECT_STREQ(type->row().type, "sensor_msgs::msg::dds_::JointState_");
  ros2::JointState joints{1'700'000'000'123'456'789,
                          {"a", "b"},
                          Vector::Constant(2, 0.5),
                          Vector::Constant(2, -1.5),
                          Vector()};
  const auto wire = type->new_wire();
  std::string why;
  for (int i = 0; i < 3; ++i)
    ASSERT_TRUE(type->to_wire(&joints, 0, wire.get(), why)) << "written again into the same sample";
  ros2::JointState back;
  ASSERT_TRUE(type->from_wire(wire.get(), &back, why)) << why;
  EXPECT_EQ(back.stamp, joints.stamp);
  EXPECT_EQ(back.names, joints.names);
  EXPECT_EQ(back.position, joints.position);
  EXPECT_EQ(back.velocity, joints.velocity);
  EXPECT_EQ(back.effort.size(), 0);

  const auto tf = ros2_type<ros2::Transforms>("tf", Profile::goal);
  EXPECT_STREQ(tf->row().type, "tf2_msgs::msg::dds_::TFMessage_");
  const ros2::Transforms frames{
      {{7, "world", "/it", make_pose({1, 2, 3}, Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5))}}};
  const auto sample = tf->new_wire();
  ASSERT_TRUE(tf->to_wire(&frames, 0, sample.get(), why));
  ros2::Transforms again;
  ASSERT_TRUE(tf->from_wire(sample.get(), &again, why)) << why;
  EXPECT_EQ(again.transforms[0].child, "it") << "no leading slash";
  EXPECT_TRUE(again.transforms[0].T_parent_child.isApprox(frames.transforms[0].T_parent_child));
}

TEST(Ros2Wire, rejects_what_is_malformed_in_one_sentence) {
  const double nan = std::nan("");
  EXPECT_EQ(rejected(ros2::JointState{1, {"a"}, Vector::Constant(1, nan), {}, {}}),
            "rt/x: position[0] is not finite");
  EXPECT_EQ(rejected(ros2::JointState{1, {"a"}, Vector::Constant(2, 0), {}, {}}),
            "rt/x: position has 2 elements for 1 names");
  EXPECT_EQ(rejected(ros2::JointState{1, {"a"}, {}, Vector::Constant(1, 1e5), {}}),
            "rt/x: velocity[0] is out of range");
  EXPECT_THAT(rejected(ros2::JointState{1, std::vector<std::string>(200, "a"), {}, {}, {}}),
              HasSubstr("name has 200 elements"));
  EXPECT_THAT(rejected(ros2::JointState{1, {std::string(300, 'a')}, {}, {}, {}}),
              HasSubstr("name is longer than 256 bytes"));
  EXPECT_THAT(rejected(ros2::JointState{1, {"a\x01"}, {}, {}, {}}), HasSubstr("name holds bytes"));
  ros2::Transforms frames{{frame("world", "a", Vector3(0, nan, 0))}};
  EXPECT_THAT(rejected(frames), HasSubstr("transforms[0].translation is not finite"));
  frames = {{frame("world", "", Vector3::Zero())}};
  EXPECT_THAT(rejected(frames), HasSubstr("transforms[0].child_frame_id is empty"));
  frames = {{frame("world", "a", Vector3::Zero())}};
  frames.transforms[0].T_parent_child.linear() *= 0.0;
  EXPECT_THAT(rejected(frames), HasSubstr("no unit quaternion"));
  ros2::JointTrajectory motion{
      0, {"a"}, {{Vector::Constant(1, 0), 2.0}, {Vector::Constant(1, 0.1), 1.0}}};
  EXPECT_THAT(rejected(motion), HasSubstr("points[1].time_from_start is not between"));
  motion.points[1] = {Vector(), 3.0};
  EXPECT_THAT(rejected(motion), HasSubstr("points[1].positions are missing"));
}

TEST(TfTree, when_it_is_full_frames_not_sent_for_long_make_room) {
  TfTree tree;
  tree.set(frame("world", "mast", Vector3::Zero()), TimePoint{}, true);
  for (int i = 1; i < 4096; ++i)
    ASSERT_TRUE(
        tree.set(frame("mast", "head_" + std::to_string(i), Vector3::Zero()), TimePoint{}, false));
  EXPECT_FALSE(
      tree.set(frame("mast", "head_new", Vector3::Zero()), TimePoint(from_seconds(5)), false));
  EXPECT_TRUE(
      tree.set(frame("mast", "head_new", Vector3::Zero()), TimePoint(from_seconds(11)), false));
  EXPECT_TRUE(tree.find("head_new", "world")) << "a static frame is not forgotten";
  EXPECT_FALSE(tree.find("head_1", "world"));
}

TEST(TfTree, follows_the_way_to_the_world_and_knows_how_old_it_is) {
  TfTree tree;
  const TimePoint t(from_seconds(10));
  tree.set(frame("world", "mast", Vector3(0, 0, 2)), t, true);
  tree.set({5, "mast", "camera",
            make_pose({0, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Vector3::UnitX())))},
           t, false);
  tree.set(frame("camera", "head_1", Vector3(1, 0, 0.3), 9), t + from_seconds(1), false);
  const auto head = tree.find("head_1", "world");
  ASSERT_TRUE(head);
  EXPECT_TRUE(head->T_root_frame.translation().isApprox(Vector3(1, 0, 1.7)))
      << head->T_root_frame.translation();
  EXPECT_EQ(head->stamp, 9);
  EXPECT_EQ(head->arrival, t) << "as old as the oldest part";
  EXPECT_FALSE(tree.find("head_1", "map"));
  EXPECT_FALSE(tree.find("nothing", "world"));
  tree.set(frame("b", "a", Vector3::Zero()), t, false);
  tree.set(frame("a", "b", Vector3::Zero()), t, false);
  EXPECT_FALSE(tree.find("a", "world")) << "a loop ends";
}

TEST(BodyFrame, is_named_as_ros4hri_does) {
  EXPECT_EQ(body_frame("r_wrist_7f")->joint, "r_wrist");
  EXPECT_EQ(body_frame("r_wrist_7f")->body, "7f");
  EXPECT_EQ(body_frame("head_anna_2")->body, "anna_2");
  EXPECT_EQ(body_frame("l_pinky_7")->joint, "l_pinky");
  for (const char* other : {"r_wrist", "r_y_shoulder_7f", "world", "camera_head", "head_"})
    EXPECT_FALSE(body_frame(other)) << other;
}

class Lane : public testing::Test {
 protected:
  Lane() : ros(network.add("ros")), ours(network.add("ours sim spark")) {
    setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
    context = load_context("jido", HANDSEL_SOURCE_DIR "/sim/scenarios/give_mug.txtpb");
    lane = std::make_shared<Node>(network.add("ros2_lane"), context);
  }
  template <class M>
  std::unique_ptr<Publisher<M>> write(const std::string& name) {
    types.push_back(ros2_type<M>(name, Profile::goal));
    return std::make_unique<Publisher<M>>(ros.advertise_any(*types.back(), 0));
  }
  template <class M>
  void read(const std::string& name, std::vector<M>& into) {
    types.push_back(ros2_type<M>(name, Profile::goal));
    ros.subscribe_any(
        *types.back(),
        [&into](const void* m, const Receipt&) { into.push_back(*static_cast<const M*>(m)); }, {});
  }
  void run(double seconds) { network.run_for(from_seconds(seconds)); }

  LocalNetwork network{5};
  Bus &ros, &ours;
  NodeContext context;
  std::vector<std::unique_ptr<MessageType>> types;
  std::shared_ptr<Node> lane;
};

TEST_F(Lane, turns_frames_of_a_body_into_an_observation) {
  std::vector<HumanObservation> seen;
  ours.subscribe<HumanObservation>(
      [&](const HumanObservation& m, const Receipt&) { seen.push_back(m); });
  const auto tf = write<ros2::Transforms>("tf");
  const auto tracked = write<ros2::Ids>("humans/bodies/tracked");
  run(0.5);
  EXPECT_TRUE(seen.empty()) << "nothing is known: nothing is said";
  for (int i = 1; i <= 10; ++i) {
    const Stamp now = ros.stamp_now();
    tf->publish({{frame("mast", "waist_7", Vector3(0, 0, 1), now),
                  frame("waist_7", "torso_7", Vector3(0, 0, 0.45), now),
                  frame("torso_7", "head_7", Vector3(0, 0, 0.25 + 0.001 * i), now),
                  frame("head_7", "l_eye_7", Vector3(0, 0, 0), now),
                  frame("world", "mast", Vector3(2, 0.5, 0), now),
                  frame("world", "head_tilt", Vector3(0, 0, 1.5), now),
                  frame("world", "l_hand_tip", Vector3(0, 0, 1.5), now),
                  frame("world", "l_index_tip", Vector3(0, 0, 1.5), now),
                  frame("world", "l_pinky_tip", Vector3(0, 0, 1.5), now)}});
    run(0.034);
  }
  ASSERT_GE(seen.size(), 8u);
  const HumanObservation& last = seen.back();
  EXPECT_EQ(last.source, "ros2");
  ASSERT_EQ(last.people.size(), 1u) << "neither head_tilt nor the finger tips are a body";
  EXPECT_EQ(last.people[0].body, "7");
  std::map<std::string, Vector3> joints;
  for (const ObservedJoint& joint : last.people[0].joints) joints[joint.name] = joint.position;
  ASSERT_EQ(joints.size(), 3u);
  EXPECT_TRUE(joints["waist"].isApprox(Vector3(2, 0.5, 1)));
  EXPECT_TRUE(joints["neck"].isApprox(Vector3(2, 0.5, 1.45)))
      << "ROS4HRI's torso is between the shoulders";
  EXPECT_NEAR(joints["head"].z(), 1.71, 0.002);
  EXPECT_GT(last.stamp, 0);

  seen.clear();
  run(1.0);
  EXPECT_LE(seen.size(), 1u) << "old frames are no news";
  tracked->publish({ros.stamp_now(), {}});
  run(0.3);
  ASSERT_GE(seen.size(), 5u) << "an empty list says that nobody is there";
  EXPECT_TRUE(seen.back().people.empty());
}

SensorRequest request_of(const std::string& source, double people_rate) {
  SensorRequest request;
  request.source = source;
  request.people_rate = people_rate;
  return request;
}

/// A person whose frames arrive often, and how often the bridge sends observations of them.
class RequestedRate : public Lane {
 protected:
  RequestedRate() {
    ours.subscribe<HumanObservation>([this](const HumanObservation& m, const Receipt&) {
      ++samples_;
      last_ = m;
    });
  }
  /// Returns the number of observations in two seconds in which attention repeats `request`.
  int samples_with(const std::optional<SensorRequest>& request) {
    samples_ = 0;
    for (int i = 0; i < 100; ++i) {
      const Stamp now = ros.stamp_now();
      tf_->publish({{frame("world", "waist_7", Vector3(2, 0.5, 1), now),
                     frame("world", "torso_7", Vector3(2, 0.5, 1.45), now),
                     frame("world", "head_7", Vector3(2, 0.5, 1.7), now),
                     frame("world", "l_wrist_7", Vector3(1.8, 0.7, 1), now)}});
      if (request && i % 5 == 0) requests_->publish(*request);
      run(0.02);
    }
    return samples_;
  }

  std::unique_ptr<Publisher<ros2::Transforms>> tf_ = write<ros2::Transforms>("tf");
  std::unique_ptr<Publisher<SensorRequest>> requests_ = ours.advertise<SensorRequest>();
  HumanObservation last_;

 private:
  int samples_{};
};

TEST_F(RequestedRate, people_are_sampled_as_often_as_attention_asks) {
  EXPECT_NEAR(samples_with(std::nullopt), 60, 4) << "own rate of the setting people_rate";
  EXPECT_NEAR(samples_with(request_of("ros2", 15)), 30, 3);
  EXPECT_NEAR(samples_with(request_of("", 15)), 30, 3) << "every source is asked";
  EXPECT_NEAR(samples_with(request_of("ros2", 1)), 20, 3) << "not below the setting min_rate";
  run(0.4);
  EXPECT_NEAR(samples_with(request_of("camera", 15)), 60, 4) << "another source is asked";
  EXPECT_NEAR(samples_with(std::nullopt), 60, 4) << "requests expire";
}

TEST_F(Lane, leaves_out_a_frame_from_outside_that_is_called_like_a_link_of_our_robot) {
  std::vector<HumanObservation> seen;
  ours.subscribe<HumanObservation>(
      [&](const HumanObservation& m, const Receipt&) { seen.push_back(m); });
  const auto tf = write<ros2::Transforms>("tf");
  const auto state_out = ours.advertise<RobotState>();
  RobotState state;
  state.robot = "jido";
  state.position = context.robot->rest_configuration();
  state.velocity = Vector::Zero(context.robot->dof());
  const std::string link =
      context.robot->links()[static_cast<std::size_t>(context.robot->tool_link())].name;
  for (int i = 0; i < 20; ++i) {
    state.stamp = ros.stamp_now();
    state_out->publish(state);
    tf->publish({{frame("world", link, Vector3(9, 9, 0), state.stamp),
                  frame(link, "waist_7", Vector3(0, 0, 1), state.stamp),
                  frame(link, "neck_7", Vector3(0, 0, 1.5), state.stamp),
                  frame(link, "head_7", Vector3(0, 0, 1.7), state.stamp)}});
    run(0.034);
    EXPECT_THAT(lane->trouble(),
                HasSubstr("TF tells frame " + link +
                          " below world from outside, and robot jido has a link of that name"));
  }
  ASSERT_FALSE(seen.empty());
  for (const ObservedJoint& joint : seen.back().people.at(0).joints)
    EXPECT_LT(joint.position.x(), 5) << "our link is where our robot is";
  run(10);
  EXPECT_EQ(lane->trouble(), "");
}

TEST_F(Lane, tells_joints_and_frames_of_our_robot) {
  std::vector<ros2::JointState> joints;
  std::vector<ros2::Transforms> frames;
  read("joint_states", joints);
  read("tf", frames);
  const auto state_out = ours.advertise<RobotState>();
  const auto scene_out = ours.advertise<Scene>();
  RobotState state;
  state.robot = "jido";
  state.stamp = 1'700'000'000'000'000'042;
  state.position = context.robot->rest_configuration();
  state.velocity = Vector::Constant(context.robot->dof(), 0.25);
  state.T_world_base = make_pose({0.5, 0, 0});
  Scene scene;
  scene.objects.emplace_back();
  scene.objects.back().id = scene.objects.back().model = "mug";
  scene.objects.back().T_world_object = make_pose({0.7, -0.4, 0.8});
  scene_out->publish(scene);
  for (int i = 0; i < 100; ++i) {
    state_out->publish(state);
    run(0.002);
  }
  ASSERT_GE(joints.size(), 8u);
  ASSERT_EQ(joints.back().names.size(), context.robot->axes().size());
  for (int i = 0; i < context.robot->dof(); ++i)
    EXPECT_EQ(joints.back().names[static_cast<std::size_t>(i)],
              context.robot->axes()[static_cast<std::size_t>(i)].name);
  EXPECT_EQ(joints.back().position, state.position);
  EXPECT_EQ(joints.back().velocity, state.velocity);
  EXPECT_EQ(joints.back().stamp, state.stamp);
  ASSERT_FALSE(frames.empty());
  TfTree tree;
  for (const ros2::Transform& t : frames.back().transforms) tree.set(t, TimePoint{}, false);
  const int tool = context.robot->tool_link();
  const auto told = tree.find(context.robot->links()[static_cast<std::size_t>(tool)].name, "world");
  ASSERT_TRUE(told);
  EXPECT_TRUE(told->T_root_frame.isApprox(
      state.T_world_base * context.robot->link_pose(state.position, tool), 1e-9));
  ASSERT_TRUE(tree.find("object_mug", "world"));
  EXPECT_TRUE(tree.find("object_mug", "world")
                  ->T_root_frame.translation()
                  .isApprox(Vector3(0.7, -0.4, 0.8)));
}

TEST_F(Lane, sends_no_robot_state_while_the_place_of_the_base_is_old) {
  const test::TemporaryFolder folder;
  folder.write(
      "ros2_lane.txtpb",
      "world_frame: \"world\" tf: \"tf\" people: true people_source: \"ros2\" people_rate: 30 "
      "people_age: 0.2 objects_rate: 30 joint_age: 0.1 start_tolerance: 0.05 check_step: 0.05 "
      "joint_states_rate: 50 tf_rate: 30 robot_in: \"joints\" base_frame: \"base\"");
  context.settings = folder.path();
  const auto moving = std::make_shared<Node>(network.add("moving ros2_lane"), context);
  int states = 0;
  ours.subscribe<RobotState>([&](const RobotState&, const Receipt&) { ++states; });
  const auto tf = write<ros2::Transforms>("tf");
  const auto joints_out = write<ros2::JointState>("joints");
  ros2::JointState joints;
  for (const Axis& axis : context.robot->axes()) joints.names.push_back(axis.name);
  joints.position = context.robot->rest_configuration();
  for (int i = 0; i < 50; ++i) {
    joints.stamp = ros.stamp_now();
    if (i < 20) tf->publish({{frame("world", "base", Vector3(1, 0, 0), joints.stamp)}});
    joints_out->publish(joints);
    run(0.02);
    if (i == 19) {
      EXPECT_GT(states, 15);
      EXPECT_EQ(moving->trouble(), "");
    }
    if (i == 35) states = 0;
  }
  EXPECT_EQ(states, 0) << "a place from more than 0.2 s ago";
  EXPECT_EQ(moving->trouble(), "TF has no current transform from frame base to world");
}

TEST(JointGatherer, gathers_axes_from_several_messages_and_says_what_is_missing) {
  setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
  const NodeContext context = load_context("jido");
  JointGatherer gatherer(*context.robot, 0.1);
  const TimePoint t(from_seconds(5));
  ros2::JointState first, second;
  for (const Axis& axis : context.robot->axes())
    (first.names.size() < 4 ? first : second).names.push_back(axis.name);
  const auto fill = [](ros2::JointState& m, double at, Stamp stamp) {
    m.position = Vector::Constant(static_cast<Eigen::Index>(m.names.size()), at);
    m.stamp = stamp;
  };
  fill(first, 0.1, 1'000'000'000);
  gatherer.on(first, t);
  EXPECT_FALSE(gatherer.state(t));
  EXPECT_THAT(gatherer.missing(t), HasSubstr(second.names[0]));
  fill(second, 0.2, 1'000'000'000);
  gatherer.on(second, t);
  ASSERT_TRUE(gatherer.state(t));
  fill(first, 0.12, 1'010'000'000);
  gatherer.on(first, t + from_seconds(0.01));
  const auto state = gatherer.state(t + from_seconds(0.01));
  ASSERT_TRUE(state);
  EXPECT_NEAR(state->velocity[0], 2.0, 1e-9) << "from the last two positions";
  EXPECT_EQ(state->position[4], 0.2);
  EXPECT_EQ(state->robot, "jido");
  EXPECT_FALSE(gatherer.state(t + from_seconds(0.2))) << "old joints are not known";
}

class Executor : public testing::Test {
 protected:
  Executor() {
    setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
    robot = load_context("jido").robot;
    settings::Ros2LaneSettings settings;
    settings.start_tolerance = 0.05;
    settings.check_step = 0.05;
    executor.emplace(settings, robot, 1000);
    active.robot = robot->name();
    active.position = robot->rest_configuration();
    active.velocity = active.acceleration = Vector::Zero(robot->dof());
    executor->on(active, now);
    status.robot = robot->name();
    status.epoch = 7;
    executor->on(status);
  }
  const Group& arm() const { return robot->require_group("arm"); }
  std::string joint(int i) const {
    return robot->axes()[static_cast<std::size_t>(arm().axes[static_cast<std::size_t>(i)])].name;
  }
  double here(int i) const { return active.position[arm().axes[static_cast<std::size_t>(i)]]; }
  /// Of the first arm joint, by this much.
  ros2::JointTrajectory by(double angle, double time = 1.0) const {
    return {0, {joint(0)}, {{Vector::Constant(1, here(0) + angle), time}}};
  }
  std::string asked(const ros2::JointTrajectory& wanted) {
    TrajectoryOutbox out;
    executor->on(wanted, now, out);
    return out.results.empty() ? "" : out.results.front();
  }
  TrajectoryOutbox step(double seconds = 0.01) {
    now += from_seconds(seconds);
    TrajectoryOutbox out;
    executor->step(now, out);
    return out;
  }

  std::shared_ptr<const RobotModel> robot;
  std::optional<TrajectoryExecutor> executor;
  ActiveTrajectory active;
  ExecutionStatus status;
  TimePoint now{from_seconds(100)};
};

TEST_F(Executor, checks_times_and_hands_over_what_was_asked_for) {
  EXPECT_EQ(asked(by(0.3)), "");
  TrajectoryOutbox out = step();
  ASSERT_TRUE(out.query);
  EXPECT_EQ(out.query->states.size(), 6u) << "a state every 0.05 rad";
  EXPECT_NEAR(out.query->states.back()[arm().axes[0]], here(0) + 0.3, 1e-12);
  EXPECT_EQ(out.query->states.back()[arm().axes[1]], here(1)) << "joints that are not named stay";
  EXPECT_FALSE(step().query) << "it waits for the answer";
  EXPECT_TRUE(step(0.6).query) << "and asks again";
  StateVerdict verdict;
  verdict.id = out.query->id;
  verdict.free.assign(6, 1);
  executor->on(verdict);
  step();
  out = step();
  ASSERT_TRUE(out.request);
  ASSERT_EQ(out.request->nodes.size(), 2u);
  EXPECT_EQ(out.request->speed_scale, 1);
  TrajectoryReply reply;
  reply.id = out.request->id;
  reply.solved = true;
  reply.trajectory.axes.resize(arm().axes.size());
  for (auto& axis : reply.trajectory.axes) axis.segments.push_back({0.5, 0.0});
  executor->on(reply);
  step();
  out = step();
  ASSERT_TRUE(out.request) << "1 s was asked for, 0.5 s would be: once more, slower";
  EXPECT_NEAR(out.request->speed_scale, 0.5, 1e-9);
  reply.id = out.request->id;
  for (auto& axis : reply.trajectory.axes) axis.segments[0].duration = 1.0;
  executor->on(reply);
  step();
  out = step();
  ASSERT_TRUE(out.command);
  EXPECT_EQ(out.command->epoch, 7u);
  EXPECT_EQ(out.command->axes.size(), arm().axes.size());
  EXPECT_EQ(asked(by(0.1)), "refused: another one has not ended");
  status.trajectory = out.command->id;
  status.motion = MotionState::running;
  executor->on(status);
  out = step();
  EXPECT_TRUE(out.command_done);
  EXPECT_TRUE(out.results.empty());
  status.motion = MotionState::finished;
  executor->on(status);
  out = step();
  ASSERT_EQ(out.results.size(), 1u);
  EXPECT_EQ(out.results[0], "done");
}

TEST_F(Executor, refuses_with_the_reason) {
  ros2::JointTrajectory wanted = by(0.2);
  wanted.joint_names = {"elbow_of_somebody"};
  EXPECT_EQ(asked(wanted), "refused: joint elbow_of_somebody is no joint of the arm of jido");
  EXPECT_THAT(asked(by(100)), HasSubstr("refused: point 0 has " + joint(0) + " at "));
  EXPECT_EQ(asked(by(0.4, 0)),
            "refused: its first point, at time 0, is 0.400 rad from where the arm is");
  EXPECT_EQ(asked(by(0)), "refused: it ends where the arm is");
  wanted = by(0.2);
  wanted.joint_names.push_back(joint(0));
  wanted.points[0].positions = Vector::Constant(2, here(0));
  EXPECT_EQ(asked(wanted), "refused: joint " + joint(0) + " is named twice");
  ActionStatus task;
  task.state = ActionState::running;
  executor->on(task);
  EXPECT_EQ(asked(by(0.2)), "refused: a task runs; cancel it first");
  task.state = ActionState::succeeded;
  executor->on(task);
  active.velocity[arm().axes[2]] = 0.1;
  executor->on(active, now);
  EXPECT_EQ(asked(by(0.2)), "refused: the arm is in motion");
  active.velocity.setZero();
  executor->on(active, now);
  EXPECT_EQ(asked(by(0.2)), "");
  TrajectoryOutbox out = step();
  StateVerdict verdict;
  verdict.id = out.query->id;
  verdict.free.assign(out.query->states.size(), 1);
  verdict.free.back() = 0;
  verdict.reason = "forearm touches table";
  executor->on(verdict);
  EXPECT_EQ(step().results.at(0), "refused: the path is not free: forearm touches table");
  EXPECT_EQ(asked(by(0.2)), "");
  step();
  EXPECT_EQ(step(5.1).results.at(0), "refused: the collision checker does not answer");
  now += from_seconds(1);
  EXPECT_EQ(asked(by(0.2)), "refused: no message of the trajectory controller arrives");
}

}  // namespace
}  // namespace handsel::ros2_lane::ros2_lane_test
