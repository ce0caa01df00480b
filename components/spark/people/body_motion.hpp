// How the joints of one body move: the trunk, from all of its joints at once, and every joint from
// there. Pure.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/base/time.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "components/spark/people/joint_motion.hpp"

namespace handsel::spark {

bool of_trunk(std::size_t joint);  ///< index into kBodyJoints

/// The mean of the trunk's joints is less noisy than any of them: a person who starts to walk shows
/// in it two samples sooner than in each joint alone, and all joints start with it. Own method, for
/// that earlier sight.
class BodyMotion {
 public:
  /// Takes in where the joints (kBodyJoints) were seen at `at`, never before the last such time,
  /// and writes their velocities to `body`. `noise`: standard deviation of each coordinate [m], 0
  /// for a joint of which there is no news.
  void update(std::vector<BodyJoint>& body, const std::array<double, kBodyJoints.size()>& noise,
              TimePoint at);

 private:
  struct Point {
    explicit Point(const JointMotion::Agility& agility) : motion(agility) {}
    void add(const Vector3& position, double noise, TimePoint at);
    JointMotion motion;
    std::optional<TimePoint> sampled;
  };
  // A body starts to walk, and a hand to reach, at some m/s^2; a trunk bends slowly, and what was
  // seen wrongly jumps.
  static constexpr JointMotion::Agility kTrunk{2, 10}, kFromTrunk{1, 20};

  Point trunk_{kTrunk};
  std::vector<Point> joints_{kBodyJoints.size(), Point(kFromTrunk)};  // from the trunk
};

}  // namespace handsel::spark
