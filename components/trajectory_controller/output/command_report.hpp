// SPDX-License-Identifier: Apache-2.0
// What is reported of the commands: ids of those accepted and refused last, and why. Pure; no heap
// in step().
#pragma once

#include <cstdint>
#include <string>

namespace handsel::trajectory_controller {

class CommandReport {
 public:
  /// Returns whether a trajectory with this id was accepted last.
  bool accepted(std::uint64_t id) const noexcept { return id != 0 && id == accepted_; }
  /// Notes that a trajectory is accepted.
  void accept(std::uint64_t id);
  /// Notes that a command to stop is accepted.
  void accept_stop(std::uint64_t id);
  /// Notes that a trajectory is refused, one sentence. `cycles`: for how many the refusal is
  /// reported instead of the motion; 0: until a trajectory is accepted.
  void refuse(std::uint64_t id, const std::string& reason, int cycles);
  /// Notes that a hand command is accepted.
  void accept_hand() { reason_.clear(); }
  /// Notes that a hand command is refused, one sentence.
  void refuse_hand(std::uint64_t id, const std::string& reason);
  /// Advances by one cycle.
  void step() noexcept;

  /// Returns whether a refusal is reported instead of the motion.
  bool refused() const noexcept { return refused_; }
  /// Id of the trajectory that is reported.
  std::uint64_t trajectory() const noexcept { return refused_ ? refused_id_ : accepted_; }
  /// Id of the trajectory accepted last.
  std::uint64_t accepted_trajectory() const noexcept { return accepted_; }
  /// Reason of the refusal that is reported; empty: none.
  const std::string& reason() const noexcept { return reason_; }

 private:
  std::uint64_t accepted_{}, refused_id_{};
  bool refused_{};
  int cycles_left_{};  // 0: until a trajectory is accepted
  std::string reason_;
};

}  // namespace handsel::trajectory_controller
