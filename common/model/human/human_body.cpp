// SPDX-License-Identifier: Apache-2.0
#include "common/model/human/human_body.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/human/body_index.hpp"

namespace handsel {
namespace {

using namespace body;

// Lengths as ratios to the stature (Drillis and Contini); depths and breadths are own values.
constexpr double kHead = 0.93, kNeck = 0.85, kShoulder = 0.818, kTorso = 0.72, kHip = 0.53,
                 kKnee = 0.285, kAnkle = 0.039;
constexpr double kShoulderHalf = 0.115, kHipHalf = 0.055, kUpperArm = 0.186, kForearm = 0.146,
                 kHandCentre = 0.054;
constexpr double kHeadRadius = 0.07, kNeckRadius = 0.04, kTrunkRadius = 0.08, kSideRadius = 0.07,
                 kShoulderRadius = 0.055;
constexpr double kUpperArmRadius = 0.034, kForearmRadius = 0.028, kHandRadius = 0.030,
                 kThighRadius = 0.055, kShankRadius = 0.04;

bool complete(const Person& person) {
  if (person.joints.size() < kBodyJoints.size()) return false;
  for (std::size_t i = 0; i < kBodyJoints.size(); ++i)
    if (person.joints[i].name != kBodyJoints[i]) return false;
  return true;
}

/// Returns false if the body is too incomplete.
bool points_of(const Person& person, Points& out) {
  if (complete(person)) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = person.joints[i].position;
    return true;
  }
  ObservedPerson seen;
  for (const auto& joint : person.joints) seen.joints.push_back({joint.name, joint.position, 1.0});
  const auto fitted = fit_body(seen, nullptr, person.stature);
  for (std::size_t i = 0; i < fitted.size(); ++i) out[i] = fitted[i].position;
  return !fitted.empty();
}

Vector3 direction(const Vector3& from, const Vector3& to) {
  const Vector3 d = to - from;
  const double length = d.norm();
  return length > 1e-9 ? Vector3(d / length) : Vector3(-Vector3::UnitZ());
}

}  // namespace

int body_joint_index(const std::string& name) {
  for (std::size_t i = 0; i < kBodyJoints.size(); ++i)
    if (name == kBodyJoints[i]) return static_cast<int>(i);
  return -1;
}

void body_capsules(const Person& person, std::array<BodyCapsule, kBodyCapsules>& out) {
  Points p;
  if (!points_of(person, p)) {
    out.fill({BodyPart::torso, Vector3::Constant(1e6), Vector3::Constant(1e6), 0.0});
    return;
  }
  const double h = person.stature;
  std::size_t n = 0;
  const auto add = [&](BodyPart part, const Vector3& a, const Vector3& b, double ratio) {
    out[n++] = {part, a, b, ratio * h + person.inflation};
  };
  const auto hand = [&](BodyPart part, const Vector3& elbow, const Vector3& wrist,
                        const Vector3& centre) {
    const Vector3 along =
        (centre - wrist).norm() > 0.01 ? direction(wrist, centre) : direction(elbow, wrist);
    add(part, wrist, centre + 0.5 * kHandCentre * h * along, kHandRadius);
  };
  const Vector3 up = direction(p[neck], p[head]);
  add(BodyPart::head, p[head] - 0.01 * h * up, p[head] + 0.015 * h * up, kHeadRadius);
  add(BodyPart::head, p[neck], p[head], kNeckRadius);
  add(BodyPart::torso, p[l_shoulder], p[r_shoulder], kShoulderRadius);
  add(BodyPart::torso, p[torso] + 0.4 * (p[neck] - p[torso]), p[waist], kTrunkRadius);
  add(BodyPart::torso, p[l_shoulder] + 0.35 * (p[r_shoulder] - p[l_shoulder]), p[l_hip],
      kSideRadius);
  add(BodyPart::torso, p[r_shoulder] + 0.35 * (p[l_shoulder] - p[r_shoulder]), p[r_hip],
      kSideRadius);
  add(BodyPart::upper_arm_left, p[l_shoulder], p[l_elbow], kUpperArmRadius);
  add(BodyPart::forearm_left, p[l_elbow], p[l_wrist], kForearmRadius);
  hand(BodyPart::hand_left, p[l_elbow], p[l_wrist], p[l_hand]);
  add(BodyPart::upper_arm_right, p[r_shoulder], p[r_elbow], kUpperArmRadius);
  add(BodyPart::forearm_right, p[r_elbow], p[r_wrist], kForearmRadius);
  hand(BodyPart::hand_right, p[r_elbow], p[r_wrist], p[r_hand]);
  add(BodyPart::leg_left, p[l_hip], p[l_knee], kThighRadius);
  add(BodyPart::leg_left, p[l_knee], p[l_ankle], kShankRadius);
  add(BodyPart::leg_right, p[r_hip], p[r_knee], kThighRadius);
  add(BodyPart::leg_right, p[r_knee], p[r_ankle], kShankRadius);
}

