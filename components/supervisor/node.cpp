#include "components/supervisor/node.hpp"

#include "common/config/resources.hpp"
#include "common/config/robot.pb.h"
#include "common/model/manipulator.hpp"

namespace handsel::supervisor {
namespace {

config::SupervisorSettings load_settings(const NodeContext& context) {
  config::SupervisorSettings s;
  load_text_proto(context.settings / "supervisor.txtpb", s);
  if (s.period() <= 0 || s.go_period() <= 0 || s.health_timeout() <= 0)
    throw ConfigError("supervisor.txtpb: period, go_period and health_timeout must be > 0");
  if (s.speed_override() <= 0 || s.speed_override() > 1) throw ConfigError("supervisor.txtpb: speed_override must be in (0, 1]");
  if (s.domain().empty()) throw ConfigError("supervisor.txtpb: domain must name the file of the task domain, e.g. \"tasks.txtpb\"");
  if (s.plan_nodes() == 0 || s.plan_depth() == 0 || s.spot() <= 0)
    throw ConfigError("supervisor.txtpb: plan_nodes, plan_depth and spot must be > 0");
  return s;
}

Ability ability_of(const config::SupervisorSettings& settings, const NodeContext& context) {
  Ability ability;
  ability.spot = settings.spot();
  ability.objects = context.objects;
  if (context.robot == nullptr) return ability;
  if (const auto it = settings.payload().find(context.robot->name()); it != settings.payload().end()) ability.payload = it->second;
  ability.reach = arm_reach(*context.robot).length;
  if (context.description.empty()) return ability;
  config::RobotDescription description;
  load_text_proto(context.description, description);
  ability.hands = 1 + description.other_arms_size();
  return ability;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      settings_(load_settings(context)),
      robot_(context.robot),
      core_(settings_, load_domain(context.settings / settings_.domain()), ability_of(settings_, context),
            static_cast<std::uint64_t>(bus.stamp_now())),
      action_out_(bus.advertise<ActionGoal>()),
      status_out_(bus.advertise<TaskStatus>()),
      go_out_(bus.advertise<Go>()) {
  feed<TaskGoal>();
  feed<Facts>();
  bus.subscribe<Scene>([this](const Scene& scene, const Receipt& receipt) {
    const int shoulder = robot_ != nullptr ? arm_reach(*robot_).shoulder : -1;
    if (shoulder >= 0 && scene.robot_known)
      core_.set_shoulder((scene.T_world_base * robot_->link_pose(scene.robot_position, shoulder)).translation());
    if (shoulder >= 0 && scene.robot_known) {
      std::vector<Ability::Arm> others;
      const std::vector<Manipulator> hands = hands_of(*robot_);
      for (std::size_t i = 1; i < hands.size(); ++i) {
        const ArmReach other = arm_reach(*robot_, hands[i].arm, hands[i].palm);
        others.push_back({(scene.T_world_base * robot_->link_pose(scene.robot_position, other.shoulder)).translation(), other.length});
      }
      core_.set_other_arms(others);
    }
    core_.on(scene, receipt.arrival);
  });
  feed<ActionStatus>();
  feed<AttentionAdvice>();
  feed<ComponentHealth>();
  feed<ExecutionStatus>();
  bus.set_degraded("the state of the world is not known yet");
  bus.every(from_seconds(settings_.period()), [this](TimePoint now) { step(now); });
}

template <class M>
void Node::feed() {
  bus_.subscribe<M>([this](const M& message, const Receipt& receipt) { core_.on(message, receipt.arrival); });
}

void Node::step(TimePoint now) {
  Outbox out;
  core_.step(now, out);
  bus_.set_degraded(core_.knows_world() ? "" : "the state of the world is not known yet");
  for (const auto& goal : out.action_goals) action_out_->publish(goal);
  for (const auto& status : out.task_statuses) status_out_->publish(status);
  if (out.go) go_out_->publish(*out.go);
}

}  // namespace handsel::supervisor
