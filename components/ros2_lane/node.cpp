#include "components/ros2_lane/node.hpp"

#include <cstdio>

#include "common/config/resources.hpp"
#include "common/config/schema/scenario.pb.h"
#include "common/model/description/description_parts.hpp"
#include "common/wire/ros2.hpp"

namespace handsel::ros2_lane {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(10);
constexpr double kShown = 10;  // [s] a refusal is shown in the health

settings::Ros2LaneSettings load(const NodeContext& context) {
  SettingsText text;
  const auto s = settings::read_ros2_lane_settings(context.settings / "ros2_lane.txtpb", &text);
  if (s.world_frame.empty()) text.refuse("world_frame", "is empty, must name the frame of TF that is our world");
  if (s.tf.empty() && (s.people || !s.objects.empty() || s.tf_out))
    text.refuse("tf", "is empty, but people, objects and tf_out need the name of TF's topic");
  if (s.people && s.people_source.empty()) text.refuse("people_source", "is empty, a source needs a name");
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
      people_(settings_),
      objects_(settings_),
      joints_(*robot_, settings_.joint_age),
      desk_(settings_, robot_, static_cast<std::uint64_t>(bus.stamp_now())) {
  open_people_and_objects();
  open_robot(context);
  open_trajectories();
  open_outputs();
}

template <class M>
const MessageType& Node::type(const std::string& name, Profile profile) {
  types_.push_back(ros2_type<M>(name, profile));
  return *types_.back();
}

template <class M>
void Node::read(const std::string& name, Profile profile, std::function<void(const M&, const Receipt&)> on_sample) {
  if (name.empty()) return;
  bus_.subscribe_any(type<M>(name, profile),
                     [f = std::move(on_sample)](const void* m, const Receipt& r) { f(*static_cast<const M*>(m), r); }, {});
}

template <class M>
std::unique_ptr<Publisher<M>> Node::write(const std::string& name, Profile profile) {
  return std::make_unique<Publisher<M>>(bus_.advertise_any(type<M>(name, profile), 0));
}

void Node::open_people_and_objects() {
  read<ros2::Transforms>(settings_.tf, Profile::goal, [this](const ros2::Transforms& m, const Receipt& r) { on(m, r.arrival, false); });
  read<ros2::Transforms>(settings_.tf_static, Profile::state,
                         [this](const ros2::Transforms& m, const Receipt& r) { on(m, r.arrival, true); });
  if (settings_.people) {
    human_out_ = bus_.advertise<HumanObservation>();
    read<ros2::Ids>(settings_.tracked, Profile::sensor, [this](const ros2::Ids& m, const Receipt& r) { people_.on(m, r.arrival); });
    bus_.every(from_seconds(1 / settings_.people_rate), [this](TimePoint now) {
      if (const auto seen = people_.observe(tree_, now)) human_out_->publish(*seen);
    });
  }
  if (!settings_.objects.empty()) {
    object_out_ = bus_.advertise<ObjectObservation>();
    bus_.every(from_seconds(1 / settings_.objects_rate), [this](TimePoint now) {
      if (const auto seen = objects_.observe(tree_, now)) object_out_->publish(*seen);
    });
  }
}

void Node::on(const ros2::Transforms& message, TimePoint arrival, bool is_static) {
  for (const ros2::Transform& transform : message.transforms) {
    if (const auto own = own_parents_.find(transform.child); own != own_parents_.end() && own->second != transform.parent) {
      clash_ = "TF tells frame " + transform.child + " below " + transform.parent + " from outside, and robot " + robot_->name() +
               " has a link of that name below " + own->second + ": the one from outside is left out, call it otherwise";
      clash_at_ = arrival;
      continue;
    }
    if (!tree_.set(transform, arrival, is_static)) bus_.set_degraded("TF has more than 4096 frames; others are left out");
    people_.on(transform);
  }
}

void Node::open_robot(const NodeContext& context) {
  if (settings_.robot_in.empty()) return;
  if (!context.scenario.empty()) {
    config::Scenario scenario;
    load_text_proto(context.scenario, scenario);
    T_world_base_ = to_pose(scenario.base());
  }
  robot_out_ = bus_.advertise<RobotState>();
  read<ros2::JointState>(settings_.robot_in, Profile::sensor, [this](const ros2::JointState& m, const Receipt& r) {
    joints_.on(m, r.arrival);
    robot_heard_ = true;
    gather(r.arrival);
  });
}

void Node::gather(TimePoint now) {
  auto state = joints_.state(now);
  if (!state) return;
  state->T_world_base = T_world_base_;
  if (!settings_.base_frame.empty()) {
    const auto place = tree_.find(settings_.base_frame, settings_.world_frame);
    base_known_ = place && now - place->arrival <= from_seconds(settings_.people_age);
    if (!base_known_) return;
    state->T_world_base = place->T_root_frame;
  }
  robot_out_->publish(*state);
}

std::string Node::trouble() const {
  const TimePoint now = bus_.now();
  if (robot_out_ && robot_heard_)
    if (const std::string missing = joints_.missing(now); !missing.empty()) return "JointState does not tell of " + missing;
  if (robot_out_ && robot_heard_ && !base_known_)
    return "TF has no current transform from frame " + settings_.base_frame + " to " + settings_.world_frame;
  if (!clash_.empty() && to_seconds(now - clash_at_) < kShown) return clash_;
  if (!refused_.empty() && to_seconds(now - refused_at_) < kShown) return "JointTrajectory " + refused_;
  return {};
}

void Node::open_trajectories() {
  bus_.every(kStep, [this](TimePoint now) {
    TrajectoryOutbox out;
    desk_.step(now, out);
    send(out);
    bus_.set_degraded(trouble());
  });
  if (settings_.trajectory_in.empty()) return;
  query_out_ = bus_.advertise<StateQuery>();
  request_out_ = bus_.advertise<TrajectoryRequest>();
  if (!settings_.trajectory_result.empty()) result_out_ = write<ros2::Text>(settings_.trajectory_result, Profile::goal);
  bus_.subscribe<ActionStatus>([this](const ActionStatus& m, const Receipt&) { desk_.on(m); });
  bus_.subscribe<ExecutionStatus>([this](const ExecutionStatus& m, const Receipt&) { desk_.on(m); });
  bus_.subscribe<ActiveTrajectory>([this](const ActiveTrajectory& m, const Receipt& r) { desk_.on(m, r.arrival); });
  bus_.subscribe<StateVerdict>([this](const StateVerdict& m, const Receipt&) { desk_.on(m); });
  bus_.subscribe<TrajectoryReply>([this](const TrajectoryReply& m, const Receipt&) { desk_.on(m); });
  read<ros2::JointTrajectory>(settings_.trajectory_in, Profile::goal, [this](const ros2::JointTrajectory& m, const Receipt& r) {
    TrajectoryOutbox out;
    desk_.on(m, r.arrival, out);
    send(out);
  });
}

void Node::send(const TrajectoryOutbox& out) {
  if (out.query) query_out_->publish(*out.query);
  if (out.request) request_out_->publish(*out.request);
  if (out.command) {
    if (!command_out_) command_out_ = bus_.advertise<TrajectoryCommand>();
    command_out_->publish(*out.command);
  }
  if (out.command_done) command_out_.reset();
  for (const std::string& result : out.results) {
    std::fprintf(stderr, "JointTrajectory %s\n", result.c_str());
    refused_ = result == "done" ? "" : result;
    refused_at_ = bus_.now();
    if (result_out_) result_out_->publish({result});
  }
}

void Node::open_outputs() {
  if (settings_.joint_states_out.empty() && !settings_.tf_out) return;
  bus_.subscribe<RobotState>(
      [this](const RobotState& m, const Receipt&) {
        if (m.robot == robot_->name() && m.position.size() == robot_->dof()) state_ = m;
      },
      {from_seconds(1 / std::max(settings_.joint_states_rate, settings_.tf_rate))});
  if (!settings_.joint_states_out.empty()) {
    joints_out_ = write<ros2::JointState>(settings_.joint_states_out, Profile::goal);
    bus_.every(from_seconds(1 / settings_.joint_states_rate), [this](TimePoint) {
      if (state_) joints_out_->publish(joint_state_of(*robot_, *state_));
    });
  }
  if (settings_.tf_out) {
    frames_out_ = write<ros2::Transforms>(settings_.tf, Profile::goal);
    const std::vector<Link>& links = robot_->links();
    for (std::size_t i = 1; i < links.size(); ++i)
      own_parents_[links[i].name] =
          links[static_cast<std::size_t>(robot_->joints()[static_cast<std::size_t>(links[i].parent_joint)].parent)].name;
    bus_.subscribe<Scene>([this](const Scene& m, const Receipt&) { scene_ = m; });
    bus_.every(from_seconds(1 / settings_.tf_rate), [this](TimePoint) { tell_frames(); });
  }
}

void Node::tell_frames() {
  ros2::Transforms out;
  if (state_) add_links(*robot_, *state_, settings_.world_frame, out.transforms);
  if (scene_)
    for (const SceneObject& object : scene_->objects)
      out.transforms.push_back({scene_->stamp, settings_.world_frame, settings_.object_prefix + object.id, object.T_world_object});
  if (!out.transforms.empty()) frames_out_->publish(out);
}

}  // namespace handsel::ros2_lane
