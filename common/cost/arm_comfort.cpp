// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "common/cost/human_cost.hpp"
#include "common/cost/person_frame.hpp"

namespace handsel {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr int kAngles = 4;  // flexion, abduction, humeral rotation (inward), elbow flexion
constexpr std::array<double, kAngles> kLower = {-60 * kDegree, -40 * kDegree, -60 * kDegree, 0};
constexpr std::array<double, kAngles> kUpper = {170 * kDegree, 130 * kDegree, 90 * kDegree,
                                                150 * kDegree};
constexpr std::array<double, kAngles> kRest = {0, 5 * kDegree, 0, 30 * kDegree};
constexpr std::array<double, 7> kSwivels = {
    -20 * kDegree, 0, 15 * kDegree, 30 * kDegree, 50 * kDegree, 70 * kDegree, 90 * kDegree};
constexpr double kDisplacementWeight = 0.4, kEffortWeight = 0.4, kLimitWeight = 0.2;
constexpr double kUpperArmMass = 2.1, kForearmMass = 1.7;  // for a body mass of 75 kg [kg]

double near_limit(double ratio) {
  const double base = 0.5 * (std::sin(5.0 * ratio + 1.571) + 1.0);
  return base < 0.85 ? 0.0 : std::pow(base, 100);
}

/// Returns the cost of an arm posture with upper arm direction u and forearm direction f (forward,
/// outward, up); 1 outside the joint limits.
double posture_cost(const ArmSize& arm, const Vector3& u, const Vector3& f) {
  const double flexion = std::atan2(u.x(), -u.z()),
               abduction = std::asin(std::clamp(u.y(), -1.0, 1.0));
  const Vector3 forward(std::cos(flexion), 0, std::sin(flexion));
  const Vector3 outward(-std::sin(flexion) * std::sin(abduction), std::cos(abduction),
                        std::cos(flexion) * std::sin(abduction));
  const double elbow = std::acos(std::clamp(u.dot(f), -1.0, 1.0));
  const double rotation = elbow > 5 * kDegree ? std::atan2(-f.dot(outward), f.dot(forward)) : 0.0;
  const std::array<double, kAngles> q = {flexion, abduction, rotation, elbow};
  double displacement = 0, limits = 0;
  for (int i = 0; i < kAngles; ++i) {
    if (q[i] < kLower[i] || q[i] > kUpper[i]) return 1.0;
    const double range = kUpper[i] - kLower[i];
    displacement += std::abs(q[i] - kRest[i]) / range / kAngles;
    limits += near_limit((kUpper[i] - q[i]) / range);
    if (i < 3) limits += near_limit((q[i] - kLower[i]) / range);  // a straight elbow is comfortable
  }
  const auto raised = [](double mass, double height) { return mass * mass * height * height; };
  const double effort =
      raised(kUpperArmMass, 0.5 * arm.upper * (1 + u.z())) +
      raised(kForearmMass, arm.upper * (1 + u.z()) + 0.5 * arm.fore * (1 + f.z()));
  const double max_effort =
      raised(kUpperArmMass, arm.upper) + raised(kForearmMass, 2 * arm.upper + arm.fore);
  return std::min(1.0, kDisplacementWeight * displacement + kEffortWeight * effort / max_effort +
                           kLimitWeight * std::min(1.0, limits));
}

}  // namespace

std::optional<ArmSize> arm_size(const Person& person, Side side) {
  const bool left = side == Side::left;
  const BodyJoint* shoulder = find_joint(person, left ? "l_shoulder" : "r_shoulder");
  const BodyJoint* elbow = find_joint(person, left ? "l_elbow" : "r_elbow");
  const BodyJoint* wrist = find_joint(person, left ? "l_wrist" : "r_wrist");
  const BodyJoint* hand = find_joint(person, left ? "l_hand" : "r_hand");
  if (!shoulder || !elbow || !wrist) return std::nullopt;
  const ArmSize arm{(elbow->position - shoulder->position).norm(),
                    (wrist->position - elbow->position).norm() +
                        (hand ? (hand->position - wrist->position).norm() : 0.0)};
  if (arm.upper < 1e-3 || arm.fore < 1e-3) return std::nullopt;
  return arm;
}

double arm_comfort_cost(const ArmSize& arm, const Vector3& target) {
  const double d = target.norm();
  if (d >= arm.upper + arm.fore || d <= std::abs(arm.upper - arm.fore) + 1e-3) return 1.0;
  const Vector3 to_target = target / d;
  Vector3 down = -Vector3::UnitZ() + to_target * to_target.z();
  if (down.norm() < 1e-3) down = -Vector3::UnitX() + to_target * to_target.x();
  down.normalize();
  Vector3 outward = to_target.cross(down);
  if (outward.y() < 0) outward = -outward;
  const double along = (arm.upper * arm.upper - arm.fore * arm.fore + d * d) / (2 * d);
  const double off = std::sqrt(std::max(0.0, arm.upper * arm.upper - along * along));
  double best = 1.0;
  for (double swivel : kSwivels) {
    const Vector3 elbow =
        along * to_target + off * (std::cos(swivel) * down + std::sin(swivel) * outward);
    best = std::min(best, posture_cost(arm, elbow / arm.upper, (target - elbow) / arm.fore));
  }
  return best;
}

std::optional<PlacedArm> placed_arm(const Person& person, Side side) {
  const std::optional<ArmSize> size = arm_size(person, side);
  if (!size) return std::nullopt;
  PlacedArm arm{*size,
                find_joint(person, side == Side::left ? "l_shoulder" : "r_shoulder")->position,
                torso_axes(person).transpose()};
  if (side == Side::right) arm.to_arm.row(1) *= -1;
  return arm;
}

std::vector<PlacedArm> placed_arms(const Person& person) {
  std::vector<PlacedArm> arms;
  for (const Side side : {Side::left, Side::right})
    if (const std::optional<PlacedArm> arm = placed_arm(person, side)) arms.push_back(*arm);
  return arms;
}

double arm_comfort_cost(const CostGrid* layer, const std::vector<PlacedArm>& arms,
                        const Vector3& p) {
  if (layer != nullptr) {
    const GridValue value = layer->value(p);
    return value.inside && !value.forbidden ? value.cost : 1.0;
  }
  double best = 1.0;
  for (const PlacedArm& arm : arms)
    best = std::min(best, arm_comfort_cost(arm.size, arm.to_arm * (p - arm.shoulder)));
  return best;
}

double arm_comfort_cost(const Person& person, Side side, const Vector3& p) {
  const std::optional<PlacedArm> arm = placed_arm(person, side);
  return arm ? arm_comfort_cost(arm->size, arm->to_arm * (p - arm->shoulder)) : 1.0;
}

double arm_comfort_cost(const Person& person, const Vector3& p) {
  return std::min(arm_comfort_cost(person, Side::left, p),
                  arm_comfort_cost(person, Side::right, p));
}

bool within_reach(const Person& person, const Vector3& p) {
  return arm_comfort_cost(person, p) < 1.0;
}

double arm_length(const Person& person) {
  const std::optional<ArmSize> left = arm_size(person, Side::left),
                               right = arm_size(person, Side::right);
  return std::max(left ? left->upper + left->fore : 0.0, right ? right->upper + right->fore : 0.0);
}

}  // namespace handsel
