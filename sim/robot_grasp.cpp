#include "sim/robot_grasp.hpp"

#include <algorithm>

namespace handsel::sim {

namespace {
constexpr double kOpposed = -0.2;  // cosine between the normals of two fingers that oppose each other
}

RobotGrasp::RobotGrasp(const RobotModel& model, const RobotBody& robot, double touch_force, double grasp_time, double lose_time)
    : touch_force_(touch_force), grasp_time_(grasp_time), lose_time_(lose_time), chain_(robot.bodies(), -1) {
  if (model.tool_link() < 0) return;
  palm_ = robot.body_of(model.tool_link());
  if (palm_ < 0) return;
  chain_[palm_] = 0;
  int fingers = 0;
  for (int i = 0; i < robot.bodies(); ++i) {
    const int parent = robot.parent_of(i);
    if (parent >= 0 && chain_[parent] >= 0) chain_[i] = parent == palm_ ? ++fingers : chain_[parent];
  }
}

int RobotGrasp::sides(const std::vector<Touch>& touches, int object) const {
  struct Side {
    double force{0};
    Vector3 normal{Vector3::Zero()};
  };
  std::vector<Side> sides(chain_.empty() ? 1 : 1 + *std::max_element(chain_.begin(), chain_.end()));
  for (const Touch& t : touches) {
    if (t.a != Owner::robot || t.b != Owner::object || t.index_b != object) continue;
    const int chain = chain_of(t.index_a);
    if (chain < 0) continue;
    sides[chain].force += t.normal_force;
    sides[chain].normal += t.normal_force * t.normal;
  }
  int count = 0;
  bool opposed = false;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (sides[i].force < touch_force_) continue;
    ++count;
    for (std::size_t k = 0; k < i; ++k) {
      opposed = opposed || (sides[k].force >= touch_force_ && sides[i].normal.normalized().dot(sides[k].normal.normalized()) < kOpposed);
    }
  }
  return opposed ? count : 0;
}

bool RobotGrasp::update(const std::vector<Touch>& touches, int object, double dt) {
  const bool pressed = object >= 0 && sides(touches, object) >= kSides;
  pressed_ = pressed ? pressed_ + dt : 0;
  lost_ = pressed ? 0 : lost_ + dt;
  if (pressed_ >= grasp_time_) held_ = true;
  if (lost_ >= lose_time_) held_ = false;
  return held_;
}

}  // namespace handsel::sim
