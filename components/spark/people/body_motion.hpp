// SPDX-License-Identifier: Apache-2.0
// Estimates the velocities of the joints of one body: the trunk from all of its joints, and every
// joint relative to the trunk. Pure.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "components/spark/people/joint_motion.hpp"

namespace handsel::spark {

/// Returns whether a joint belongs to the trunk; `joint`: index into kBodyJoints.
bool of_trunk(std::size_t joint);

/// Filters the trunk by the mean of its joints, which has less noise than each joint. Own method:
/// this detects the start of a walk two samples earlier than separate joints do.
class BodyMotion {
 public:
  /// Takes the positions of the joints (kBodyJoints) at time `at`, not before the last call, and
  /// writes their velocities to `body`. `noise`: standard deviation of each coordinate [m]; 0: no
  /// new observation of the joint.
  void update(std::vector<BodyJoint>& body, const std::array<double, kBodyJoints.size()>& noise,
              TimePoint at, const settings::SparkSettings& settings);

 private:
  struct Point {
    /// Restarts where the last sample is more than `max_gap` ago [s].
    void add(const Vector3& position, double noise, TimePoint at, const JointMotion::Model& model,
             double max_gap);
    JointMotion motion;
    std::optional<TimePoint> sampled;
  };

  Point trunk_;
  std::vector<Point> joints_{kBodyJoints.size()};  // relative to the trunk
};

}  // namespace handsel::spark
