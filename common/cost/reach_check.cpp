// SPDX-License-Identifier: Apache-2.0
#include "common/cost/reach_check.hpp"

#include <algorithm>
#include <cmath>

#include "common/cost/human_cost.hpp"
#include "common/cost/person_frame.hpp"

namespace handsel {
namespace {

bool inside(const Vector3& p_box, const Vector3& half) {
  return ((p_box.cwiseAbs() - half).array() <= 0).all();
}

/// Returns whether the segment intersects the box (slab test, box frame).
bool crosses(const Vector3& a, const Vector3& b, const Vector3& half) {
  double enter = 0, leave = 1;
  for (int i = 0; i < 3; ++i) {
    const double d = b[i] - a[i];
    if (std::abs(d) < 1e-12) {
      if (std::abs(a[i]) > half[i]) return false;
      continue;
    }
    const double t0 = (-half[i] - a[i]) / d, t1 = (half[i] - a[i]) / d;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter <= leave;
}

double distance(const Vector3& p_box, const Vector3& half) {
  return (p_box.cwiseAbs() - half).cwiseMax(0).norm();
}

}  // namespace

ReachCheck::ReachCheck(const Person& person, const std::vector<SceneBox>& boxes, double clearance) {
  const BodyJoint *left = find_joint(person, "l_shoulder"),
                  *right = find_joint(person, "r_shoulder");
  const double reach = arm_length(person) + clearance;
  for (const SceneBox& box : boxes) {
    Obstacle one;
    one.T_box_world = box.T_world_box.inverse();
    one.half = 0.5 * box.size;
    one.near = one.half + Vector3::Constant(clearance);
    one.upright = box.T_world_box.linear()(2, 2) > 0.99;
    one.shadows = left != nullptr && right != nullptr;
    if (one.shadows) {
      one.left = one.T_box_world * left->position;
      one.right = one.T_box_world * right->position;
      if (distance(one.left, one.half) > reach && distance(one.right, one.half) > reach)
        continue;  // no hand reaches this point
    }
    ids_.push_back(box.id);
    one.id = ids_.size() - 1;
    obstacles_.push_back(one);
  }
}

bool ReachCheck::Obstacle::blocks(const Vector3& p_world) const {
  const Vector3 p = T_box_world * p_world;
  if (inside(p, near)) return true;
  if (!shadows) return false;
  if (upright && p.z() < 0 && left.z() > 0 && std::abs(p.x()) <= half.x() &&
      std::abs(p.y()) <= half.y())
    return true;
  return crosses(left, p, half) && crosses(right, p, half);
}

const std::string* ReachCheck::blocked_by(const Vector3& p_world) const {
  for (const Obstacle& obstacle : obstacles_)
    if (obstacle.blocks(p_world)) return &ids_[obstacle.id];
  return nullptr;
}

}  // namespace handsel
