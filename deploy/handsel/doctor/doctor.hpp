// SPDX-License-Identifier: Apache-2.0
// What would stop the system from working on this machine. Each check examines one thing and says
// in one sentence what is wrong and in one what to do.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace handsel {

enum class Verdict : std::uint8_t {
  good,
  note,    ///< it works, but not as well as it could
  bad,     ///< something will not work
  missing  ///< something needed is not there
};

struct Finding {
  std::string subject;  ///< one or two words
  Verdict verdict{};    ///< decides the exit code of the command
  std::string text;     ///< what was found
  std::string remedy;   ///< what to do; empty when good
};

struct DoctorOptions {
  int domain{0};                     ///< DDS domain, 0..230
  std::string robot;                 ///< empty: the scenario's
  std::string scenario{"give_mug"};  ///< name or file
  int web_port{-1};                  ///< -1: as the bridge will choose it
  bool perception{false};            ///< a source of people and objects is meant to run here
  bool inputs_only{false};           ///< nothing but perception is checked
  bool driver{false};                ///< a robot is meant to be connected here
};

/// Processors, memory, real-time permission, room for logs, the programs and their versions.
std::vector<Finding> check_machine();
/// Scenario, robot, hand, objects and settings, read as the processes read them.
std::vector<Finding> check_descriptions(const DoctorOptions&);
/// The page's port, and processes that an earlier system left on the domain.
std::vector<Finding> check_occupation(const DoctorOptions&);
/// The DDS configuration in use, whether as many processes as a system has find each other under
/// it, and what is on the domain now. Works in processes of its own, so that nothing the transport
/// does can harm the caller.
std::vector<Finding> check_domain(const DoctorOptions&);

/// Checks whether the samples of perception processes arrive and are right: names, QoS, rate, ages,
/// frame, values. Works in a process of its own.
std::vector<Finding> check_perception(const DoctorOptions&);

}  // namespace handsel
