// SPDX-License-Identifier: Apache-2.0
#include "deploy/drivers/driver_node.hpp"

#include "common/bus/executor.hpp"
#include "common/messages/execution.hpp"

namespace handsel::drivers {

DriverNode::DriverNode(Bus& bus, const NodeContext& context, std::unique_ptr<CycleSource> source,
                       std::unique_ptr<Driver> driver, double cycle, double max_age)
    : bus_(bus),
      context_(context),
      source_(std::move(source)),
      driver_(std::move(driver)),
      state_out_(bus.advertise<RobotState>()) {
  bus.subscribe<JointCommand>([this, max_age](const JointCommand& m, const Receipt& r) {
    if (m.robot != context_.robot->name())
      return bus_.count_left_out("joint_command: for another robot", 1);
    if (to_seconds(r.age) > max_age) return bus_.count_left_out("joint_command: too old", 1);
    const std::lock_guard lock(mutex_);
    driver_->command(m, to_seconds(r.arrival.time_since_epoch()));
  });
  bus.subscribe<Go>([this](const Go& m, const Receipt&) {
    if (!m.acknowledge || m.epoch == acknowledged_) return;
    acknowledged_ = m.epoch;
    const std::lock_guard lock(mutex_);
    driver_->acknowledge();
  });
  bus.every(std::chrono::milliseconds(2), [this](TimePoint) { publish(); });
  cycles_ = std::thread([this, cycle] { run_cycles(cycle); });
}

DriverNode::~DriverNode() {
  ends_ = true;
  cycles_.join();
}

void DriverNode::run_cycles(double cycle) {
  while (!ends_) {
    source_->wait(from_seconds(1.5 * cycle));
    const std::lock_guard lock(mutex_);
    driver_->cycle(to_seconds(monotonic_now().time_since_epoch()));
  }
}

void DriverNode::publish() {
  RobotState state;
  std::string trouble;
  {
    const std::lock_guard lock(mutex_);
    state = driver_->state();
    trouble = driver_->trouble();
  }
  state_out_->publish(state);
  if (trouble == reported_trouble_) return;
  reported_trouble_ = trouble;
  bus_.set_degraded(trouble);
}

}  // namespace handsel::drivers
