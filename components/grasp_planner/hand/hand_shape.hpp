// SPDX-License-Identifier: Apache-2.0
// The hand's own solids for touch tests: slender cylinders, capsules and spheres as capsules
// (closed forms), the rest through common/collision.
#pragma once

#include <vector>

#include "common/collision/collision_shape.hpp"
#include "common/collision/gjk.hpp"
#include "components/grasp_planner/hand/finger_chain.hpp"
#include "components/grasp_planner/object/graspable.hpp"

namespace handsel::grasp_planner {

class HandShape {
 public:
  HandShape(const HandModel& hand, const std::vector<FingerChain>& chains);

  /// Returns whether a link that no finger moves touches the object. `clearance` [m] is kept from
  /// the surface (capsules only).
  bool palm_touches(const Graspable& object, const Pose& T_object_hand,
                    double clearance = 0.0) const;
  /// Returns whether a link of a finger touches the object. `clearance` > 0 grows its capsules [m];
  /// < 0 shrinks them, and boxes and meshes by 1 mm: a fingertip in contact must not count.
  /// `T_hand_step`, here and below: poses as of FingerChain::forward().
  bool finger_touches(int finger, const std::vector<Pose>& T_hand_step, const Graspable& object,
                      const Pose& T_object_hand, double clearance) const;
  /// Returns whether a finger touches links that no finger moves; pairs the model disables do not
  /// count.
  bool finger_touches_palm(int finger, const std::vector<Pose>& T_hand_step) const;
  /// Returns whether finger `a` touches finger `b`; pairs the model disables do not count.
  bool fingers_touch(int a, const std::vector<Pose>& T_hand_step_a, int b,
                     const std::vector<Pose>& T_hand_step_b) const;
  /// Returns whether the hand, palm or fingers, touches the object; `T_hand_step` by finger,
  /// `clearance` [m] as of palm_touches() and finger_touches().
  bool touches(const std::vector<std::vector<Pose>>& T_hand_step, const Graspable& object,
               const Pose& T_object_hand, double clearance) const;
  /// Each solid's middle and lowest height in the world.
  struct Low {
    Vector3 middle{Vector3::Zero()};  ///< world [m]
    double height{};                  ///< lowest z of the solid, world [m]
  };
  /// Returns middle and lowest height of every solid, for the hand at a pose in the world.
  std::vector<Low> lows(const std::vector<std::vector<Pose>>& T_hand_step,
                        const Pose& T_world_hand) const;
  /// A solid of a hand placed in some frame, for tests of hands against each other.
  struct Placed {
    /// Whether the solid has a closed form as a capsule; whether it is part of the palm.
    bool capsule{}, palm{};
    Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends of the axis of a capsule [m]
    double radius{};                                 ///< of a capsule [m]
    CollisionShapePtr shape;                         ///< of every solid, capsules too
    Pose T_frame_shape{Pose::Identity()};            ///< pose of `shape` in the frame
    ConvexCore core;                                 ///< of `shape` in the frame; unused for meshes
    Vector3 middle{Vector3::Zero()};                 ///< centre of the ball around the solid [m]
    double bound{};                                  ///< radius of the ball around the solid [m]
  };
  /// The whole hand placed in some frame.
  struct PlacedHand {
    std::vector<Placed> solids;  ///< palm first, then finger by finger
    Eigen::AlignedBox3d box;     ///< around the balls of all solids [m]
  };
  /// Places palm and fingers in the frame of T_frame_hand.
  PlacedHand placed(const std::vector<std::vector<Pose>>& T_hand_step,
                    const Pose& T_frame_hand) const;
  /// Returns whether two hands are nearer than `clearance` [m], or a palm nearer to the other hand
  /// than `palm_clearance`.
  static bool hands_touch(const PlacedHand& a, const PlacedHand& b, double clearance,
                          double palm_clearance = 0.0);
  /// Capsules of the whole hand in the hand frame; other solids as the ball around them. For
  /// free-room estimates.
  struct Round {
    Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends of the axis, equal for a ball [m]
    double radius{};                                 ///< [m]
  };
  /// Returns palm and fingers for these poses of the joints, hand frame.
  std::vector<Round> rounds(const std::vector<std::vector<Pose>>& T_hand_step) const;

 private:
  static bool nearer(const Placed& s, const Placed& t, double clearance);
  struct Solid {
    int link{};
    int step{-1};  // -1: palm
    bool capsule{};
    Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};
    double radius{};
    Pose T_step_shape{Pose::Identity()};
    CollisionShapePtr shape, shrunk;
  };
  static Solid make_solid(int link, int step, const Pose& T_step_link, const PlacedShape& placed);
  bool solid_touches(const Solid& s, const Pose& T_hand_step, const Graspable& object,
                     const Pose& T_object_hand, double clearance) const;
  static bool solids_touch(const Solid& s, const Pose& T_hand_s, const Solid& t,
                           const Pose& T_hand_t);
  bool groups_touch(const std::vector<Solid>& a, const std::vector<Pose>& T_a,
                    const std::vector<Solid>& b, const std::vector<Pose>& T_b) const;
  std::size_t pair(int link_a, int link_b) const {
    return static_cast<std::size_t>(link_a) * static_cast<std::size_t>(links_) +
           static_cast<std::size_t>(link_b);
  }
  bool disabled(int link_a, int link_b) const { return disabled_[pair(link_a, link_b)]; }

  std::vector<Solid> palm_;
  std::vector<std::vector<Solid>> fingers_;
  int links_{};
  // adjacent, excluded by the model, or touching in the hand's own rest and pre-grasp
  // configurations
  std::vector<bool> disabled_;
};

}  // namespace handsel::grasp_planner
