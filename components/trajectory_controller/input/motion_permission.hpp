// SPDX-License-Identifier: Apache-2.0
// The permission to move: the Go in force, and why there is none. Pure.
#pragma once

#include <string>

#include "components/trajectory_controller/input/sample_time.hpp"
#include "components/trajectory_controller/supervise/go_gate.hpp"

namespace handsel::trajectory_controller {

class MotionPermission {
 public:
  /// Takes a Go if GoGate lets it pass; an older epoch does not count as a sign of life.
  void set(const Go& go, TimePoint sampled);
  /// Notes whether motion waits for a person, and why.
  void set(const SafetyState& safety);
  /// Notes the state of the drives, see GoGate.
  void set(DriveMode mode) noexcept { gate_.receive(mode); }

  /// Go in force; its override factor is in [0, 1].
  const Go& go() const noexcept { return go_; }
  /// Which Go is accepted, and whether motion waits for a person.
  const GoGate& gate() const noexcept { return gate_; }
  /// Returns whether any Go that counts was received.
  bool received() const noexcept { return time_.received(); }
  /// Returns the age of the newest Go that counts; -1 before any [s].
  double age(TimePoint now) const noexcept { return time_.age(now); }
  /// Returns why the safety state, or the last Go, permits no motion; empty: no reason is known.
  std::string reason() const;

 private:
  Go go_;
  GoGate gate_;
  SampleTime time_;
  std::string safety_reason_;  // why the safety state does not permit motion
};

}  // namespace handsel::trajectory_controller
