// SPDX-License-Identifier: Apache-2.0
// Publishes the observations of the emulated world's sensors and the ground truth.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "sim/world.hpp"

namespace handsel::sim {

/// The topics that the simulator writes, each at its rate in simulated time.
class WorldOutput {
 public:
  /// Advertises on `bus`, which must outlive this, as must the settings.
  WorldOutput(Bus& bus, const SimSettings& settings);

  /// Forgets the published stamps; to be called when the world is replaced.
  void reset() { stamped_.clear(); }
  /// Publishes the messages due after step number `steps` of the world. `stamp_now` returns the
  /// system clock of the step [ns]; `factor`: simulated time over real time.
  void publish(SimWorld& world, std::uint64_t steps, const std::function<Stamp()>& stamp_now,
               double factor);

 private:
  /// A sample's stamp is the system clock at capture; a sample published again keeps its stamp.
  struct Stamped {
    double seen{};  ///< instant of capture [s of simulated time]
    Stamp stamp{};
  };

  void publish_observations(SimWorld& world, const std::function<Stamp()>& stamp_now);
  void publish_ground_truth(SimWorld& world, const std::function<Stamp()>& stamp_now,
                            double factor);

  std::unique_ptr<Publisher<RobotState>> state_out_;
  std::unique_ptr<Publisher<HumanObservation>> human_out_;
  std::unique_ptr<Publisher<ObjectObservation>> object_out_;
  std::unique_ptr<Publisher<RobotReport>> report_out_;
  std::unique_ptr<Publisher<GroundTruth>> ground_truth_out_;
  std::uint64_t steps_per_state_, steps_per_report_, steps_per_ground_truth_;
  RobotState state_;
  GroundTruth ground_truth_;
  std::vector<Delivery<HumanObservation>> human_due_;
  std::vector<Delivery<ObjectObservation>> object_due_;
  std::vector<RobotReport> reports_;        // of other robots
  std::map<std::string, Stamped> stamped_;  ///< by source: the newest sample
};

}  // namespace handsel::sim
