// What the bridge offers: the channels from the table of topics, and what the page must know that
// is not on DDS. Pure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/model/robot_model.hpp"
#include "components/bridge/foxglove.hpp"

namespace handsel::bridge {

struct SystemFacts {
  std::string scenario;    ///< empty: none was named
  std::uint32_t domain{};  ///< of DDS; 0 for a bus without DDS
  std::string version;     ///< of this build
  std::string session;     ///< changes with every start
};

/// A channel for each row of the table, in its order.
Catalogue make_catalogue(const RobotModel& robot, const std::filesystem::path& resources,
                         const SystemFacts& facts);
/// The JSON of /config.json.
std::string config_json(const RobotModel& robot, const std::filesystem::path& resources,
                        const SystemFacts& facts);

}  // namespace handsel::bridge
