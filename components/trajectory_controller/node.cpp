// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/node.hpp"

#include <algorithm>

#include "components/trajectory_controller/settings.hpp"

namespace handsel::trajectory_controller {

namespace {
constexpr Duration kReportPeriod = std::chrono::milliseconds(20);
constexpr Duration kReasonPeriod = std::chrono::seconds(
    1);  // min period of the reason in ComponentHealth, which contains a changing time
}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      settings_(load_settings(context.settings / "trajectory_controller.txtpb")),
      core_(settings_, context.robot),
      command_out_(bus.advertise<JointCommand>()),
      active_out_(bus.advertise<ActiveTrajectory>()),
      status_out_(bus.advertise<ExecutionStatus>()) {
  command_.robot = context.robot->name();
  read<RobotState>(bus,
                   [this, &bus](const RobotState& m, const Receipt& r) {
                     if (m.robot != command_.robot)
                       return bus.count_left_out("robot_state: of another robot", 1);
                     core_.on(m, r.arrival, r.age, robot_writer_ != 0 && r.writer != robot_writer_);
                     robot_writer_ = r.writer;
                   },
                   {.wakes = false});
  read<HumanState>(bus, [this](const HumanState& m, const Receipt& r) {
    watched_ = watched_ || !m.views.empty();
    core_.on(m, r.arrival - r.age);
  });
  read<Go>(bus, [this](const Go& m, const Receipt& r) { core_.on(m, r.arrival); });
  read<SafetyState>(bus, [this](const SafetyState& m, const Receipt&) { core_.on(m); });
  bus.subscribe<TrajectoryForecast>(
      [this](const TrajectoryForecast& m, const Receipt& r) { core_.on(m, r.arrival); });
  bus.subscribe<AttentionAdvice>(
      [this](const AttentionAdvice& m, const Receipt& r) { core_.on(m, r.arrival); });
  read<ActionStatus>(bus,
                     [this](const ActionStatus& m, const Receipt& r) { core_.on(m, r.arrival); });
  read<TrajectoryCommand>(bus, [this](const TrajectoryCommand& m, const Receipt& r) {
    core_.accept(m, r.age, r.arrival);
  });
  read<HandCommand>(
      bus, [this](const HandCommand& m, const Receipt& r) { core_.accept(m, r.age, r.arrival); });
  timer_ = &bus.every(from_seconds(settings_.period), [this](TimePoint now) { tick(now); });
}

bool Node::has_second_writer() const {
  return std::any_of(inputs_.begin(), inputs_.end(),
                     [](const SubscriptionStatus* input) { return !input->second_writer.empty(); });
}

void Node::tick(TimePoint now) {
  // A process that is suspended within a cycle sends an obsolete set-point once it runs again: the
  // time of the begin of the cycle tells.
  command_.stamp = bus_.stamp_now();
  const std::uint64_t late = timer_ ? timer_->late_cycles : 0;
  if (core_.step(now, late != late_before_) && !settings_.dry_run) {
    ++command_.sequence;
    command_.position = core_.set_point().position;
    command_.velocity = core_.set_point().velocity;
    command_.acceleration = core_.set_point().acceleration;
    command_.effort = core_.hands().effort();
    command_.payload = core_.hands().payload();
    command_.other_payloads = core_.hands().other_payloads();
    command_out_->publish(command_);
  }
  late_before_ = late;
  if (const StatusKey key = core_.status_key(); now >= next_status_ || !(key == reported_)) {
    ExecutionStatus status = core_.status();
    if (has_second_writer()) status.causes |= bit(Cause::second_writer);
    status_out_->publish(status);
    if (const bool blind = watched_ && (status.causes & bit(Cause::blind)) != 0;
        blind != blind_ || (blind && now >= next_reason_)) {
      bus_.set_degraded(blind ? status.reason : "");
      blind_ = blind;
      next_reason_ = now + kReasonPeriod;
    }
    reported_ = key;
    next_status_ = now + kReportPeriod - from_seconds(0.5 * settings_.period);
  }
  if (now >= next_active_) {
    active_out_->publish(core_.active());
    next_active_ = now + kReportPeriod - from_seconds(0.5 * settings_.period);
  }
}

}  // namespace handsel::trajectory_controller
