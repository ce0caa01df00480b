// SPDX-License-Identifier: Apache-2.0
// The whole system in one process and virtual time: every box and the simulator on a LocalNetwork,
// and a passive observer. The bridge is left out: it shows, and nothing listens to it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/bus/node_context.hpp"
#include "deploy/handsel/system/observer.hpp"

namespace handsel {

/// What commands the trajectory controller.
enum class MotionSource {
  planner,  ///< the manipulation planner
  policy,   ///< a component that the caller adds to the network in the place of that planner
};

class LockstepSystem {
 public:
  /// Throws ConfigError / MissingError as the processes would.
  explicit LockstepSystem(const NodeContext& context, MotionSource source = MotionSource::planner);
  LockstepSystem(const std::string& scenario, const std::string& robot, std::uint64_t seed);

  /// Returns the network of all components; run it to advance the virtual time.
  LocalNetwork& network() { return network_; }
  Bus& bus() { return bus_; }                 ///< of the component "handsel"
  Observer& observer() { return observer_; }  ///< of the whole system, from construction on
  /// Newest samples, as the observer has them.
  const Snapshot& snapshot() const { return observer_.snapshot(); }
  TimePoint now() const { return network_.now(); }  ///< virtual time

 private:
  template <class Node>
  void add(const std::string& component, const NodeContext& context);

  LocalNetwork network_;
  Bus& bus_;
  Observer observer_;
  std::vector<std::shared_ptr<void>> nodes_;
};

/// What load_context() would give the processes of this scenario; the robot is the scenario's when
/// `robot` is empty.
NodeContext system_context(const std::string& scenario, const std::string& robot,
                           std::uint64_t seed, const std::filesystem::path& settings = {});

}  // namespace handsel
