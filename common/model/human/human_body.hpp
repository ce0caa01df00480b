// SPDX-License-Identifier: Apache-2.0
// The human body: REP-155 joints, capsules for distance, cylinder and sphere for the safety cost
// (chapter Fig. 12a).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/messages/world.hpp"

namespace handsel {

/// The joints every complete body has, REP-155 names.
inline constexpr std::array kBodyJoints = {
    "head",    "neck",   "torso",      "waist",   "l_shoulder", "l_elbow",
    "l_wrist", "l_hand", "r_shoulder", "r_elbow", "r_wrist",    "r_hand",
    "l_hip",   "l_knee", "l_ankle",    "r_hip",   "r_knee",     "r_ankle"};
int body_joint_index(const std::string& name);  ///< -1 if it is none of them

enum class BodyPart {
  head,
  torso,
  upper_arm_left,
  forearm_left,
  hand_left,
  upper_arm_right,
  forearm_right,
  hand_right,
  leg_left,
  leg_right
};

/// A capsule between two body points, world frame, inflated by Person::inflation.
struct BodyCapsule {
  BodyPart part{};                                 ///< which it covers
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends of the straight part [m]
  double radius{};                                 ///< [m]
};

/// Number of capsules that cover a person: head, neck, shoulders, three down the trunk, two an arm
/// and one a hand, two a leg.
inline constexpr int kBodyCapsules = 16;
/// Returns the kBodyCapsules capsules of the person, which is completed first if joints are
/// missing; none without joints.
std::vector<BodyCapsule> body_capsules(const Person&);
/// The same without allocation, for a person with all kBodyJoints in order; others are completed
/// first.
void body_capsules(const Person&, std::array<BodyCapsule, kBodyCapsules>& out);

/// The chapter's simplified human: a vertical cylinder for the body and a sphere for the head, arms
/// left out.
struct SimplifiedBody {
  Vector3 axis_bottom{Vector3::Zero()};  ///< on the floor, world [m]
  double height{}, radius{};             ///< of the cylinder [m]
  Vector3 head{Vector3::Zero()};         ///< centre of the sphere, world [m]
  double head_radius{};                  ///< inflation included [m]
};
/// Returns cylinder and sphere of the person, inflated by Person::inflation; all 0 if no body can
/// be made of the joints.
SimplifiedBody simplified_body(const Person&);

/// Fits a complete body to whatever joints were seen: those stay where they were seen; the others
/// come from `previous` (may be null), or from proportions of the stature, moved along with the
/// nearest seen ones (bent limbs by their bone lengths, an unseen hand along the forearm). Joints
/// with a confidence below 0.05, unknown names or positions that are not finite count as unseen.
/// Velocities are left 0: no time is known here. Returns joints in kBodyJoints order; empty when
/// nothing was seen and there is no previous body. Own method: any subset of joints gives a body.
std::vector<BodyJoint> fit_body(const ObservedPerson&, const Person* previous, double stature);

/// A standing body of the given stature at `feet` facing yaw (rotation about z, 0 = +x), arms
/// hanging. For tests, sim and fitting.
std::vector<BodyJoint> standing_body(const Vector3& feet, double yaw, double stature);

/// The same sitting on a seat of height 0.26 of the stature, thighs forward; `floor_point` is the
/// point of the floor below the hips.
std::vector<BodyJoint> sitting_body(const Vector3& floor_point, double yaw, double stature);

/// Where the person's hand would take an object comfortably: world point in front of the right (or
/// left) shoulder.
Vector3 comfortable_reach(const Person&, Side side);

}  // namespace handsel
