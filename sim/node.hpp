// SPDX-License-Identifier: Apache-2.0
// Binds the emulated world to a bus. The node publishes and receives the messages of real hardware,
// so no component depends on the simulation.
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "common/bus/bus.hpp"
#include "common/bus/node_context.hpp"
#include "common/config/schema/scenario.pb.h"
#include "sim/known_processes.hpp"
#include "sim/real_time_factor.hpp"
#include "sim/set_point_age.hpp"
#include "sim/time_keeper.hpp"
#include "sim/world.hpp"
#include "sim/world_output.hpp"

namespace handsel::sim {

class Node {
 public:
  /// Starts the world of the scenario; `bus` must outlive this. Throws ConfigError, also without a
  /// scenario.
  Node(Bus& bus, const NodeContext& context);

 private:
  void tick(TimePoint now);
  /// With simulated time: makes the due steps whose inputs have arrived.
  void step_when_granted(TimePoint now);
  void announce(TimePoint now);
  Stamp stamp_now() const;
  /// Steps the world and publishes its state.
  void step_world();
  void on_control(const SimControl&);
  void restart();

  NodeContext context_;
  SimSettings settings_;
  config::Scenario scenario_;
  Bus& bus_;
  WorldOutput output_;
  std::unique_ptr<SimWorld> world_;
  std::unique_ptr<Publisher<SimClock>> clock_out_;  // with simulated time only
  std::optional<TimeKeeper> keeper_;                // with simulated time only
  struct SetPoint {
    JointCommand message;
    std::uint64_t writer{};
  };
  KnownProcesses processes_;         // processes that answered a grant
  std::deque<SetPoint> set_points_;  // waiting for a step
  SetPointAge set_point_age_;
  SimClock clock_;
  TimePoint announced_{};
  std::uint64_t steps_{0}, since_start_{0};
  bool paused_{false}, started_{false};
  TimePoint start_{};
  RealTimeFactor factor_;
};

}  // namespace handsel::sim
