// When the robot's hand holds an object: fingers press on it from at least three sides, for a time (ours).
#pragma once

#include <vector>

#include "sim/contacts.hpp"
#include "sim/robot_body.hpp"

namespace handsel::sim {

class RobotGrasp {
 public:
  RobotGrasp(const RobotModel&, const RobotBody&, double touch_force, double grasp_time, double lose_time);

  /// Which chain of the hand a body belongs to: 0 the palm, 1 … the fingers, -1 not the hand.
  int chain_of(int body) const { return body < 0 ? -1 : chain_[body]; }
  int palm() const { return palm_; }

  /// Sides of the object pressed in these contacts: distinct fingers (and palm) bearing force, 0 unless two of them oppose each other.
  int sides(const std::vector<Touch>&, int object) const;
  /// Call once a step with the object of interest; true while a grasp may exist.
  bool update(const std::vector<Touch>&, int object, double dt);
  void reset() { pressed_ = lost_ = 0, held_ = false; }
  static constexpr int kSides = 3;

 private:
  double touch_force_, grasp_time_, lose_time_, pressed_{0}, lost_{0};
  bool held_{false};
  int palm_{-1};
  std::vector<int> chain_;
};

}  // namespace handsel::sim
