// SPDX-License-Identifier: Apache-2.0
#include "components/attention/node.hpp"

#include "common/config/resources.hpp"
#include "common/model/hand_model.hpp"
#include "components/attention/settings.hpp"

namespace handsel::attention {

namespace {

constexpr Duration kAdvicePeriod = std::chrono::milliseconds(20);
constexpr Duration kStatePeriod = std::chrono::milliseconds(100);

Vector3 grasp_in_tool(const RobotModel& robot) {
  return robot.hand().empty()
             ? Vector3(Vector3::Zero())
             : Vector3(
                   HandModel::load(hand_description(robot.hand())).T_hand_grasp().translation());
}

template <class M>
const M* get(const std::optional<M>& message) {
  return message ? &*message : nullptr;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : robot_(context.robot),
      settings_(load_settings(context.settings / "attention.txtpb")),
      body_(*robot_, grasp_in_tool(*robot_)),
      core_(settings_, body_),
      advice_(bus.advertise<AttentionAdvice>()),
      state_(bus.advertise<AttentionState>()),
      request_(bus.advertise<SensorRequest>()) {
  bus.subscribe<HumanState>([this](const HumanState& m, const Receipt&) { people_ = m; });
  bus.subscribe<Facts>([this](const Facts& m, const Receipt&) { facts_ = m; });
  bus.subscribe<ActionStatus>([this](const ActionStatus& m, const Receipt&) { action_ = m; });
  bus.subscribe<ActiveTrajectory>([this](const ActiveTrajectory& m, const Receipt&) {
    if (m.robot == robot_->name()) active_ = m;
  });
  bus.subscribe<TrajectoryForecast>(
      [this](const TrajectoryForecast& m, const Receipt&) { forecast_ = m; });
  bus.subscribe<Scene>([this](const Scene& m, const Receipt&) { scene_ = m; });
  bus.every(from_seconds(settings_.tick), [this](TimePoint now) { tick(now); });
}

void Node::tick(TimePoint now) {
  const World world{get(people_), get(facts_),    get(action_),
                    get(active_), get(forecast_), get(scene_)};
  core_.step(world, now);
  if (now >= next_advice_) {
    advice_->publish(core_.advice());
    next_advice_ = now + kAdvicePeriod - from_seconds(0.5 * settings_.tick);
  }
  if (now >= next_state_) {
    state_->publish(core_.state());
    request_->publish(core_.sensor_request(world));
    next_state_ = now + kStatePeriod - from_seconds(0.5 * settings_.tick);
  }
}

}  // namespace handsel::attention
