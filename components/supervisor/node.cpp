#include "components/supervisor/node.hpp"

#include "common/config/resources.hpp"

namespace handsel::supervisor {
namespace {

config::SupervisorSettings load_settings(const NodeContext& context) {
  config::SupervisorSettings s;
  load_text_proto(context.settings / "supervisor.txtpb", s);
  if (s.period() <= 0 || s.go_period() <= 0 || s.health_timeout() <= 0)
    throw ConfigError("supervisor.txtpb: period, go_period and health_timeout must be > 0");
  if (s.speed_override() <= 0 || s.speed_override() > 1) throw ConfigError("supervisor.txtpb: speed_override must be in (0, 1]");
  return s;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      settings_(load_settings(context)),
      core_(settings_, static_cast<std::uint64_t>(bus.stamp_now())),
      action_out_(bus.advertise<ActionGoal>()),
      status_out_(bus.advertise<TaskStatus>()),
      go_out_(bus.advertise<Go>()) {
  feed<TaskGoal>();
  feed<Facts>();
  feed<ActionStatus>();
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
