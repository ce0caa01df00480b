// SPDX-License-Identifier: Apache-2.0
// The links that the axes move, reduced to what fast repeated kinematics needs: one frame a moving
// joint, capsules fixed to it. Pure.
#pragma once

#include <map>
#include <vector>

#include "common/model/robot_capsules.hpp"

namespace handsel::trajectory_controller {

/// An axis and how far it can move a point at most.
struct Lever {
  int axis{};  ///< of the robot
  /// Largest distance of a point from the axis, in any configuration [m]; 1 for a sliding axis.
  double length{};
};

/// A capsule on a moving frame.
struct ChainCapsule {
  int frame{};                                     ///< index into MovingChain::frames()
  int link{};                                      ///< of the robot
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends of its axis, in the frame [m]
  double radius{};                                 ///< [m]
  std::vector<Lever> carried;                      ///< axes that move the frame
  /// Of a sphere about the fingers of a hand: for each part of them, the axes that move the part.
  std::vector<std::vector<Lever>> fingers;

  double finger_mass{};  ///< of the heaviest finger [kg]

  /// Returns the largest sum of lever times `by_axis` (one value >= 0 an axis) over the fingers.
  double bound(const std::vector<double>& by_axis) const noexcept;
  /// Returns the part of bound() that comes from the axes that carry the frame.
  double carried_bound(const std::vector<double>& by_axis) const noexcept;
  /// Returns the part of bound() that comes from the axes of the fingers; 0 without fingers.
  double inner_bound(const std::vector<double>& by_axis) const noexcept;
};

/// One moving joint.
struct ChainFrame {
  int parent{-1};                ///< frame it is carried by; -1: the root of the robot
  int axis{};                    ///< robot axis that drives it
  bool sliding{};                ///< prismatic joint; false: revolute
  double factor{1.0}, offset{};  ///< joint value = factor * position + offset
  /// Orientation of the joint in the parent frame at joint value 0.
  Eigen::Matrix3d R_parent_joint{Eigen::Matrix3d::Identity()};
  Vector3 p_parent_joint{Vector3::Zero()};  ///< [m]
  Vector3 direction{Vector3::UnitZ()};      ///< of the joint's axis, in the joint's frame
};

/// Where a frame is and how it moves, root axes.
struct FrameMotion {
  Eigen::Matrix3d R{Eigen::Matrix3d::Identity()};  ///< orientation of the frame in the root frame
  Vector3 p{Vector3::Zero()};                      ///< position of its origin [m]
  Vector3 linear{Vector3::Zero()};                 ///< velocity of its origin [m/s]
  Vector3 angular{Vector3::Zero()};                ///< [rad/s]
};

class MovingChain {
 public:
  /// Capsules on links that no axis moves are left out. The fingers of each hand are one sphere,
  /// see enclose_hands().
  MovingChain(const RobotModel& robot, const std::vector<LinkCapsule>& capsules);

  /// Fits the sphere of each hand to its fingers at the positions of all axes, where these have
  /// moved. Allocates nothing.
  void enclose_hands(const Vector& position) noexcept;
  const std::vector<ChainFrame>& frames() const noexcept { return frames_; }  ///< parents first
  /// Capsules on moving links, and one sphere for the fingers of each hand.
  const std::vector<ChainCapsule>& capsules() const noexcept { return capsules_; }
  /// By axis: does it slide?
  const std::vector<char>& sliding() const noexcept { return sliding_; }
  /// Computes the frames marked in `needed` (one entry a frame, carriers marked too), for positions
  /// and velocities of all axes. `out` has one entry a frame. Allocates nothing.
  void move(const Vector& position, const Vector& velocity, const std::vector<char>& needed,
            std::vector<FrameMotion>& out) const noexcept;

 private:
  /// A part of a finger.
  struct FingerPart {
    int frame{-1};  // index into finger_frames_; -1: it is carried by the hand itself
    Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};
    double radius{};
  };
  struct Hand {
    std::size_t capsule{};
    std::vector<ChainFrame> frames;  // of its fingers; parent -1: the frame of the hand
    std::vector<FingerPart> parts;
    std::vector<double> enclosed_at;  // positions of the axes of `frames`
    std::vector<FrameMotion> placed;
  };
  void add_hands(const RobotModel& robot, std::map<int, Hand>& hands);

  std::vector<ChainFrame> frames_;
  std::vector<ChainCapsule> capsules_;
  std::vector<Hand> hands_;
  std::vector<char> sliding_;
};

}  // namespace handsel::trajectory_controller
