// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/model/human/body_index.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/human/two_bones.hpp"

namespace handsel {
namespace {

using namespace body;

constexpr double kMinConfidence = 0.05;
constexpr double kMinSpread =
    4e-3;  // points closer to one vertical line do not show the heading of a body [m^2]
constexpr int kCount = static_cast<int>(kBodyJoints.size());

/// The skeleton as a tree from the chest outward.
constexpr std::array<int, kCount> kParent = {
    neck,       torso,   -1,      torso, neck,  l_shoulder, l_elbow, l_wrist, neck,
    r_shoulder, r_elbow, r_wrist, waist, l_hip, l_knee,     waist,   r_hip,   r_knee};
/// Weight of a joint for position and heading of the trunk.
constexpr std::array<double, kCount> kTrunkWeight = {
    0.5, 1, 1, 1, 1, 0.05, 0.02, 0.02, 1, 0.05, 0.02, 0.02, 1, 0.2, 0.1, 1, 0.2, 0.1};

using Seen = std::array<double, kCount>;  // confidence, 0 = not observed

double flat_norm(const Vector3& v) { return std::hypot(v.x(), v.y()); }

/// Moves `body` onto the observed points by a rotation about z and a translation.
void place(Points& body, const Points& points, const Seen& seen, const ObservedPerson& observed) {
  double total = 0;
  Vector3 from = Vector3::Zero(), to = Vector3::Zero();
  for (int i = 0; i < kCount; ++i) {
    const double w = seen[i] * kTrunkWeight[i];
    total += w;
    from += w * body[i];
    to += w * points[i];
  }
  from /= total;
  to /= total;
  double sine = 0, cosine = 0, spread = 0;
  for (int i = 0; i < kCount; ++i) {
    const double w = seen[i] * kTrunkWeight[i] / total;
    const Vector3 a = body[i] - from, b = points[i] - to;
    sine += w * (a.x() * b.y() - a.y() * b.x());
    cosine += w * (a.x() * b.x() + a.y() * b.y());
    spread += w * flat_norm(a) * flat_norm(b);
  }
  double turn = 0;
  if (spread > kMinSpread) {
    turn = std::atan2(sine, cosine);
  } else if (observed.has_gaze && flat_norm(observed.gaze_direction) > 0.1) {
    const Vector3 left = body[l_shoulder] - body[r_shoulder];
    turn = std::atan2(observed.gaze_direction.y(), observed.gaze_direction.x()) -
           std::atan2(-left.x(), left.y());
  }
  const Eigen::AngleAxisd R(turn, Vector3::UnitZ());
  for (auto& p : body) p = to + R * (p - from);
}

}  // namespace

std::vector<BodyJoint> fit_body(const ObservedPerson& observed, const Person* previous,
                                double stature) {
  Points points, body;
  Seen seen{};
  points.fill(Vector3::Zero());
  bool any = false;
  for (const auto& joint : observed.joints) {
    const int i = body_joint_index(joint.name);
    if (i < 0 || !(joint.confidence >= kMinConfidence) || !joint.position.allFinite() ||
        joint.confidence <= seen[i])
      continue;
    seen[i] = std::min(joint.confidence, 1.0);
    points[i] = joint.position;
    any = true;
  }
  const bool known = previous != nullptr && previous->joints.size() == kBodyJoints.size();
  if (!any && !known) return {};

  std::vector<BodyJoint> joints =
      known ? previous->joints : standing_body(Vector3::Zero(), 0, stature);
  std::array<double, kCount> bone{};
  {
    const auto model = standing_body(Vector3::Zero(), 0, stature);
    for (int i = 0; i < kCount; ++i) {
      body[i] = joints[i].position;
      if (kParent[i] >= 0) bone[i] = (model[i].position - model[kParent[i]].position).norm();
    }
  }
  if (any) {
    place(body, points, seen, observed);
    Points fitted = body;
    std::array<bool, kCount> done{};
    for (int i = 0; i < kCount; ++i) {
      done[i] = seen[i] > 0;
      if (done[i]) fitted[i] = points[i];
    }
    // From the observed joints outward, each joint is placed one bone length away, in the direction
    // of the fitted body.
    for (auto before = done; !std::all_of(done.begin(), done.end(), [](bool d) { return d; });
         before = done)
      for (int i = 0; i < kCount; ++i) {
        if (before[i]) continue;
        int from = kParent[i] >= 0 && before[kParent[i]] ? kParent[i] : -1;
        for (int k = 0; from < 0 && k < kCount; ++k)
          if (kParent[k] == i && before[k]) from = k;
        if (from < 0) continue;
        const Vector3 direction = body[i] - fitted[from];
        const double length = from == kParent[i] ? bone[i] : bone[from];
        if (direction.norm() > 1e-6) fitted[i] = fitted[from] + length * direction.normalized();
        done[i] = true;
      }
    for (const int arm : {0, r_shoulder - l_shoulder}) {
      const int shoulder = l_shoulder + arm, elbow = l_elbow + arm, wrist = l_wrist + arm,
                hand = l_hand + arm;
      if (seen[wrist] <= 0 && seen[hand] > 0) {
        const Vector3 back = fitted[elbow] - fitted[hand];
        if (back.norm() > 1e-6) fitted[wrist] = fitted[hand] + bone[hand] * back.normalized();
      }
      if (seen[elbow] <= 0 && (seen[wrist] > 0 || seen[hand] > 0))
        fitted[elbow] =
            bend(fitted[shoulder], fitted[wrist], bone[elbow], bone[wrist], fitted[elbow]);
      if (seen[wrist] > 0 && seen[hand] <= 0) {
        const Vector3 on = fitted[wrist] - fitted[elbow];
        if (on.norm() > 1e-6) fitted[hand] = fitted[wrist] + bone[hand] * on.normalized();
      }
    }
    for (const int leg : {0, r_hip - l_hip})
      if (const int knee = l_knee + leg; seen[knee] <= 0 && seen[l_ankle + leg] > 0)
        fitted[knee] = bend(fitted[l_hip + leg], fitted[l_ankle + leg], bone[knee],
                            bone[l_ankle + leg], fitted[knee]);
    body = fitted;
  }
  for (int i = 0; i < kCount; ++i) joints[i] = {kBodyJoints[i], body[i], Vector3::Zero()};
  return joints;
}

}  // namespace handsel
