// SPDX-License-Identifier: Apache-2.0
// The simulator as a process: set-points that arrive too late.
#include <gtest/gtest.h>

#include <memory>

#include "common/bus/local_bus.hpp"
#include "common/bus/node_context.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "sim/node.hpp"

namespace handsel::sim_node_test {
namespace {

class SimulatorAndSender : public testing::Test {
 protected:
  SimulatorAndSender() {
    setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
    context_ = load_context("jido", HANDSEL_SOURCE_DIR "/sim/scenarios/give_mug.txtpb");
    node_ = std::make_shared<sim::Node>(network_.add("sim"), context_);
    Bus& bus = network_.add("trajectory_controller");
    out_ = bus.advertise<JointCommand>();
    bus_ = &bus;
    bus.subscribe<RobotState>([this](const RobotState& m, const Receipt&) { state_ = m; });
    bus.subscribe<GroundTruth>([this](const GroundTruth& m, const Receipt&) { truth_ = m; });
    network_.run_for(std::chrono::milliseconds(200));
    start_ = state_.reference.position;
  }
  /// Sends a set-point at rest, the first axis `offset` [rad] from the start, with a stamp of
  /// `age` ago.
  void send(double offset, Duration age) {
    JointCommand command;
    command.robot = context_.robot->name();
    command.sequence = ++sequence_;
    command.stamp = bus_->stamp_now() - age.count();
    command.position = start_;
    command.position[0] += offset;
    command.velocity = command.acceleration = Vector::Zero(start_.size());
    out_->publish(command);
    network_.run_for(std::chrono::milliseconds(1));
  }

  NodeContext context_;
  LocalNetwork network_{1};
  std::shared_ptr<sim::Node> node_;
  Bus* bus_{};
  std::unique_ptr<Publisher<JointCommand>> out_;
  RobotState state_;
  GroundTruth truth_;
  Vector start_;
  std::uint64_t sequence_{};
};

// A controller that is suspended within a cycle sends one set-point from before the suspension.
TEST_F(SimulatorAndSender, set_point_from_before_a_suspension_is_left_out) {
  for (int i = 0; i < 100; ++i) send(0, Duration::zero());
  network_.run_for(std::chrono::milliseconds(500));
  send(0.1, std::chrono::milliseconds(499));
  network_.run_for(std::chrono::milliseconds(100));
  EXPECT_EQ(truth_.limit_violations, 0u);
  EXPECT_EQ(state_.reference.position[0], start_[0]);
  send(0.1, std::chrono::milliseconds(10));
  network_.run_for(std::chrono::milliseconds(100));
  EXPECT_EQ(truth_.limit_violations, 1u) << "a recent set-point counts";
}

}  // namespace
}  // namespace handsel::sim_node_test
