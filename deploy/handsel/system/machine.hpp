// SPDX-License-Identifier: Apache-2.0
// What /proc knows about the processes and sockets of this machine.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace handsel {

struct RunningProcess {
  pid_t pid{};                         ///< as in /proc
  std::string name;                    ///< file name of its program, without " (deleted)"
  std::vector<std::string> arguments;  ///< with argv[0]
  char state{'?'};                     ///< as in /proc/<pid>/stat: R, S, T (stopped), Z ...
  bool replaced{false};  ///< its program file is no longer the one it was started from
};

/// Returns every process whose entry in /proc is readable.
std::vector<RunningProcess> running_processes();
/// Returns the process that holds a port of this machine: "handsel_bridge (pid 7)"; empty when none
/// is found. `table` is tcp (listening) or udp.
std::string port_holder(const std::string& table, int port);

}  // namespace handsel
