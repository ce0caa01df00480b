// SPDX-License-Identifier: Apache-2.0
#include "common/bus/process.hpp"
#include "deploy/drivers/driver_settings.hpp"
#include "deploy/drivers/udp_source.hpp"

int main(int argc, char** argv) {
  using namespace handsel;
  using namespace handsel::drivers;
  const auto make = [](Bus& bus, const NodeContext& context) {
    ReflexSettings settings;
    const Place place = load_settings(context.settings, *context.robot, settings);
    auto source = std::make_unique<UdpSource<UdpReflexLink>>(place.port);
    auto arm = std::make_unique<ReflexArm>(*context.robot, place.axes, source->link, settings);
    return std::make_shared<DriverNode>(bus, context, std::move(source), std::move(arm),
                                        ReflexArm::kCycle, settings.common.max_setpoint_age);
  };
  return run_process(argc, argv, "driver", make, Urgency::control);
}
