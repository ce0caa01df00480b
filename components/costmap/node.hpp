// SPDX-License-Identifier: Apache-2.0
// Binds the cost map to a bus.
#pragma once

#include <memory>
#include <optional>

#include "common/base/advised_period.hpp"
#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/world.hpp"
#include "components/costmap/layers.hpp"

namespace handsel::costmap {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  void step(TimePoint now);
  Vector3 p_world_robot() const;
  void make(const Person& person);
  void publish(TimePoint now);

  Bus& bus_;
  std::shared_ptr<const RobotModel> robot_;
  Duration repeat_{};
  double cell_time_{};
  MapMaker maker_;  // used by jobs only
  Watch watch_;
  AdvisedPeriod advised_period_;
  std::unique_ptr<Publisher<Costmap>> map_out_;
  std::optional<Scene> scene_;
  HumanState people_;
  const Layers* made_{};  // result of the last job; null: no person
  struct Sent {
    Costmap map;
    TimePoint time{};
  };
  std::array<Sent, std::size(kOwnLayers)> sent_;
  std::uint64_t revision_{0};
  bool making_{false};
};

}  // namespace handsel::costmap
