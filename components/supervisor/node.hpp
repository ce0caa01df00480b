// SPDX-License-Identifier: Apache-2.0
// Binds the supervisor to a bus.
#pragma once

#include <memory>

#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/model/arm_reach.hpp"
#include "components/supervisor/safety/state_store.hpp"
#include "components/supervisor/supervisor.hpp"

namespace handsel::supervisor {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  Node(Bus& bus, const NodeContext& context, const settings::SupervisorSettings& settings);
  template <class M>
  void feed();
  void on_scene(const Scene& scene, TimePoint arrival);
  void step(TimePoint now);
  void store(const DurableState& state);

  Bus& bus_;
  settings::SupervisorSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  std::shared_ptr<const StateStore> store_;  ///< null: the state is not stored
  Supervisor core_;
  std::uint64_t turned_away_counted_{0};
  std::unique_ptr<Publisher<ActionGoal>> action_out_;
  std::unique_ptr<Publisher<TaskStatus>> status_out_;
  std::unique_ptr<Publisher<Go>> go_out_;
  std::unique_ptr<Publisher<SafetyState>> safety_out_;
};

}  // namespace handsel::supervisor
