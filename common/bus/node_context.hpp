// SPDX-License-Identifier: Apache-2.0
// Inputs of a node at its start.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "common/model/object_model.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

/// Returns the model of an object by its name, or nullptr.
using ObjectLibrary = std::function<const ObjectModel*(const std::string&)>;

struct NodeContext {
  std::shared_ptr<const RobotModel> robot;  ///< model of the robot, shared by all parts of the node
  std::filesystem::path description{};      ///< file the robot came from; empty: made by hand
  ObjectLibrary objects;                    ///< every description under objects/, read at start
  std::filesystem::path scenario;           ///< scenario file; empty: none was named
  std::filesystem::path settings;           ///< directory of <box>.txtpb
  std::uint64_t seed{1};                    ///< of every random choice of the node
  /// Name of the robot for other robots in the domain: $HANDSEL_NAME, else that of the model.
  std::string name{};
  bool sim_time{};  ///< time advances as the simulator grants it
  /// Folder of what must survive a restart of the process; empty: nothing is kept.
  std::filesystem::path state{};
};

/// Reads every objects/*/*.txtpb under the resource root. Throws ConfigError naming the file.
ObjectLibrary load_object_library();

/// Returns the inputs of a node from names or paths as on the command line; empty `settings` means
/// resource_root()/config. Throws ConfigError / MissingError.
NodeContext load_context(const std::string& robot, const std::string& scenario = {},
                         const std::filesystem::path& settings = {}, std::uint64_t seed = 1);

}  // namespace handsel
