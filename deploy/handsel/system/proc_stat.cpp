// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/proc_stat.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace handsel {
namespace {

/// Returns the second number of a schedstat file: the run delay [ns].
Duration run_delay(const std::string& file) {
  std::ifstream in(file);
  long long running = 0, waiting = 0;
  return in >> running >> waiting ? Duration(waiting) : Duration{};
}

}  // namespace

Duration main_thread_delay(pid_t pid) {
  const std::string id = std::to_string(pid);
  return run_delay("/proc/" + id + "/task/" + id + "/schedstat");
}

Duration ThreadDelay::update(pid_t pid) {
  std::map<pid_t, Duration> now;
  Duration max_delay{};
  std::error_code error;  // threads may end during the listing
  std::filesystem::directory_iterator entry("/proc/" + std::to_string(pid) + "/task", error), end;
  for (; !error && entry != end; entry.increment(error)) {
    const pid_t thread = std::atoi(entry->path().filename().c_str());
    const Duration delay = now[thread] = run_delay(entry->path() / "schedstat");
    if (const auto before = before_.find(thread); before != before_.end())
      max_delay = std::max(max_delay, delay - before->second);
  }
  before_ = std::move(now);
  return total_ += max_delay;
}

}  // namespace handsel
