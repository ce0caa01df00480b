// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/machine.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

namespace handsel {
namespace {

namespace fs = std::filesystem;

std::vector<pid_t> all_pids() {
  std::vector<pid_t> pids;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
    const pid_t pid = std::atoi(entry.path().filename().c_str());
    if (pid > 0) pids.push_back(pid);
  }
  return pids;
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

RunningProcess describe(pid_t pid) {
  const fs::path folder = "/proc/" + std::to_string(pid);
  RunningProcess out{.pid = pid};
  std::error_code error;
  std::string program = fs::read_symlink(folder / "exe", error).filename();
  constexpr std::string_view kDeleted = " (deleted)";
  if (program.size() > kDeleted.size() && program.ends_with(kDeleted)) {
    program.resize(program.size() - kDeleted.size());
    out.replaced = true;
  }
  out.name = program;
  std::istringstream arguments(content(folder / "cmdline"));
  for (std::string argument; std::getline(arguments, argument, '\0');)
    out.arguments.push_back(argument);
  const std::string stat = content(folder / "stat");
  if (const auto at = stat.rfind(") "); at != std::string::npos && at + 2 < stat.size())
    out.state = stat[at + 2];
  return out;
}

/// Returns the inodes of the sockets bound to a port, of IPv4 and IPv6.
std::set<std::string> inodes_of(const std::string& table, int port) {
  constexpr const char* kListening = "0A";
  std::set<std::string> inodes;
  for (const char* version : {"", "6"}) {
    std::ifstream in("/proc/net/" + table + version);
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
      std::istringstream words(line);
      const std::vector<std::string> row{std::istream_iterator<std::string>(words), {}};
      if (row.size() < 10 || row[1].find(':') == std::string::npos) continue;
      if (table == "tcp" && row[3] != kListening) continue;
      if (std::strtol(row[1].substr(row[1].find(':') + 1).c_str(), nullptr, 16) == port)
        inodes.insert(row[9]);
    }
  }
  return inodes;
}

}  // namespace

std::vector<RunningProcess> running_processes() {
  std::vector<RunningProcess> out;
  for (const pid_t pid : all_pids()) out.push_back(describe(pid));
  return out;
}

std::string port_holder(const std::string& table, int port) {
  const std::set<std::string> inodes = inodes_of(table, port);
  if (inodes.empty()) return {};
  for (const pid_t pid : all_pids()) {
    std::error_code error;
    for (const auto& entry :
         fs::directory_iterator("/proc/" + std::to_string(pid) + "/fd", error)) {
      const std::string target = fs::read_symlink(entry.path(), error);
      if (target.rfind("socket:[", 0) != 0 || !inodes.contains(target.substr(8, target.size() - 9)))
        continue;
      const std::string name = describe(pid).name;
      return (name.empty() ? "a process" : name) + " (pid " + std::to_string(pid) + ")";
    }
  }
  return {};
}

}  // namespace handsel
