// SPDX-License-Identifier: Apache-2.0
// A piece of work in a forked process of its own: what it prints on stderr is kept, a crash in it
// is an answer.
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

#include "common/base/time.hpp"

namespace handsel {

class Probe {
 public:
  using Report = std::function<void(const std::string& line)>;

  /// Runs `work` in a child, which ends when it returns, on SIGTERM (interrupted() then holds) or
  /// with this process. The child may report lines without line feeds. Start it before this process
  /// enters a DDS domain or starts threads.
  explicit Probe(const std::function<void(const Report&)>& work);
  ~Probe();  ///< SIGTERM, after a second SIGKILL
  Probe(Probe&&) noexcept;
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;

  /// The next line reported; nullopt when it ended or `limit` is over.
  std::optional<std::string> line(Duration limit);
  /// What it has printed on stderr so far.
  std::string said() const;
  /// Asks it to end; the destructor waits for it.
  void end() const;

 private:
  pid_t pid_{-1};
  int reports_{-1}, errors_{-1};
  std::string text_;
};

}  // namespace handsel
