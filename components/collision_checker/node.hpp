// SPDX-License-Identifier: Apache-2.0
// The collision checker on a Bus.
#pragma once

#include <memory>

#include "common/base/advised_period.hpp"
#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "components/collision_checker/forecaster.hpp"

namespace handsel::collision_checker {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  void forecast(TimePoint now);
  void answer(const StateQuery& query);

  Bus& bus_;
  std::shared_ptr<const RobotModel> robot_;
  double check_time_{};
  Duration max_age_{};
  std::size_t queries_waiting_{0};
  Forecaster forecaster_;
  CollisionWorld query_world_;  // used by jobs only, which run one after the other
  AdvisedPeriod advised_period_;
  bool news_{true};  // another trajectory, or another scene: not to be waited with
  std::unique_ptr<Publisher<TrajectoryForecast>> forecast_out_;
  std::unique_ptr<Publisher<StateVerdict>> verdict_out_;
  ActiveTrajectory active_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const HumanState> people_;
  bool scene_waits_{}, people_wait_{};  // for the next forecast
  CostLayers layers_;
};

}  // namespace handsel::collision_checker
