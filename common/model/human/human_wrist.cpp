// SPDX-License-Identifier: Apache-2.0
#include "common/model/human/human_wrist.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/model/human/human_body.hpp"

namespace handsel {
namespace {

constexpr double kStretched = 0.95;  // max comfortable reach, ratio to the arm's length
constexpr double kMinReach = 0.2;    // min reach [m]
constexpr int kElbows = 7;

double ratio(double angle, double positive, double negative) {
  return angle >= 0 ? angle / positive : -angle / negative;
}

}  // namespace

std::optional<HumanArm> human_arm(const Person& person, Side side) {
  const bool right = side == Side::right;
  const auto joint = [&](const char* name) {
    return static_cast<std::size_t>(body_joint_index(name));
  };
  const std::size_t shoulder = joint(right ? "r_shoulder" : "l_shoulder"),
                    other = joint(right ? "l_shoulder" : "r_shoulder"),
                    elbow = joint(right ? "r_elbow" : "l_elbow"),
                    wrist = joint(right ? "r_wrist" : "l_wrist");
  if (person.joints.size() < kBodyJoints.size()) return std::nullopt;
  HumanArm arm;
  arm.side = side;
  arm.shoulder = person.joints[shoulder].position;
  arm.outward = arm.shoulder - person.joints[other].position;
  arm.outward.z() = 0;
  if (arm.outward.norm() < 1e-3) return std::nullopt;
  arm.outward.normalize();
  arm.upper = (person.joints[elbow].position - arm.shoulder).norm();
  arm.forearm = (person.joints[wrist].position - person.joints[elbow].position).norm();
  if (!(arm.upper > 0.05 && arm.forearm > 0.05)) return std::nullopt;
  return arm;
}

std::optional<WristPosture> wrist_posture(const HumanArm& arm, const Pose& T_world_wrist) {
  const Vector3 line = T_world_wrist.translation() - arm.shoulder;
  const double d = line.norm();
  if (d > kStretched * (arm.upper + arm.forearm) ||
      d < std::max(kMinReach, std::abs(arm.upper - arm.forearm) + 0.01))
    return std::nullopt;
  const Vector3 along = line / d;
  // The elbow lies on a circle about the line.
  const double x = (d * d + arm.upper * arm.upper - arm.forearm * arm.forearm) / (2 * d);
  const double radius = std::sqrt(std::max(0.0, arm.upper * arm.upper - x * x));
  Vector3 below = -Vector3::UnitZ() + along * along.z();
  if (below.norm() < 1e-6) below = -arm.outward + along * along.dot(arm.outward);
  below.normalize();
  Vector3 aside = along.cross(below);
  if (aside.dot(arm.outward) < 0) aside = -aside;

  const Vector3 hand = T_world_wrist.linear().col(2), palm = T_world_wrist.linear().col(0);
  const double mirror = arm.side == Side::right ? 1.0 : -1.0;
  const Vector3 thumb = mirror * T_world_wrist.linear().col(1);
  std::optional<WristPosture> best;
  for (int k = 0; k < kElbows; ++k) {
    const double swivel = 0.5 * std::numbers::pi * k / (kElbows - 1);
    WristPosture p;
    p.elbow =
        arm.shoulder + x * along + radius * (std::cos(swivel) * below + std::sin(swivel) * aside);
    const Vector3 forearm = (T_world_wrist.translation() - p.elbow) / arm.forearm;
    p.flexion = std::atan2(-forearm.dot(palm), forearm.dot(hand));
    p.radial = std::asin(std::clamp(-forearm.dot(thumb), -1.0, 1.0));
    p.elevation = std::acos(std::clamp((arm.shoulder.z() - p.elbow.z()) / arm.upper, -1.0, 1.0));
    p.adduction =
        -std::asin(std::clamp((p.elbow - arm.shoulder).dot(arm.outward) / arm.upper, -1.0, 1.0));
    Vector3 neutral = arm.shoulder - p.elbow;
    neutral -= forearm * forearm.dot(neutral);
    const Vector3 across = thumb - forearm * forearm.dot(thumb);
    p.pronation = -mirror * std::atan2(forearm.dot(neutral.cross(across)), neutral.dot(across));
    const WristRanges& r = kWristRanges;
    p.strain =
        std::max({ratio(p.flexion, r.flexion, r.extension), ratio(p.radial, r.radial, r.ulnar),
                  ratio(p.pronation, r.pronation, r.supination), p.elevation / r.elevation,
                  p.adduction / r.adduction});
    if (!best || p.strain < best->strain) best = p;
  }
  return best;
}

}  // namespace handsel
