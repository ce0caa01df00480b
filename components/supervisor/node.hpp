// The supervisor on a Bus.
#pragma once

#include <memory>

#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/model/arm_reach.hpp"
#include "components/supervisor/supervisor.hpp"

namespace handsel::supervisor {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  template <class M>
  void feed();
  void step(TimePoint now);

  Bus& bus_;
  config::SupervisorSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  Supervisor core_;
  std::unique_ptr<Publisher<ActionGoal>> action_out_;
  std::unique_ptr<Publisher<TaskStatus>> status_out_;
  std::unique_ptr<Publisher<Go>> go_out_;
};

}  // namespace handsel::supervisor
