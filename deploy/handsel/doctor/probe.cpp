// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/doctor/probe.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "common/base/errors.hpp"
#include "common/bus/executor.hpp"
#include "deploy/handsel/system/session.hpp"

namespace handsel {
namespace {

constexpr Duration kEndTimeout = std::chrono::seconds(1);

int milliseconds(Duration d) {
  return static_cast<int>(
      std::max<std::int64_t>(0, std::chrono::duration_cast<std::chrono::milliseconds>(d).count()));
}

}  // namespace

Probe::Probe(const std::function<void(const Report&)>& work) {
  int channel[2];
  errors_ = memfd_create("errors", MFD_CLOEXEC);
  if (errors_ < 0 || pipe(channel) != 0)
    throw MissingError(std::string("cannot start a process to look with: ") + std::strerror(errno));
  std::fflush(nullptr);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0)
    throw MissingError(std::string("cannot start a process to look with: ") + std::strerror(errno));
  reports_ = channel[0];
  if (pid_ > 0) {
    close(channel[1]);
    return;
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(3);
  close(channel[0]);
  dup2(errors_, STDERR_FILENO);
  catch_interrupts();
  try {
    work([out = channel[1]](const std::string& line) {
      const std::string text = line + "\n";
      for (std::size_t done = 0; done < text.size();) {
        const ssize_t n = write(out, text.data() + done, text.size() - done);
        if (n <= 0) _exit(3);
        done += static_cast<std::size_t>(n);
      }
    });
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    _exit(1);
  }
  _exit(0);
}

Probe::Probe(Probe&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      reports_(std::exchange(other.reports_, -1)),
      errors_(std::exchange(other.errors_, -1)),
      text_(std::move(other.text_)) {}

Probe::~Probe() {
  if (pid_ < 0) return;
  end();
  const TimePoint deadline = monotonic_now() + kEndTimeout;
  while (line(deadline - monotonic_now())) {
  }  // closes the pipe
  if (monotonic_now() >= deadline) kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  close(reports_);
  close(errors_);
}

void Probe::end() const {
  kill(pid_, SIGTERM);
  kill(pid_, SIGCONT);
}

std::optional<std::string> Probe::line(Duration limit) {
  const TimePoint deadline = monotonic_now() + limit;
  for (;;) {
    if (const std::size_t at = text_.find('\n'); at != std::string::npos) {
      const std::string found = text_.substr(0, at);
      text_.erase(0, at + 1);
      return found;
    }
    pollfd fd{reports_, POLLIN, 0};
    if (poll(&fd, 1, milliseconds(deadline - monotonic_now())) <= 0) {
      if (errno == EINTR && monotonic_now() < deadline) continue;
      return std::nullopt;
    }
    char bytes[4096];
    const ssize_t n = read(reports_, bytes, sizeof bytes);
    if (n <= 0) return std::nullopt;
    text_.append(bytes, static_cast<std::size_t>(n));
  }
}

std::string Probe::said() const {
  std::string all;
  char bytes[4096];
  off_t at = 0;
  for (ssize_t n; (n = pread(errors_, bytes, sizeof bytes, at)) > 0; at += n)
    all.append(bytes, static_cast<std::size_t>(n));
  return all;
}

}  // namespace handsel
