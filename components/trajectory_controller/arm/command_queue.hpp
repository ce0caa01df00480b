// SPDX-License-Identifier: Apache-2.0
// The path of the arm is one motion made of the commands accepted: where each begins on it. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/messages/execution.hpp"

namespace handsel::trajectory_controller {

/// A command as a part of the path.
struct PathPiece {
  std::uint64_t id{};                         ///< of the command; 0: none yet
  double begin{};                             ///< where the path switches to it [s]
  double offset{};                            ///< where its own time is 0 [s]
  Attachment attachment;                      ///< what the hand holds meanwhile
  std::vector<std::string> allowed_contacts;  ///< as in the command
};

/// Times are those of the whole path [s].
class CommandQueue {
 public:
  /// Largest number of commands that wait for their turn.
  static constexpr std::size_t kMaxWaiting = 8;

  /// Piece of the path that is being run.
  const PathPiece& current() const noexcept { return pieces_[current_]; }
  /// Piece that was accepted last.
  const PathPiece& last() const noexcept { return pieces_.back(); }
  /// Returns whether no more commands may wait.
  bool full() const noexcept { return pieces_.size() > current_ + kMaxWaiting; }

  /// Begins a path with a piece.
  void restart(PathPiece piece);
  /// Switches to a piece at time `leave` of the path so far: gives up what was to come beyond, and
  /// what has been run. `shift`: how much later times are on the new path, which may have lost its
  /// beginning.
  void switch_to(PathPiece piece, double leave, double shift);
  /// Finds the piece that is being run at `time`.
  void find(double time) noexcept;
  /// All times are later by `shift`.
  void shift(double shift) noexcept;

 private:
  std::vector<PathPiece> pieces_{PathPiece{}};  // at least one
  std::size_t current_{};
};

}  // namespace handsel::trajectory_controller
