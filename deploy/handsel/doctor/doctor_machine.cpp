// SPDX-License-Identifier: Apache-2.0
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "common/base/errors.hpp"
#include "common/bus/dds/dds_configuration.hpp"
#include "common/wire/interface_id.hpp"
#include "deploy/handsel/doctor/doctor.hpp"
#include "deploy/handsel/doctor/probe.hpp"
#include "deploy/handsel/system/launcher.hpp"

namespace handsel {
namespace {

constexpr double kLittleRoom = 50e6, kEnoughRoom = 500e6;  // free space: bad, note below [bytes]
constexpr Duration kCommandTimeout = std::chrono::seconds(5);

Finding check_size() {
  const unsigned cores = std::thread::hardware_concurrency();
  const long mb = sysconf(_SC_PHYS_PAGES) / 1024 * (sysconf(_SC_PAGESIZE) / 1024);
  const std::string text =
      std::to_string(cores) + " cores, " + std::to_string(mb) + " MB of memory";
  if (cores >= 2 && mb >= 2000) return {"machine", Verdict::good, text, ""};
  return {"machine", Verdict::note, text,
          "use a machine with two cores and 2 GB or more, the smallest machine that was tried"};
}

/// Tries in a separate process what a real-time process does at its start.
std::vector<Finding> check_realtime() {
  Probe probe([](const Probe::Report& report) {
    sched_param parameter{};
    parameter.sched_priority = 20;
    report(sched_setscheduler(0, SCHED_FIFO, &parameter) == 0 ? "" : std::strerror(errno));
    const bool locked = mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;
    report(locked ? "" : std::strerror(errno));
  });
  const std::string scheduling = probe.line(kCommandTimeout).value_or("no answer"),
                    memory = probe.line(kCommandTimeout).value_or("no answer");
  std::vector<Finding> out;
  if (scheduling.empty()) {
    out.push_back({"real time", Verdict::good, "processes may ask for real-time priority", ""});
  } else {
    out.push_back(
        {"real time", Verdict::note,
         "real-time priority is not permitted (" + scheduling + "); expect more late cycles",
         "allow it with rtprio in /etc/security/limits.conf, or give the capability CAP_SYS_NICE"});
  }
  if (memory.empty()) {
    out.push_back({"memory lock", Verdict::good, "processes may lock their memory", ""});
  } else {
    out.push_back({"memory lock", Verdict::note,
                   "memory cannot be locked (" + memory + "); a page fault may delay a cycle",
                   "allow it with memlock in /etc/security/limits.conf, or give the capability "
                   "CAP_IPC_LOCK"});
  }
  return out;
}

Finding check_logs() {
  namespace fs = std::filesystem;
  const fs::path folder = state_directory();
  const std::string remedy = "free space there, or name another folder in XDG_STATE_HOME";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || access(folder.c_str(), W_OK) != 0) {
    return {"logs", Verdict::bad,
            "logs cannot be written to " + folder.string() + ": " +
                (error ? error.message() : std::strerror(errno)),
            "make it writable, or name another folder in XDG_STATE_HOME"};
  }
  struct statvfs system {};
  if (statvfs(folder.c_str(), &system) != 0)
    return {"logs", Verdict::bad, folder.string() + ": " + std::strerror(errno), remedy};
  const double room = static_cast<double>(system.f_bavail) * static_cast<double>(system.f_frsize);
  const std::string text =
      std::to_string(std::lround(room / 1e6)) + " MB are free for logs in " + folder.string();
  if (room < kLittleRoom) return {"logs", Verdict::bad, "only " + text, remedy};
  if (room < kEnoughRoom) return {"logs", Verdict::note, "only " + text, remedy};
  return {"logs", Verdict::good, text, ""};
}

std::string stdout_of(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return {};
  std::string text;
  char bytes[256];
  for (std::size_t n; (n = std::fread(bytes, 1, sizeof bytes, pipe)) > 0;) text.append(bytes, n);
  pclose(pipe);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

Finding check_programs() {
  std::vector<ProcessSpec> specs;
  try {
    specs = system_processes({.robot = "any"});
  } catch (const std::exception& error) {
    return {"programs", Verdict::missing, error.what(), "build it with ./run --build-only"};
  }
  for (const ProcessSpec& spec : specs) {
    const std::string version = stdout_of("'" + spec.binary.string() + "' --version 2>&1");
    if (version == version_text()) continue;
    return {"programs", Verdict::bad,
            spec.binary.filename().string() + " says \"" + version.substr(0, 80) +
                "\", this command is " + version_text(),
            "build all of them from one state of the sources with ./run --build-only"};
  }
  return {"programs", Verdict::good,
          "all " + std::to_string(kProcesses.size()) + " are built, " + version_text(), ""};
}

Finding check_libraries() {
  const TransportLibrary dds = transport_library();
  if (dds.agrees)
    return {"libraries", Verdict::good, "Cyclone DDS " + dds.built_for + " from " + dds.file, ""};
  return {"libraries", Verdict::bad,
          "built for Cyclone DDS " + dds.built_for + ", running with " + dds.file,
          "install libddsc0debian " + dds.built_for + ", or build again with ./run --build-only"};
}

}  // namespace

std::vector<Finding> check_machine() {
  std::vector<Finding> out{check_size()};
  for (Finding& finding : check_realtime()) out.push_back(std::move(finding));
  out.push_back(check_logs());
  out.push_back(check_programs());
  out.push_back(check_libraries());
  return out;
}

}  // namespace handsel
