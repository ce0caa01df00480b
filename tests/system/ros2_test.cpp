// SPDX-License-Identifier: Apache-2.0
// A publisher and readers with the names and types of ROS 2, made with Cyclone alone, beside a
// whole system with its ROS 2 bridge.
#include <dds/dds.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <regex>
#include <sstream>

#include "common/bus/dds/dds_bus.hpp"
#include "common/bus/node_context.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "idl/ros2/ros2.h"
#include "tests/support/processes/background.hpp"

namespace handsel::test::ros2_test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kDomain = 82;

/// As rclcpp makes them: reliable, volatile, keep last 10.
using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;
Qos ros_default() {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_INFINITY);
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 10);
  return qos;
}

class RosNode {
 public:
  RosNode() : participant_(dds_create_participant(kDomain, nullptr, nullptr)) {}
  ~RosNode() { dds_delete(participant_); }
  dds_entity_t writer(const dds_topic_descriptor_t& type, const char* topic) {
    return dds_create_writer(participant_,
                             dds_create_topic(participant_, &type, topic, nullptr, nullptr),
                             ros_default().get(), nullptr);
  }
  dds_entity_t reader(const dds_topic_descriptor_t& type, const char* topic) {
    return dds_create_reader(participant_,
                             dds_create_topic(participant_, &type, topic, nullptr, nullptr),
                             ros_default().get(), nullptr);
  }

 private:
  dds_entity_t participant_;
};

/// Calls with the newest sample there is; false when there is none.
template <class W>
bool take_last(dds_entity_t reader, const std::function<void(const W&)>& act) {
  bool any = false;
  void* samples[1] = {nullptr};
  dds_sample_info_t info;
  while (dds_take(reader, samples, &info, 1, 1) > 0) {
    if (info.valid_data) act(*static_cast<const W*>(samples[0]));
    any = any || info.valid_data;
    dds_return_loan(reader, samples, 1);
  }
  return any;
}

struct Frame {
  std::string parent, child;
  Vector3 at;
};

