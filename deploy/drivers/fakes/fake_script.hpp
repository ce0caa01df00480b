// SPDX-License-Identifier: Apache-2.0
// What happens to a fake arm, line by line: WHEN WHAT. A line waits for its moment after the line
// before has happened.
//   after 0.5     user_stop on       so many seconds after the line before, or the start
//   moving 0.2    emergency_stop on  as soon as an axis is so fast [rad/s]
//   standing 1    brake off          when no axis has moved for so many seconds
// WHAT: emergency_stop, user_stop, brake, power on|off; drop N (states lost); delay MS (of each
// state from now on); push NM (on the first axis); object M (width between the fingers); say TEXT
// (on standard output). # begins a comment.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/drivers/fakes/fake_arm.hpp"

namespace handsel::drivers {

enum class FakeTrigger : std::uint8_t { after, moving, standing };

struct FakeLine {
  FakeTrigger trigger{};    ///< event that the line waits for
  double amount{};          ///< [s], or [rad/s] of moving
  std::string verb, value;  ///< what happens, and the rest of the line; known verbs: as above
};

/// Throws ConfigError naming file and line.
std::vector<FakeLine> load_fake_script(const std::filesystem::path& file);

class FakeScript {
 public:
  explicit FakeScript(std::vector<FakeLine> lines) : lines_(std::move(lines)) {}
  /// Once a cycle of `dt` [s]; what is said comes back, empty: nothing.
  std::string step(FakeArm& arm, double dt);
  double delay() const { return delay_; }  ///< of the states [s]

 private:
  std::vector<FakeLine> lines_;
  std::size_t next_{};
  double waited_{}, stood_{}, delay_{};
};

}  // namespace handsel::drivers
