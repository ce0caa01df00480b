// SPDX-License-Identifier: Apache-2.0
#include "components/spark/people/body_motion.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::spark {
namespace {

std::array<std::size_t, 7> trunk_joints() {
  std::array<std::size_t, 7> out{};
  std::size_t n = 0;
  for (const char* name : {"neck", "torso", "waist", "l_shoulder", "r_shoulder", "l_hip", "r_hip"})
    out[n++] = static_cast<std::size_t>(body_joint_index(name));
  return out;
}

const std::array<std::size_t, 7> kTrunkJoints = trunk_joints();

}  // namespace

bool of_trunk(std::size_t joint) {
  return std::find(kTrunkJoints.begin(), kTrunkJoints.end(), joint) != kTrunkJoints.end();
}

void BodyMotion::Point::add(const Vector3& position, double noise, TimePoint at,
                            const JointMotion::Model& model, double max_gap) {
  const double since = sampled ? to_seconds(at - *sampled) : 2 * max_gap;
  if (since > max_gap)
    motion.reset(model, position, noise);
  else if (since > 1e-4)
    motion.update(position, since, noise);
  sampled = at;
}

void BodyMotion::update(std::vector<BodyJoint>& body,
                        const std::array<double, kBodyJoints.size()>& noise, TimePoint at,
                        const settings::SparkSettings& settings) {
  const JointMotion::Model trunk{settings.trunk_acceleration, settings.trunk_sudden_acceleration,
                                 settings.usual_deviations, settings.initial_speed},
      from_trunk{settings.joint_acceleration, settings.joint_sudden_acceleration,
                 settings.usual_deviations, settings.initial_speed};
  constexpr double kCount = static_cast<double>(kTrunkJoints.size());
  Vector3 middle = Vector3::Zero();
  double max_noise = 0, variance = 0;
  for (const std::size_t i : kTrunkJoints) {
    middle += body[i].position / kCount;
    max_noise = std::max(max_noise, noise[i]);
  }
  for (const std::size_t i : kTrunkJoints)
    variance += std::pow(noise[i] > 0 ? noise[i] : max_noise, 2);
  const double middle_noise = std::sqrt(variance) / kCount;
  if (max_noise > 0) trunk_.add(middle, middle_noise, at, trunk, settings.motion_gap);
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (noise[i] > 0)
      joints_[i].add(body[i].position - middle, std::hypot(noise[i], middle_noise), at, from_trunk,
                     settings.motion_gap);
    body[i].velocity = trunk_.motion.velocity() + joints_[i].motion.velocity();
  }
}

}  // namespace handsel::spark
