// SPDX-License-Identifier: Apache-2.0
// Binds the attentional system to a bus.
#pragma once

#include <memory>
#include <optional>

#include "common/bus/bus.hpp"
#include "common/bus/node_context.hpp"
#include "components/attention/attention.hpp"

namespace handsel::attention {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  void tick(TimePoint now);

  std::shared_ptr<const RobotModel> robot_;
  AttentionSettings settings_;
  Body body_;
  Attention core_;
  std::optional<HumanState> people_;
  std::optional<Facts> facts_;
  std::optional<ActionStatus> action_;
  std::optional<ActiveTrajectory> active_;
  std::optional<TrajectoryForecast> forecast_;
  std::optional<Scene> scene_;
  std::unique_ptr<Publisher<AttentionAdvice>> advice_;
  std::unique_ptr<Publisher<AttentionState>> state_;
  std::unique_ptr<Publisher<SensorRequest>> request_;
  TimePoint next_advice_{}, next_state_{};
};

}  // namespace handsel::attention
