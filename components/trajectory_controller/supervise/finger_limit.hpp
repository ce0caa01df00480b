// How fast fingers may move where a person can reach the hand: the limit that keeps the stop proof
// from having to intervene. Pure, no heap after construction, noexcept. Own method.
#pragma once

#include <vector>

#include "components/trajectory_controller/supervise/stop/stop_proof.hpp"

namespace handsel::trajectory_controller {

class FingerLimit {
 public:
  /// Keeps a reference to the proof.
  FingerLimit(const StopProof& proof, const RobotModel& robot);
  FingerLimit(const FingerLimit&) = delete;
  FingerLimit& operator=(const FingerLimit&) = delete;

  /// Returns the largest fraction in (0, 1] of the fingers' comfort velocities at which the contact
  /// of a finger uses at most StopProofSettings::finger_ratio of the contact speed of each part of
  /// a person that can reach the hand before the fingers have stopped. `position`: all axes; `age`:
  /// of the human data [s]; `payload`: mass held [kg].
  double factor(const Vector& position, const Pose& T_world_base, double age, double payload,
                const PersonCapsules& people) noexcept;

 private:
  const StopProof& proof_;
  std::vector<double> comfort_speeds_;  // by axis; 0 of those that are no fingers
  double stop_time_{};                  // of a finger at its comfort velocity [s]
  std::vector<char> all_frames_;
  std::vector<FrameMotion> motions_;
  Vector at_rest_;
};

}  // namespace handsel::trajectory_controller
