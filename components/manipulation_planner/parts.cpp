// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {

Parts::Parts(const settings::ManipulationPlannerSettings& s,
             std::shared_ptr<const RobotModel> robot, ObjectLibrary objects, std::uint64_t client,
             const CostSettings& cost_settings)
    : settings(s),
      cost(cost_settings),
      now(std::move(objects), robot, static_cast<int>(settings.holding_samples)),
      clients(client, outbox, waiting, settings),
      worker(outbox, waiting, settings.request_timeout),
      arm(std::move(robot), now),
      held(arm, now, settings),
      link(arm, now, waiting, outbox, clients.ids, settings),
      hand(arm, link, now, waiting, action, settings),
      retreat(arm.robot(), arm.group(), settings),
      offers(now, settings),
      area(settings, arm, retreat, now),
      shift(settings),
      monitor(arm, held, offers, area, now, settings),
      replanner(*this, settings, std::make_shared<HumanCost>(arm.robot(), cost_settings)) {}

void Parts::refuse(const std::string& what, const std::string& reason) {
  constexpr std::size_t kMaxRefusals = 32;
  if (action.refusals.size() < kMaxRefusals) action.refusals.push_back({what, reason});
}

}  // namespace handsel::manipulation_planner
