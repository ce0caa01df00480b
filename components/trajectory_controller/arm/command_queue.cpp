// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/arm/command_queue.hpp"

#include <utility>

namespace handsel::trajectory_controller {

void CommandQueue::restart(PathPiece piece) {
  pieces_.clear();
  pieces_.push_back(std::move(piece));
  current_ = 0;
}

void CommandQueue::switch_to(PathPiece piece, double leave, double by) {
  pieces_.erase(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(current_));
  current_ = 0;
  while (pieces_.size() > 1 && pieces_.back().begin >= leave) pieces_.pop_back();
  shift(by);
  pieces_.push_back(std::move(piece));
}

void CommandQueue::find(double time) noexcept {
  while (current_ + 1 < pieces_.size() && time >= pieces_[current_ + 1].begin) ++current_;
  while (current_ > 0 && time < pieces_[current_].begin) --current_;
}

void CommandQueue::shift(double by) noexcept {
  for (PathPiece& piece : pieces_) {
    piece.begin += by;
    piece.offset += by;
  }
}

}  // namespace handsel::trajectory_controller
