// SPDX-License-Identifier: Apache-2.0
// Binds a driver to a bus: set-points and permissions in; the robot's state out. The arm's cycles
// run on a thread of their own.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/node_context.hpp"
#include "deploy/drivers/driver_core.hpp"

namespace handsel::drivers {

/// The maker's side as the thread sees it.
class CycleSource {
 public:
  virtual ~CycleSource() = default;
  /// Until a cycle of the arm's controller begins; false after `at_most`.
  virtual bool wait(Duration at_most) = 0;
};

class DriverNode {
 public:
  /// `cycle` of the arm's controller [s]; set-points older than `max_age` [s] are left out.
  DriverNode(Bus& bus, const NodeContext& context, std::unique_ptr<CycleSource> source,
             std::unique_ptr<Driver> driver, double cycle, double max_age);
  ~DriverNode();
  DriverNode(const DriverNode&) = delete;
  DriverNode& operator=(const DriverNode&) = delete;

 private:
  void run_cycles(double cycle);
  void publish();

  Bus& bus_;
  NodeContext context_;
  std::unique_ptr<CycleSource> source_;
  std::unique_ptr<Driver> driver_;
  std::unique_ptr<Publisher<RobotState>> state_out_;
  std::string reported_trouble_{"-"};
  std::uint64_t acknowledged_{};  // epoch
  std::mutex mutex_;              // the driver: between its cycles and the bus
  std::atomic<bool> ends_{false};
  std::thread cycles_;
};

}  // namespace handsel::drivers
