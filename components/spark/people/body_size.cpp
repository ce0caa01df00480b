// SPDX-License-Identifier: Apache-2.0
#include "components/spark/people/body_size.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/model/human/human_body.hpp"

namespace handsel::spark {
namespace {

constexpr std::array<std::pair<const char*, const char*>, 13> kBones = {
    {{"l_shoulder", "l_elbow"},
     {"r_shoulder", "r_elbow"},
     {"l_elbow", "l_wrist"},
     {"r_elbow", "r_wrist"},
     {"l_hip", "l_knee"},
     {"r_hip", "r_knee"},
     {"l_knee", "l_ankle"},
     {"r_knee", "r_ankle"},
     {"neck", "torso"},
     {"torso", "waist"},
     {"l_shoulder", "r_shoulder"},
     {"neck", "l_shoulder"},
     {"neck", "r_shoulder"}}};

struct Bone {
  int from, to;
  double fraction;  // length divided by the stature
};

const std::array<Bone, kBones.size()>& bones() {
  static const auto all = [] {
    std::array<Bone, kBones.size()> out{};
    const auto body = standing_body(Vector3::Zero(), 0, 1);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const int a = body_joint_index(kBones[i].first), b = body_joint_index(kBones[i].second);
      out[i] = {
          a, b,
          (body[static_cast<std::size_t>(a)].position - body[static_cast<std::size_t>(b)].position)
              .norm()};
    }
    return out;
  }();
  return all;
}

}  // namespace

void BodySize::add_sample(const ObservedPerson& body, const settings::SparkSettings& settings) {
  std::array<const ObservedJoint*, kBodyJoints.size()> seen{};
  for (const ObservedJoint& joint : body.joints)
    if (const int i = body_joint_index(joint.name);
        i >= 0 && joint.confidence >= settings.stature_min_confidence && joint.position.allFinite())
      seen[static_cast<std::size_t>(i)] = &joint;
  std::vector<double> statures;
  for (const Bone& bone : bones()) {
    const ObservedJoint *a = seen[static_cast<std::size_t>(bone.from)],
                        *b = seen[static_cast<std::size_t>(bone.to)];
    if (a != nullptr && b != nullptr)
      statures.push_back((a->position - b->position).norm() / bone.fraction);
  }
  if (statures.empty()) return;
  const auto median = statures.begin() + static_cast<std::ptrdiff_t>(statures.size() / 2);
  std::nth_element(statures.begin(), median, statures.end());
  if (!(*median >= settings.min_stature && *median <= settings.max_stature)) return;
  samples_ = std::min(samples_ + 1, static_cast<int>(settings.stature_samples));
  mean_ += (*median - mean_) / samples_;
  if (std::abs(mean_ - stature(settings)) > settings.stature_step) stature_ = mean_;
}

}  // namespace handsel::spark
