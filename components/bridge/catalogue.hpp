// SPDX-License-Identifier: Apache-2.0
// What the bridge offers: the channels from the table of topics, and what the page must know that
// is not on DDS. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"
#include "components/bridge/foxglove.hpp"

namespace handsel::bridge {

struct SystemFacts {
  std::string scenario;    ///< empty: none was named
  std::uint32_t domain{};  ///< of DDS; 0 for a bus without DDS
  std::string version;     ///< of this build
  std::string session;     ///< changes with every start
  /// Outer limits of the attention zones around the robot, ascending [m].
  std::array<double, 4> zones{};
  double attentive_angle{};  ///< max angle between gaze and robot of an attentive person [rad]
};

/// An object of the search path outside the resources, whose mesh the page draws.
struct OwnMesh {
  std::filesystem::path description;  ///< Protobuf text
  std::filesystem::path mesh;         ///< file
  std::string address;                ///< of the mesh over HTTP; empty: the page cannot read it
};

/// Returns the objects of the search path that do not lie below `resources`; broken ones are left
/// out.
std::vector<OwnMesh> own_meshes(const std::filesystem::path& resources);

/// A channel for each row of the table, in its order.
Catalogue make_catalogue(const RobotModel& robot, const std::filesystem::path& resources,
                         const SystemFacts& facts);
/// The JSON of /config.json.
std::string config_json(const RobotModel& robot, const std::filesystem::path& resources,
                        const SystemFacts& facts);

}  // namespace handsel::bridge
