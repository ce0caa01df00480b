// SPDX-License-Identifier: Apache-2.0
// How fast fingers may move where a person can reach the hand: the limit that keeps the stop proof
// from having to intervene, and SSM (ISO 10218-2:2025) where a person comes toward the hand. Pure,
// no heap after construction, noexcept. Own method.
#pragma once

#include <vector>

#include "components/trajectory_controller/supervise/guard.hpp"
#include "components/trajectory_controller/supervise/stop/stop_proof.hpp"

namespace handsel::trajectory_controller {

/// What fingers may do.
struct FingerBounds {
  double speed{1.0};  ///< largest fraction of their comfort velocities, (0, 1]
  bool too_near{};    ///< fingers that move or close stop: a person comes too near
};

class FingerLimit {
 public:
  /// Keeps a reference to the proof.
  FingerLimit(const StopProof& proof, const RobotModel& robot, const GuardSettings& guard);
  FingerLimit(const FingerLimit&) = delete;
  FingerLimit& operator=(const FingerLimit&) = delete;

  /// Returns the largest speed at which the contact of a finger uses at most
  /// StopProofSettings::finger_ratio of the contact speed of each part of a person that can reach
  /// the hand before the fingers have stopped, and whether a part without exemption that comes
  /// toward a hand at finger_stop_speed or faster is nearer than a stop of its fingers needs.
  /// `position`: all axes; `age`: of the human data [s]; `payload`: mass held [kg].
  FingerBounds bounds(const Vector& position, const Pose& T_world_base, double age, double payload,
                      const PersonCapsules& people) noexcept;

 private:
  bool is_too_near(const PersonCapsule& part, const Vector3& to_robot, double distance,
                   double speed, double age) const noexcept;

  const StopProof& proof_;
  GuardSettings guard_;
  std::vector<double> comfort_speeds_;  // by axis; 0 of those that are no fingers
  double stop_time_{};                  // of a finger at its comfort velocity [s]
  std::vector<char> all_frames_;
  std::vector<FrameMotion> motions_;
  Vector at_rest_;
};

}  // namespace handsel::trajectory_controller
