#include "components/spark/people/body_size.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/model/human/human_body.hpp"

namespace handsel::spark {
namespace {

constexpr double kSureJoint = 0.3;                      // confidence of a joint that measures
constexpr int kAverageOver = 60;                        // looks
constexpr double kCorrection = 0.02;                    // [m]
constexpr double kMinStature = 0.6, kMaxStature = 2.2;  // [m]

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
  double share;  // of the stature
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

void BodySize::see(const ObservedPerson& body) {
  std::array<const ObservedJoint*, kBodyJoints.size()> seen{};
  for (const ObservedJoint& joint : body.joints)
    if (const int i = body_joint_index(joint.name);
        i >= 0 && joint.confidence >= kSureJoint && joint.position.allFinite())
      seen[static_cast<std::size_t>(i)] = &joint;
  std::vector<double> said;
  for (const Bone& bone : bones()) {
    const ObservedJoint *a = seen[static_cast<std::size_t>(bone.from)],
                        *b = seen[static_cast<std::size_t>(bone.to)];
    if (a != nullptr && b != nullptr)
      said.push_back((a->position - b->position).norm() / bone.share);
  }
  if (said.empty()) return;
  const auto middle = said.begin() + static_cast<std::ptrdiff_t>(said.size() / 2);
  std::nth_element(said.begin(), middle, said.end());
  if (!(*middle >= kMinStature && *middle <= kMaxStature)) return;
  samples_ = std::min(samples_ + 1, kAverageOver);
  mean_ += (*middle - mean_) / samples_;
  if (std::abs(mean_ - stature_) > kCorrection) stature_ = mean_;
}

}  // namespace handsel::spark
