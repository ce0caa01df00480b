// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/realtime.hpp"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

#include "common/base/errors.hpp"

namespace handsel {

std::string enter_realtime(const RealtimeSettings& settings) {
  if (settings.cpu >= 0) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    CPU_SET(static_cast<std::size_t>(settings.cpu), &cpus);
    if (sched_setaffinity(0, sizeof cpus, &cpus) != 0)
      throw ConfigError("--cpu-affinity " + std::to_string(settings.cpu) + ": " +
                        std::strerror(errno));
  }
  if (!settings.wanted) return "not asked for";
  std::string note;
  sched_param parameter{};
  parameter.sched_priority = settings.priority;
  if (sched_setscheduler(0, SCHED_FIFO, &parameter) != 0)
    note = std::string("SCHED_FIFO is not permitted: ") + std::strerror(errno);
  if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0)
    note += (note.empty() ? "" : "; ") + std::string("memory cannot be locked: ") +
            std::strerror(errno);
  return note;
}

}  // namespace handsel
