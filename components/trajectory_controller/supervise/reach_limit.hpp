// SPDX-License-Identifier: Apache-2.0
// How fast a path may be run so that the stop proof will hold on it: the limit that keeps the proof
// from having to intervene. Pure, no heap after construction, noexcept. Own method.
#pragma once

#include <vector>

#include "components/trajectory_controller/supervise/path_motion.hpp"
#include "components/trajectory_controller/supervise/stop/stop_proof.hpp"

namespace handsel::trajectory_controller {

/// Motion at full speed along a path, from one of its points.
struct ReachQuery {
  const Vector& position;      ///< all axes [rad, m]
  const Vector& velocity;      ///< all axes, at speed factor 1 [rad/s, m/s]
  const Vector& acceleration;  ///< of the set-point now, all axes [rad/s^2, m/s^2]
  /// Of the fingers until a stop begins, all axes, >= 0; 0 of those that are no fingers [rad/s,
  /// m/s].
  const Vector& finger_speeds;
  const StopTable& stop;                ///< of the motion at full speed
  Pose T_world_base{Pose::Identity()};  ///< base of the robot in the world
  double ease{};                        ///< time to remove the arm's acceleration [s]
  double age{};                         ///< of the human data [s]
  double payload{};                     ///< mass held [kg]
};

class ReachLimit {
 public:
  /// Keeps a reference to the proof.
  explicit ReachLimit(const StopProof& proof);
  ReachLimit(const ReachLimit&) = delete;
  ReachLimit& operator=(const ReachLimit&) = delete;

  /// Returns the largest speed factor in [0, 1] at which each link is slow enough for a contact
  /// with each part of a person before that part can be there, moving as StopProofSettings::people
  /// allow. `backward`: the path is run back.
  double factor(const ReachQuery& query, const PersonCapsules& people, bool backward) noexcept;

 private:
  const StopProof& proof_;
  std::vector<char> all_frames_;
  // Of the frames: at full speed; velocities gained until a stop begins.
  std::vector<FrameMotion> motions_, changes_;
  Vector gain_;
  std::vector<double> finger_speeds_;  // by axis
};

}  // namespace handsel::trajectory_controller
