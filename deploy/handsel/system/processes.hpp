// SPDX-License-Identifier: Apache-2.0
// Which processes make the system, and how each is started.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace handsel {

/// Every process of the running system: the boxes of the architecture and the simulator. The only
/// list of them.
inline constexpr std::array kProcesses = {
    "sim",        "spark",        "costmap",       "collision_checker",  "trajectory_controller",
    "attention",  "path_planner", "grasp_planner", "trajectory_planner", "manipulation_planner",
    "supervisor", "bridge"};

/// A process to start and keep alive.
struct ProcessSpec {
  std::string name;                    ///< the component, as ComponentHealth names it
  std::filesystem::path binary;        ///< beside the running program
  std::vector<std::string> arguments;  ///< without argv[0]
  /// "NAME=value", beside the environment of this process.
  std::vector<std::string> environment{};
};

/// What the whole system is started with.
struct SystemOptions {
  int domain{0};                     ///< DDS domain, 0..230
  std::string robot;                 ///< empty: the scenario's
  std::string scenario{"give_mug"};  ///< name or file
  std::uint64_t seed{1};             ///< of the simulation
  bool ros2{false};                  ///< with the process that connects to ROS 2
  int web_port{-1};                  ///< of the bridge; 0: any free one; -1: as its settings say
  std::string web_token;             ///< secret of the page, for the bridge; empty: no commands
  std::string record;                ///< file to record into; empty: none
  std::map<std::string, std::string> notes;  ///< of a study, for the record's metadata
  /// Of kProcesses, when the others run on another host; both empty: all.
  std::vector<std::string> only, without;
  /// Returns true when no process is left to another host.
  bool whole() const { return only.empty() && without.empty(); }
};

/// One ProcessSpec for each of kProcesses that is asked for, and of what else is; throws
/// MissingError naming the first binary that is not beside this one, ConfigError when `only` or
/// `without` names no process or nothing is left.
std::vector<ProcessSpec> system_processes(const SystemOptions&);
/// Folder of what survives the processes; empty when no supervisor is started here.
std::filesystem::path state_folder(const SystemOptions&);
/// The robot asked for, else the scenario's, else jido. Throws as check_system().
std::string robot_of(const SystemOptions&);
/// Reads the scenario, the robot and every object it names, as the processes will. Throws
/// ConfigError / MissingError.
void check_system(const SystemOptions&);

}  // namespace handsel
