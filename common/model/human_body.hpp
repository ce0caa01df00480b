// The human body: REP-155 joints, capsules for distance, cylinder and sphere for the safety cost (chapter Fig. 12a).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/messages/world.hpp"

namespace handsel {

/// The joints every complete body has, REP-155 names.
inline constexpr std::array kBodyJoints = {"head",     "neck",    "torso",   "waist",      "l_shoulder", "l_elbow", "l_wrist", "l_hand", "r_shoulder",
                                           "r_elbow",  "r_wrist", "r_hand",  "l_hip",      "l_knee",     "l_ankle", "r_hip",   "r_knee", "r_ankle"};
int body_joint_index(const std::string& name);  ///< -1 if it is none of them

enum class BodyPart { head, torso, upper_arm_left, forearm_left, hand_left, upper_arm_right, forearm_right, hand_right, leg_left, leg_right };

/// A capsule between two body points, world frame, inflated by Person::inflation.
struct BodyCapsule {
  BodyPart part{};
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends of the straight part [m]
  double radius{};
};

/// Capsules covering the person (legs as one each).
std::vector<BodyCapsule> body_capsules(const Person&);

/// The chapter's simplified human: a vertical cylinder for the body and a sphere for the head, arms left out.
struct SimplifiedBody {
  Vector3 axis_bottom{Vector3::Zero()};  ///< on the floor
  double height{}, radius{};             ///< cylinder
  Vector3 head{Vector3::Zero()};
  double head_radius{};
};
SimplifiedBody simplified_body(const Person&);

/// Fits a complete body to whatever joints were seen; what was not seen comes from proportions of the stature. `previous` (may be null)
/// keeps the size and the unseen joints. Returns joints in kBodyJoints order.
std::vector<BodyJoint> fit_body(const ObservedPerson&, const Person* previous, double stature);

/// A standing body of the given stature at `feet` facing yaw (rotation about z, 0 = +x), arms hanging. For tests, sim and fitting.
std::vector<BodyJoint> standing_body(const Vector3& feet, double yaw, double stature);

/// Where the person's hand would take an object comfortably: world point in front of the right (or left) shoulder.
Vector3 comfortable_reach(const Person&, Side side);

}  // namespace handsel
