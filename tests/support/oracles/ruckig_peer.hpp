// SPDX-License-Identifier: Apache-2.0
// Ruckig on the same problems, for comparison; only if built (HANDSEL_RUCKIG). Without Eigen: the
// source file is compiled for the processor of this machine.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace handsel::test {

constexpr std::size_t kPeerAxes = 7;

/// Position, velocity, acceleration of each axis; limits: velocity, acceleration, jerk.
struct PeerProblem {
  double from[3][kPeerAxes], to[3][kPeerAxes], limits[3][kPeerAxes];
};

class RuckigPeer {
 public:
  explicit RuckigPeer(const std::vector<PeerProblem>& problems, double period = 0.001);
  ~RuckigPeer();
  bool solve(std::size_t problem) noexcept;  ///< false: it gives none
  double duration() const noexcept;          ///< of the last one solved [s]
  /// State of the last one solved.
  void evaluate(double t, double* position, double* velocity, double* acceleration) noexcept;
  /// One control tick toward the end of a problem: begins it when the one before has ended.
  void tick(std::size_t problem) noexcept;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace handsel::test
