// SPDX-License-Identifier: Apache-2.0
#include "sim/oracle/taking_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "common/model/human/human_body.hpp"
#include "common/model/human/human_wrist.hpp"
#include "common/model/object_surface.hpp"

namespace handsel::sim {
namespace {

constexpr int kDirectionsPerCone = 12;      // finger directions on each cone
constexpr double kCones[] = {0, 0.4, 0.8};  // half angles of these cones [rad]
constexpr int kRolls = 24;                  // rotations of the hand about its finger direction
constexpr double kMinPalmClearance = 0.06;  // min distance of the hand from the robot's palm [m]
constexpr double kDifferenceStep = 1e-4;    // step of the finite differences for the normal [m]
constexpr double kMinElongation = 1.25;     // min ratio of the two largest extents if elongated
constexpr double kMaxThumbAngle = 0.8;      // max angle of the thumb side and the long axis [rad]

/// Returns the outward normal of the surface of the object near a point; world.
Vector3 surface_normal(const Taker& taker, const Vector3& p_world) {
  const Pose T_object_world = taker.T_world_object.inverse();
  const auto distance = [&](const Vector3& offset) {
    return surface_distance(*taker.object, T_object_world * (p_world + offset));
  };
  Vector3 slope;
  for (int i = 0; i < 3; ++i)
    slope[i] = distance(kDifferenceStep * Vector3::Unit(i)) -
               distance(-kDifferenceStep * Vector3::Unit(i));
  return slope.stableNormalized();
}

double distance_to_segment(const Vector3& a, const Vector3& b, const Vector3& p) {
  const Vector3 along = b - a;
  const double s = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (a + s * along - p).norm();
}

double fraction(double angle, double positive, double negative) {
  return std::min(1.0, angle >= 0 ? angle / positive : -angle / negative);
}

TakingStrain strain_of(const WristPosture& posture) {
  const WristRanges& r = kWristRanges;
  return {
      std::max({fraction(posture.flexion, r.flexion, r.extension),
                fraction(posture.radial, r.radial, r.ulnar),
                fraction(posture.pronation, r.pronation, r.supination)}),
      std::min(1.0, std::max(posture.elevation / r.elevation, posture.adduction / r.adduction))};
}

/// Returns the direction of the longest extent of the object, world; nullopt: it is not elongated.
std::optional<Vector3> long_axis(const Taker& taker) {
  Eigen::AlignedBox3d box;
  for (const Vector3& vertex : taker.object->mesh.vertices) box.extend(vertex);
  Vector3 size = box.sizes();
  Eigen::Index longest_axis = 0;
  const double length = size.maxCoeff(&longest_axis);
  size[longest_axis] = 0;
  if (length < kMinElongation * size.maxCoeff()) return std::nullopt;
  return Vector3(taker.T_world_object.linear().col(longest_axis));
}

/// Returns directions on cones about an axis.
std::vector<Vector3> directions_about(const Vector3& axis) {
  const Vector3 first = axis.unitOrthogonal(), second = axis.cross(first);
  std::vector<Vector3> out;
  for (const double angle : kCones) {
    for (int k = 0; k < (angle > 0 ? kDirectionsPerCone : 1); ++k) {
      const double turn = 2 * std::numbers::pi * k / kDirectionsPerCone;
      out.push_back(std::cos(angle) * axis +
                    std::sin(angle) * (std::cos(turn) * first + std::sin(turn) * second));
    }
  }
  return out;
}

}  // namespace

TakingStrain taking_strain(const Taker& taker) {
  const auto joint = [&](const char* left, const char* right) {
    const char* name = taker.side == Side::left ? left : right;
    return taker.body->joints[static_cast<std::size_t>(body_joint_index(name))].position;
  };
  TakingStrain strain;
  const auto arm = human_arm(*taker.body, taker.side);
  if (!arm) return strain;
  const Vector3 hand = joint("l_hand", "r_hand");
  const double length = (hand - joint("l_wrist", "r_wrist")).norm();
  const std::optional<Vector3> axis = long_axis(taker);
  double min_strain = std::numeric_limits<double>::infinity();
  for (const Vector3& fingers : directions_about(-surface_normal(taker, hand))) {
    const Vector3 wrist = hand - length * fingers;
    if (distance_to_segment(wrist, hand + length * fingers, taker.p_robot_palm) < kMinPalmClearance)
      continue;
    const Vector3 first = fingers.unitOrthogonal(), second = fingers.cross(first);
    for (int k = 0; k < kRolls; ++k) {
      const double roll = 2 * std::numbers::pi * k / kRolls;
      const Vector3 palm = std::cos(roll) * first + std::sin(roll) * second,
                    thumb_side = fingers.cross(palm);
      if (axis && std::abs(thumb_side.dot(*axis)) < std::cos(kMaxThumbAngle)) continue;
      Pose T_world_wrist = Pose::Identity();
      T_world_wrist.linear() << palm, thumb_side, fingers;
      T_world_wrist.translation() = wrist;
      const auto posture = wrist_posture(*arm, T_world_wrist);
      if (!posture || posture->strain >= min_strain) continue;
      min_strain = posture->strain;
      strain = strain_of(*posture);
    }
  }
  return strain;
}

void TakingOracle::observe(bool robot_grips, const std::optional<Taker>& taker) {
  if (gripped_ && !robot_grips && taker) {
    taken_ = true;
    side_ = taker->side;
    strain_ = taking_strain(*taker);
  }
  gripped_ = robot_grips;
}

void TakingOracle::write(GroundTruth& ground_truth) const {
  ground_truth.taken = taken_;
  if (!taken_) return;
  ground_truth.taking_side = side_;
  ground_truth.taking_wrist_strain = strain_.wrist;
  ground_truth.taking_arm_strain = strain_.arm;
}

}  // namespace handsel::sim