void publish(dds_entity_t writer, std::vector<Frame> frames) {
  std::vector<geometry_msgs_msg_dds__TransformStamped_> list(frames.size());
  const dds_time_t now = dds_time();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    list[i].header_.stamp_ = {static_cast<std::int32_t>(now / 1'000'000'000),
                              static_cast<std::uint32_t>(now % 1'000'000'000)};
    list[i].header_.frame_id_ = frames[i].parent.data();
    list[i].child_frame_id_ = frames[i].child.data();
    list[i].transform_.translation_ = {frames[i].at.x(), frames[i].at.y(), frames[i].at.z()};
    list[i].transform_.rotation_ = {0, 0, 0, 1};
  }
  tf2_msgs_msg_dds__TFMessage_ message{};
  message.transforms_._buffer = list.data();
  message.transforms_._length = message.transforms_._maximum =
      static_cast<std::uint32_t>(list.size());
  dds_write(writer, &message);
}

/// Returns a person at `feet` with the right hand at `hand`, in the frame of a camera, as a ROS4HRI
/// tracker publishes it.
std::vector<Frame> body(const Vector3& feet, const Vector3& hand) {
  const Vector3 camera(0.5, -1.0, 1.5);
  std::vector<Frame> out{{"world", "mast", camera}};
  for (const BodyJoint& joint : standing_body(feet, M_PI, 1.72)) {
    if (joint.name == "torso" || joint.name == "r_elbow" || joint.name == "r_wrist") continue;
    out.push_back(
        {"mast", joint.name + "_7f", (joint.name == "r_hand" ? hand : joint.position) - camera});
  }
  return out;
}

Vector3 joint_of(const std::vector<BodyJoint>& joints, const std::string& name) {
  for (const BodyJoint& joint : joints)
    if (joint.name == name) return joint.position;
  return Vector3::Constant(1e9);
}

/// Returns give_mug_external with a person from the ROS 2 bridge.
std::string scenario() {
  std::ostringstream text;
  text << std::ifstream(HANDSEL_SOURCE_DIR "/sim/scenarios/give_mug_external.txtpb").rdbuf();
  const fs::path file =
      fs::temp_directory_path() / ("handsel-ros2-" + std::to_string(getpid()) + ".txtpb");
  std::ofstream(file) << std::regex_replace(text.str(), std::regex("external: \"body_tracker\""),
                                            "external: \"ros2\"");
  return file;
}

TEST(Ros2, a_publisher_with_ros_names_moves_our_person_and_reads_our_robot) {
  setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
  setenv("CYCLONEDDS_URI", "file://" HANDSEL_SOURCE_DIR "/deploy/dds/loopback.xml", 1);
  const std::string place = scenario();
  // Loaded before the person is published: during a pause the person would count as lost.
  const NodeContext context = load_context("jido");
  Background up({HANDSEL_COMMAND, "up", "--ros2", "--headless", "--port", "0", "--domain",
                 std::to_string(kDomain), "--scenario", place});
  RosNode ros;
  const dds_entity_t tf = ros.writer(tf2_msgs_msg_dds__TFMessage__desc, "rt/tf");
  const dds_entity_t asks =
      ros.writer(trajectory_msgs_msg_dds__JointTrajectory__desc, "rt/handsel/joint_trajectory");
  const dds_entity_t joints = ros.reader(sensor_msgs_msg_dds__JointState__desc, "rt/joint_states");
  const dds_entity_t frames = ros.reader(tf2_msgs_msg_dds__TFMessage__desc, "rt/tf");
  const dds_entity_t results =
      ros.reader(std_msgs_msg_dds__String__desc, "rt/handsel/joint_trajectory_result");
  ASSERT_GT(results, 0);
  ASSERT_TRUE(up.wait_for("watch it at")) << up.said();

  DdsBus bus({.component = "ros2_test", .domain = kDomain, .health = false});
  HumanState people;
  GroundTruth ground_truth;
  RobotState robot;
  bus.subscribe<HumanState>([&](const HumanState& m, const Receipt&) { people = m; });
  bus.subscribe<GroundTruth>([&](const GroundTruth& m, const Receipt&) { ground_truth = m; });
  bus.subscribe<RobotState>([&](const RobotState& m, const Receipt&) { robot = m; });
  const Vector3 feet(2.2, 0.3, 0);
  Vector3 hand(1.7, 0.45, 1.0), goal = hand;
  bus.every(std::chrono::milliseconds(33), [&](TimePoint) {
    const Vector3 remaining = goal - hand;
    hand += remaining * std::min(1.0, 0.015 / std::max(1e-9, remaining.norm()));  // at 0.5 m/s
    goal.z() += 1e-5;
    publish(tf, body(feet, hand));
  });
  const auto follows = [&] {
    return people.people.size() == 1 && people.covered &&
           (joint_of(people.people[0].joints, "r_hand") - hand).norm() < 0.03 &&
           (joint_of(people.people[0].joints, "waist") - feet).head<2>().norm() < 0.05 &&
           (joint_of(ground_truth.person, "r_hand") - hand).norm() < 0.05;
  };
  EXPECT_TRUE(bus.run_until(follows, from_seconds(5)))
      << people.people.size() << " people, covered " << people.covered << ", SPARK's hand "
      << (people.people.empty() ? 1e9 : (joint_of(people.people[0].joints, "r_hand") - hand).norm())
      << " m off, its waist "
      << (people.people.empty()
              ? 1e9
              : (joint_of(people.people[0].joints, "waist") - feet).head<2>().norm())
      << ", the simulated hand " << (joint_of(ground_truth.person, "r_hand") - hand).norm();
  goal += Vector3(0, -0.3, 0.2);
  EXPECT_TRUE(
      bus.run_until([&] { return (goal - hand).norm() < 1e-3 && follows(); }, from_seconds(8)))
      << "SPARK's person and the simulated one go where ROS says";

  std::vector<std::string> names;
  std::vector<double> position;
  std::int64_t stamp = 0;
  bool tool_told = false, mug_told = false;
  const auto heard = [&] {
    take_last<sensor_msgs_msg_dds__JointState_>(
        joints, [&](const sensor_msgs_msg_dds__JointState_& m) {
          names.assign(m.name_._buffer, m.name_._buffer + m.name_._length);
          position.assign(m.position_._buffer, m.position_._buffer + m.position_._length);
          stamp = m.header_.stamp_.sec_ * 1'000'000'000LL + m.header_.stamp_.nanosec_;
        });
    take_last<tf2_msgs_msg_dds__TFMessage_>(frames, [&](const tf2_msgs_msg_dds__TFMessage_& m) {
      for (std::uint32_t i = 0; i < m.transforms_._length; ++i) {
        const std::string child = m.transforms_._buffer[i].child_frame_id_;
        mug_told = mug_told || child == "object_mug";
        tool_told = tool_told || child == "palm";
      }
    });
    return !names.empty() && mug_told && tool_told;
  };
  ASSERT_TRUE(bus.run_until(heard, from_seconds(3)))
      << names.size() << " joints, mug " << mug_told << ", hand " << tool_told;
  ASSERT_EQ(names.size(), context.robot->axes().size());
  ASSERT_EQ(position.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(names[i], context.robot->axes()[i].name);
    const bool moves = names[i].starts_with("head");  // the head follows the person
    EXPECT_NEAR(position[i], robot.position[static_cast<Eigen::Index>(i)], moves ? 0.1 : 2e-3)
        << names[i];
  }
  EXPECT_LT(std::abs(static_cast<double>(stamp - robot.stamp)) * 1e-9, 0.2);

  const Group& arm = context.robot->require_group("arm");
  const auto axis = static_cast<std::size_t>(arm.axes[3]);
  const double target = position[axis] + 0.15;
  const auto ask = [&](const std::string& joint, double value) {
    std::string name = joint, frame;
    char* list[] = {name.data()};
    trajectory_msgs_msg_dds__JointTrajectoryPoint_ point{};
    point.positions_._buffer = &value;
    point.positions_._length = point.positions_._maximum = 1;
    point.time_from_start_.sec_ = 1;
    trajectory_msgs_msg_dds__JointTrajectory_ message{};
    message.header_.frame_id_ = frame.data();
    message.joint_names_._buffer = list;
    message.joint_names_._length = message.joint_names_._maximum = 1;
    message.points_._buffer = &point;
    message.points_._length = message.points_._maximum = 1;
    dds_write(asks, &message);
    std::string result;
    bus.run_until(
        [&] {
          take_last<std_msgs_msg_dds__String_>(
              results, [&](const std_msgs_msg_dds__String_& m) { result = m.data_; });
          return !result.empty();
        },
        from_seconds(10));
    return result;
  };
  std::string result;  // on a busy machine the robot may be stopped on the path: then the request
  // is repeated
  for (int tries = 0; tries < 3 && result != "done"; ++tries) result = ask(names[axis], target);
  EXPECT_EQ(result, "done");
  EXPECT_NEAR(robot.position[static_cast<Eigen::Index>(axis)], target, 0.01);
  EXPECT_THAT(ask(names[axis], 50),
              testing::HasSubstr("refused: point 0 has " + names[axis] + " at 50"));
  EXPECT_THAT(ask("nonsense", 0),
              testing::HasSubstr("refused: joint nonsense is no joint of the arm"));
  EXPECT_EQ(ground_truth.limit_violations, 0u);
  EXPECT_EQ(ground_truth.self_or_scene_collisions, 0u);
  fs::remove(place);
}

}  // namespace
}  // namespace handsel::test::ros2_test
