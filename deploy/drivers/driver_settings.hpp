// SPDX-License-Identifier: Apache-2.0
// Settings of the two example drivers; values and meanings as in common/config/schema/driver.proto.
#pragma once

#include <filesystem>

#include "deploy/drivers/reflex_arm.hpp"

namespace handsel::drivers {

struct PositionSettings {
  DriverSettings common;  ///< settings that every driver has
  double cycle{0.005};    ///< of the arm's controller [s]
};

struct Place {
  int port{};             ///< UDP, where the arm's controller sends its states
  std::vector<int> axes;  ///< robot axes in the order of the arm's controller
};

/// Reads <folder>/position_arm.txtpb, and the period of the set-points from
/// <folder>/trajectory_controller.txtpb. Returns port and arm axes. Throws ConfigError naming file
/// and field.
Place load_settings(const std::filesystem::path& folder, const RobotModel& robot,
                    PositionSettings& out);
/// The same for reflex_arm.txtpb.
Place load_settings(const std::filesystem::path& folder, const RobotModel& robot,
                    ReflexSettings& out);

}  // namespace handsel::drivers
