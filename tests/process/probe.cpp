// SPDX-License-Identifier: Apache-2.0
// A minimal component for the tests of run_process: answers every task goal with a status.
#include "common/bus/process.hpp"
#include "common/messages/task.hpp"

namespace {

class Node {
 public:
  Node(handsel::Bus& bus, const handsel::NodeContext& context)
      : status_(bus.advertise<handsel::TaskStatus>()) {
    bus.subscribe<handsel::TaskGoal>([this, robot = context.robot->name()](
                                         const handsel::TaskGoal& goal, const handsel::Receipt&) {
      handsel::TaskStatus status;
      status.id = goal.id;
      status.phase = robot;
      status_->publish(status);
    });
  }

 private:
  std::unique_ptr<handsel::Publisher<handsel::TaskStatus>> status_;
};

}  // namespace

int main(int argc, char** argv) { return handsel::run_process<Node>(argc, argv, "probe"); }
