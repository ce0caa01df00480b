// SPDX-License-Identifier: Apache-2.0
// Binds the trajectory controller to a bus.
#pragma once

#include <memory>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/node_context.hpp"
#include "components/trajectory_controller/controller.hpp"

namespace handsel::trajectory_controller {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  /// Subscribes to a topic with one writer.
  template <class M>
  void read(Bus& bus, std::function<void(const M&, const Receipt&)> on_sample,
            const SubscribeOptions& options = {}) {
    inputs_.push_back(&bus.subscribe<M>(std::move(on_sample), options));
  }
  void tick(TimePoint now);
  /// Whether a topic this node reads has a second writer.
  bool has_second_writer() const;

  Bus& bus_;
  ControllerSettings settings_;
  Controller core_;
  std::unique_ptr<Publisher<JointCommand>> command_out_;
  std::unique_ptr<Publisher<ActiveTrajectory>> active_out_;
  std::unique_ptr<Publisher<ExecutionStatus>> status_out_;
  std::vector<const SubscriptionStatus*> inputs_;
  const TimerStatus* timer_{};
  std::uint64_t robot_writer_{};  // of the last RobotState; 0: none yet
  std::uint64_t late_before_{};
  JointCommand command_;
  StatusKey reported_;
  TimePoint next_active_{}, next_status_{}, next_reason_{};
  // A source of people has published. Before that, its absence does not make the process degraded.
  bool watched_{};
  bool blind_{};  // the health of this process says so
};

}  // namespace handsel::trajectory_controller
