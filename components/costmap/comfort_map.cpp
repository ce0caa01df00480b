#include "components/costmap/comfort_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/cost/human_cost.hpp"
#include "common/cost/person_frame.hpp"

namespace handsel::costmap {
namespace {

constexpr std::uint8_t kNever = 255;
constexpr std::array kWatched = {"l_shoulder", "r_shoulder", "waist"};
constexpr double kArmTolerance = 0.01;  // [m] an arm that seems longer or shorter by less is the same arm

Vector3 shoulder_middle(const Person& person) {
  const BodyJoint *left = find_joint(person, "l_shoulder"), *right = find_joint(person, "r_shoulder");
  if (left && right) return 0.5 * (left->position + right->position);
  return left ? left->position : right ? right->position : Vector3(Vector3::Zero());
}

bool inside(const Vector3& p_box, const Vector3& half) { return ((p_box.cwiseAbs() - half).array() <= 0).all(); }

/// Does the segment pass through the box (slab test, box frame)?
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

/// A box with the shoulders in its frame, ready to judge points.
struct Obstacle {
  Pose T_box_world;
  Vector3 half, grown;
  Vector3 left, right;  ///< shoulders, box frame
  bool upright{};       ///< its z is the world's

  bool rules_out(const Vector3& p_world) const {
    const Vector3 p = T_box_world * p_world;
    if (inside(p, grown)) return true;
    if (upright && p.z() < 0 && left.z() > 0 && std::abs(p.x()) <= half.x() && std::abs(p.y()) <= half.y()) return true;
    return crosses(left, p, half) && crosses(right, p, half);
  }
};

}  // namespace

Costmap MapMaker::make(const Person& person, const std::vector<SceneBox>& boxes) {
  Costmap map;
  map.layer = "arm_comfort";
  map.person = person.id;
  map.resolution = settings_.resolution;
  const int half_cells = static_cast<int>(std::ceil(settings_.reach / settings_.resolution));
  const Vector3 middle = shoulder_middle(person);
  for (int i = 0; i < 3; ++i) map.origin[i] = settings_.resolution * (std::round(middle[i] / settings_.resolution) - half_cells);
  map.nx = map.ny = map.nz = static_cast<std::uint32_t>(2 * half_cells + 1);
  map.values.assign(std::size_t{map.nx} * map.ny * map.nz, kNever);

  const BodyJoint *left = find_joint(person, "l_shoulder"), *right = find_joint(person, "r_shoulder");
  const std::optional<ArmSize> left_arm = arm_size(person, Side::left), right_arm = arm_size(person, Side::right);
  if (!left_arm || !right_arm) return map;
  if (!left_.suits(*left_arm, kArmTolerance)) left_ = ComfortVolume(*left_arm, settings_.resolution);
  if (!right_.suits(*right_arm, kArmTolerance))
    right_ = left_.suits(*right_arm, kArmTolerance) ? left_ : ComfortVolume(*right_arm, settings_.resolution);
  std::vector<Obstacle> obstacles;
  for (const SceneBox& box : boxes) {
    const Pose T_box_world = box.T_world_box.inverse();
    obstacles.push_back({T_box_world, 0.5 * box.size, 0.5 * box.size + Vector3::Constant(settings_.clearance), T_box_world * left->position,
                         T_box_world * right->position, box.T_world_box.linear()(2, 2) > 0.99});
  }
  const Eigen::Matrix3d to_torso = torso_axes(person).transpose();
  std::size_t index = 0;
  for (std::uint32_t k = 0; k < map.nz; ++k)
    for (std::uint32_t j = 0; j < map.ny; ++j)
      for (std::uint32_t i = 0; i < map.nx; ++i, ++index) {
        const Vector3 p = map.origin + settings_.resolution * Vector3(i, j, k);
        Vector3 outward_right = to_torso * (p - right->position);
        outward_right.y() = -outward_right.y();
        const double cost = std::min(left_.cost(to_torso * (p - left->position)), right_.cost(outward_right));
        if (cost >= 1.0) continue;
        if (std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& o) { return o.rules_out(p); })) continue;
        map.values[index] = static_cast<std::uint8_t>(std::lround(cost * 254));
      }
  return map;
}

bool Watch::changed(const Person& person, const std::vector<SceneBox>& boxes) {
  std::vector<Vector3> joints;
  for (const char* name : kWatched) {
    const BodyJoint* joint = find_joint(person, name);
    joints.push_back(joint ? joint->position : Vector3(Vector3::Zero()));
  }
  const Vector3 forward = torso_axes(person).col(0);
  bool same = person.id == person_ && joints.size() == joints_.size() && boxes.size() == boxes_.size() &&
              std::acos(std::clamp(forward.dot(forward_), -1.0, 1.0)) < turned_;
  for (std::size_t i = 0; same && i < joints.size(); ++i) same = (joints[i] - joints_[i]).norm() < moved_;
  for (std::size_t i = 0; same && i < boxes.size(); ++i)
    same = boxes[i].id == boxes_[i].id && boxes[i].size == boxes_[i].size && boxes[i].T_world_box.isApprox(boxes_[i].T_world_box, 1e-4);
  if (same) return false;
  person_ = person.id;
  joints_ = std::move(joints);
  forward_ = forward;
  boxes_ = boxes;
  return true;
}

const Person* nearest_person(const HumanState& people, const Vector3& point) {
  const Person* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Person& person : people.people) {
    const double d = (shoulder_middle(person) - point).norm();
    if (d >= least) continue;
    least = d;
    best = &person;
  }
  return best;
}

}  // namespace handsel::costmap