std::vector<BodyCapsule> body_capsules(const Person& person) {
  if (person.joints.empty()) return {};
  std::array<BodyCapsule, kBodyCapsules> capsules;
  body_capsules(person, capsules);
  return {capsules.begin(), capsules.end()};
}

SimplifiedBody simplified_body(const Person& person) {
  SimplifiedBody body;
  Points p;
  if (!points_of(person, p)) return body;
  const double h = person.stature;
  const Vector3 middle = (p[neck] + p[torso] + p[waist]) / 3;
  const double floor = std::min(p[l_ankle].z(), p[r_ankle].z()) - kAnkle * h;
  body.axis_bottom = {middle.x(), middle.y(), floor};
  body.height = std::max(p[neck].z() - floor, 0.1 * h);
  body.radius = 0.13 * h + person.inflation;
  body.head = p[head];
  body.head_radius = (kHeadRadius + 0.01) * h + person.inflation;
  return body;
}

std::vector<BodyJoint> standing_body(const Vector3& feet, double yaw, double stature) {
  const Eigen::AngleAxisd turn(yaw, Vector3::UnitZ());
  std::vector<BodyJoint> joints(kBodyJoints.size());
  const auto put = [&](Index i, double x, double y, double z) {
    joints[i].name = kBodyJoints[i];
    joints[i].position = feet + turn * (stature * Vector3(x, y, z));
  };
  put(head, 0.01, 0, kHead);
  put(neck, 0, 0, kNeck);
  put(torso, 0, 0, kTorso);
  put(waist, 0, 0, kHip + 0.03);
  for (const double side : {1.0, -1.0}) {
    const int arm = side > 0 ? 0 : r_shoulder - l_shoulder, leg = side > 0 ? 0 : r_hip - l_hip;
    put(Index(l_shoulder + arm), 0, side * kShoulderHalf, kShoulder);
    put(Index(l_elbow + arm), 0, side * (kShoulderHalf + 0.015), kShoulder - kUpperArm);
    put(Index(l_wrist + arm), 0.02, side * (kShoulderHalf + 0.02),
        kShoulder - kUpperArm - kForearm);
    put(Index(l_hand + arm), 0.025, side * (kShoulderHalf + 0.02),
        kShoulder - kUpperArm - kForearm - kHandCentre);
    put(Index(l_hip + leg), 0, side * kHipHalf, kHip);
    put(Index(l_knee + leg), 0, side * kHipHalf, kKnee);
    put(Index(l_ankle + leg), 0, side * kHipHalf, kAnkle);
  }
  return joints;
}

std::vector<BodyJoint> sitting_body(const Vector3& floor_point, double yaw, double stature) {
  constexpr double kSeat = 0.26;
  std::vector<BodyJoint> joints = standing_body(floor_point, yaw, stature);
  const Vector3 forward = Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Vector3::UnitX();
  for (BodyJoint& joint : joints) joint.position.z() -= (kHip - kSeat) * stature;
  for (const std::size_t leg : {std::size_t{0}, static_cast<std::size_t>(r_hip) - l_hip}) {
    Vector3& knee = joints[static_cast<std::size_t>(l_knee) + leg].position;
    Vector3& ankle = joints[static_cast<std::size_t>(l_ankle) + leg].position;
    const Vector3& hip = joints[static_cast<std::size_t>(l_hip) + leg].position;
    knee = hip + (kHip - kKnee) * stature * forward;
    ankle = Vector3(knee.x(), knee.y(), floor_point.z() + kAnkle * stature);
  }
  return joints;
}

Vector3 comfortable_reach(const Person& person, Side side) {
  Points p;
  if (!points_of(person, p)) return Vector3::Zero();
  const double h = person.stature;
  Vector3 left = p[l_shoulder] - p[r_shoulder];
  left.z() = 0;
  const Vector3 forward = direction(Vector3::Zero(), left).cross(Vector3::UnitZ());
  const Vector3& shoulder = side == Side::right ? p[r_shoulder] : p[l_shoulder];
  // Upper arm hanging slightly forward, elbow bent by about 70 degrees, slightly inward.
  const Vector3 inward =
      (side == Side::right ? 1.0 : -1.0) * 0.02 * h * direction(Vector3::Zero(), left);
  return shoulder + 0.27 * h * forward - 0.16 * h * Vector3::UnitZ() + inward;
}

}  // namespace handsel
