// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/node.hpp"

#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "common/config/settings_text.hpp"
#include "common/model/description/description_parts.hpp"

namespace handsel::ros2_lane {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(10);

settings::Ros2LaneSettings load(const NodeContext& context) {
  SettingsText text;
  auto s = settings::read_ros2_lane_settings(context.settings / "ros2_lane.txtpb", &text);
  if (s.world_frame.empty())
    text.refuse("world_frame", "is empty, must name the frame of TF that is our world");
  if (s.tf.empty() && (s.people || !s.objects.empty() || s.tf_out))
    text.refuse("tf", "is empty, but people, objects and tf_out need the name of TF's topic");
  if (s.people && s.people_source.empty())
    text.refuse("people_source", "is empty, a source needs a name");
  if (!s.objects.empty() && s.objects_source.empty())
    text.refuse("objects_source", "is empty, a source needs a name");
  if (!s.robot_in.empty() && s.robot_in == s.joint_states_out)
    text.refuse("robot_in", "robot_in and joint_states_out are the same topic");
  return s;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      settings_(load(context)),
      robot_(context.robot),
      topics_(bus),
      people_(settings_),
      objects_(settings_),
      samples_(settings_),
      joints_(*robot_, settings_),
      conflicts_(robot_->name()),
      output_(*robot_, settings_),
      trajectories_(bus, topics_, settings_, robot_, static_cast<std::uint64_t>(bus.stamp_now())) {
  open_people_and_objects();
  open_robot(context);
  open_trajectories();
  open_outputs();
}

void Node::open_people_and_objects() {
  topics_.read<ros2::Transforms>(
      settings_.tf, Profile::goal,
      [this](const ros2::Transforms& m, const Receipt& r) { on(m, r.arrival, false); });
  topics_.read<ros2::Transforms>(
      settings_.tf_static, Profile::state,
      [this](const ros2::Transforms& m, const Receipt& r) { on(m, r.arrival, true); });
  if (settings_.people || !settings_.objects.empty())
    bus_.subscribe<SensorRequest>(
        [this](const SensorRequest& m, const Receipt& r) { samples_.request(m, r.arrival); });
  if (settings_.people) {
    human_out_ = bus_.advertise<HumanObservation>();
    topics_.read<ros2::Ids>(
        settings_.tracked, Profile::sensor,
        [this](const ros2::Ids& m, const Receipt& r) { people_.on(m, r.arrival); });
    bus_.every(from_seconds(1 / settings_.people_rate), [this](TimePoint now) {
      if (!samples_.people_due(now)) return;
      if (const auto seen = people_.observe(tree_, now, samples_.samples_knuckles(now)))
        human_out_->publish(*seen);
    });
  }
  if (!settings_.objects.empty()) {
    object_out_ = bus_.advertise<ObjectObservation>();
    bus_.every(from_seconds(1 / settings_.objects_rate), [this](TimePoint now) {
      if (!samples_.objects_due(now)) return;
      if (const auto seen = objects_.observe(tree_, now)) object_out_->publish(*seen);
    });
  }
}

void Node::on(const ros2::Transforms& message, TimePoint arrival, bool is_static) {
  for (const ros2::Transform& transform : message.transforms) {
    if (conflicts_.contradicts(transform, arrival)) continue;
    if (!tree_.set(transform, arrival, is_static))
      bus_.set_degraded("TF has more than 4096 frames; others are left out");
    people_.on(transform);
  }
}

void Node::open_robot(const NodeContext& context) {
  if (settings_.robot_in.empty()) return;
  if (!context.scenario.empty())
    joints_.set_base(to_pose(read_scenario(context.scenario, context.seed).base()));
  robot_out_ = bus_.advertise<RobotState>();
  topics_.read<ros2::JointState>(settings_.robot_in, Profile::sensor,
                                 [this](const ros2::JointState& m, const Receipt& r) {
                                   if (const auto state = joints_.on(m, r.arrival, tree_))
                                     robot_out_->publish(*state);
                                 });
}

std::string Node::trouble() const {
  const TimePoint now = bus_.now();
  if (std::string joints = joints_.trouble(now); !joints.empty()) return joints;
  if (std::string conflict = conflicts_.trouble(now); !conflict.empty()) return conflict;
  return trajectories_.trouble(now);
}

void Node::open_trajectories() {
  bus_.every(kStep, [this](TimePoint now) {
    trajectories_.step(now);
    bus_.set_degraded(trouble());
  });
  trajectories_.open();
}

void Node::open_outputs() {
  if (settings_.joint_states_out.empty() && !settings_.tf_out) return;
  bus_.subscribe<RobotState>(
      [this](const RobotState& m, const Receipt&) { output_.on(m); },
      {from_seconds(1 / std::max(settings_.joint_states_rate, settings_.tf_rate))});
  if (!settings_.joint_states_out.empty()) {
    joints_out_ = topics_.write<ros2::JointState>(settings_.joint_states_out, Profile::goal);
    bus_.every(from_seconds(1 / settings_.joint_states_rate), [this](TimePoint) {
      if (const auto joints = output_.joints()) joints_out_->publish(*joints);
    });
  }
  if (settings_.tf_out) {
    frames_out_ = topics_.write<ros2::Transforms>(settings_.tf, Profile::goal);
    conflicts_.set_own(output_.link_parents());
    bus_.subscribe<Scene>([this](const Scene& m, const Receipt&) { output_.on(m); });
    bus_.every(from_seconds(1 / settings_.tf_rate), [this](TimePoint) {
      if (const ros2::Transforms out = output_.frames(); !out.transforms.empty())
        frames_out_->publish(out);
    });
  }
}

}  // namespace handsel::ros2_lane
