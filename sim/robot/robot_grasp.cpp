// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/robot_grasp.hpp"

#include <algorithm>

namespace handsel::sim {

namespace {
constexpr int kConeEdges = 8;        // edges of a linearised friction cone
constexpr double kTorqueScale = 10;  // scale of torques [1/m]; force closure is independent of it
}  // namespace

RobotGrasp::RobotGrasp(int palm, const RobotBody& robot, double touch_force, double grasp_time,
                       double lose_time)
    : touch_force_(touch_force),
      grasp_time_(grasp_time),
      lose_time_(lose_time),
      chain_(robot.bodies(), -1) {
  if (palm < 0) return;
  palm_ = robot.body_of(palm);
  if (palm_ < 0) return;
  chain_[palm_] = 0;
  int fingers = 0;
  for (int i = 0; i < robot.bodies(); ++i) {
    const int parent = robot.parent_of(i);
    if (parent >= 0 && chain_[parent] >= 0)
      chain_[i] = parent == palm_ ? ++fingers : chain_[parent];
  }
}

double RobotGrasp::pressure(const std::vector<Touch>& touches, int object) const {
  double sum = 0;
  for (const Touch& t : touches) {
    if (of_hand(t, object)) sum += t.normal_force;
  }
  return sum;
}

Vector3 RobotGrasp::force(const std::vector<Touch>& touches, int object) const {
  Vector3 sum = Vector3::Zero();
  for (const Touch& t : touches) {
    if (of_hand(t, object)) sum -= t.force_on_a;
  }
  return sum;
}

bool RobotGrasp::closed(const std::vector<Touch>& touches, int object, const Vector3& centre) {
  contacts_.clear();
  for (const Touch& t : touches) {
    if (of_hand(t, object) && t.normal_force >= touch_force_)
      contacts_.push_back({t.point, -t.normal, t.friction, t.torsion});
  }
  return contacts_.size() >= 2 &&
         force_closure(contact_wrenches(contacts_, kConeEdges, centre, kTorqueScale));
}

bool RobotGrasp::update(const std::vector<Touch>& touches, int object, const Vector3& centre,
                        double dt) {
  const bool now = object >= 0 && closed(touches, object, centre);
  closed_for_ = now ? closed_for_ + dt : 0;
  open_for_ = now ? 0 : open_for_ + dt;
  if (closed_for_ >= grasp_time_) held_ = true;
  if (open_for_ >= lose_time_) held_ = false;
  return held_;
}

}  // namespace handsel::sim
