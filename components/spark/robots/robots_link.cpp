// SPDX-License-Identifier: Apache-2.0
#include "components/spark/robots/robots_link.hpp"

namespace handsel::spark {

RobotsLink::RobotsLink(Bus& bus, const settings::SparkSettings& settings,
                       const std::shared_ptr<const RobotModel>& robot, const std::string& name)
    : bus_(bus),
      others_(settings, name.empty() ? robot->name() : name),
      volume_(robot),
      period_(settings.robot_period),
      out_(bus.advertise<RobotReport>()) {
  report_.robot = name.empty() ? robot->name() : name;
  bus.subscribe<RobotReport>([this](const RobotReport& report, const Receipt& receipt) {
    others_.observe(report, receipt.arrival - receipt.age);
  });
}

void RobotsLink::update(const RobotState& state) {
  if (!volume_.fits(state.position) || !volume_.fits(state.velocity)) return;
  state_ = state;
  const TimePoint now = bus_.now();
  if (to_seconds(now - published_) >= 0.99 * period_) publish(now);
}

void RobotsLink::publish(TimePoint now) {
  published_ = now;
  report_.parts = volume_.parts(state_.position, state_.velocity, state_.T_world_base);
  out_->publish(report_);
}

void RobotsLink::add_to(HumanState& people, TimePoint now, const Coverage& reach) const {
  LeftOut left_out;
  people.robots = others_.robots(now, reach, &left_out);
  if (left_out.count > 0)
    bus_.count_left_out("robot_report: farther than those named", left_out.count);
}

}  // namespace handsel::spark
