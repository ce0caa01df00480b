// SPDX-License-Identifier: Apache-2.0
#include "common/bus/process.hpp"
#include "deploy/drivers/driver_settings.hpp"
#include "deploy/drivers/udp_source.hpp"

int main(int argc, char** argv) {
  using namespace handsel;
  using namespace handsel::drivers;
  const auto make = [](Bus& bus, const NodeContext& context) {
    PositionSettings settings;
    const Place place = load_settings(context.settings, *context.robot, settings);
    auto source = std::make_unique<UdpSource<UdpCyclicLink>>(place.port);
    auto arm = std::make_unique<PositionArm>(*context.robot, place.axes, settings.cycle,
                                             source->link, settings.common);
    return std::make_shared<DriverNode>(bus, context, std::move(source), std::move(arm),
                                        settings.cycle, settings.common.max_setpoint_age);
  };
  return run_process(argc, argv, "driver", make, Urgency::control);
}
