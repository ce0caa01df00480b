// SPDX-License-Identifier: Apache-2.0
#include "common/collision/collision_world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "common/collision/world/world_impl.hpp"

namespace handsel {
namespace {

bool exchanging_part(BodyPart part) {
  return part == BodyPart::forearm_left || part == BodyPart::hand_left ||
         part == BodyPart::forearm_right || part == BodyPart::hand_right;
}

Pose along(const Vector3& a, const Vector3& b) {
  const Vector3 d = b - a;
  const Vector3 axis = d.norm() > 1e-12 ? d : Vector3(Vector3::UnitZ());
  return make_pose(0.5 * (a + b), Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), axis));
}

}  // namespace

CollisionWorld::CollisionWorld(const RobotModel& robot, ObjectLibrary library)
    : impl_(new Impl(robot, std::move(library))) {}
CollisionWorld::~CollisionWorld() = default;
CollisionWorld::CollisionWorld(CollisionWorld&&) noexcept = default;

void CollisionWorld::set_base(const Pose& T_world_base) {
  impl_->T_world_base = T_world_base;
  impl_->solids_stale = true;
}

void CollisionWorld::set_moving_axes(const std::vector<int>& axes) {
  Impl& w = *impl_;
  if (axes == w.moving) return;
  w.moving = axes;
  w.moves_axis.assign(static_cast<std::size_t>(w.robot.dof()), 0);
  for (int axis : axes) w.moves_axis[axis] = 1;
  w.folded_at.resize(0);
  w.self_free.resize(0);
  w.batch = axes.empty() ? nullptr : std::make_unique<BatchWorld>(w.robot);
  w.rebuild_wider();
}

void CollisionWorld::set_turning_margin(double margin) {
  if (margin == impl_->turning_margin) return;
  impl_->turning_margin = margin;
  impl_->rebuild_wider();
}

void CollisionWorld::set_scene(const Scene& scene) {
  if (scene.robot_known) impl_->T_world_base = scene.T_world_base;
  impl_->last_scene = scene;
  impl_->rebuild_scene();
  impl_->solids_stale = true;
}

void CollisionWorld::set_obstacles(const std::vector<Obstacle>& obstacles) {
  impl_->obstacles.clear();
  impl_->solids_stale = true;
  for (const Obstacle& obstacle : obstacles) {
    SceneBody body;
    body.id = obstacle.id;
    body.shape = CollisionShape::make(obstacle.placed.shape);
    body.T_world_shape = obstacle.placed.T_parent_shape;
    impl_->obstacles.push_back(std::move(body));
  }
}

void CollisionWorld::set_people(const HumanState& state, PeopleParts parts) {
  impl_->people.clear();
  impl_->other_robots.clear();
  impl_->solids_stale = true;
  const auto moving_body = [](const Vector3& a, const Vector3& b, double radius) {
    Impl::MovingBody body;
    body.shape = CollisionShape::make(Capsule{radius, (b - a).norm()});
    body.T_world_shape = along(a, b);
    body.a = a;
    body.b = b;
    body.radius = radius;
    body.middle = 0.5 * (a + b);
    body.reach = 0.5 * (b - a).norm() + radius;
    return body;
  };
  for (const Person& person : state.people)
    for (const BodyCapsule& capsule : body_capsules(person)) {
      Impl::MovingBody body = moving_body(capsule.a, capsule.b, capsule.radius);
      body.id = person.id;
      body.arm = exchanging_part(capsule.part);
      body.obstacle = parts == PeopleParts::all || !body.arm;
      body.allowed = impl_->allowed.count(person.id) > 0;
      impl_->people.push_back(std::move(body));
    }
  for (const OtherRobot& robot : state.robots)
    for (const MovingPart& part : robot.parts) {
      Impl::MovingBody body = moving_body(part.a, part.b, part.radius);
      body.id = robot.name;
      body.is_robot = true;
      impl_->other_robots.push_back(std::move(body));
    }
}

void CollisionWorld::set_attachment(const Attachment& attachment,
                                    const std::vector<std::string>& allowed_contacts) {
  impl_->attachment = attachment;
  impl_->allowed = {allowed_contacts.begin(), allowed_contacts.end()};
  for (Impl::MovingBody& person : impl_->people)
    person.allowed = impl_->allowed.count(person.id) > 0;
  impl_->rebuild_scene();
  impl_->rebuild_held();
  impl_->solids_stale = true;
  impl_->folded_at.resize(0);
}

CollisionVerdict CollisionWorld::check(const Vector& q) {
  CollisionVerdict verdict;
  impl_->check_state(q, &verdict);
  return verdict;
}

bool CollisionWorld::is_free(const Vector& q) {
  if (!impl_->batch_ready(q) || impl_->batch->unclear(&q, 1) != 0)
    return impl_->check_state(q, nullptr);
  ++impl_->checks;
  return true;
}

CollisionVerdict CollisionWorld::check_people(const Vector& q) {
  CollisionVerdict verdict;
  ++impl_->checks;
  impl_->place(q);
  impl_->people_touch(&verdict);
  return verdict;
}

CollisionVerdict CollisionWorld::check_scene(const Vector& q) {
  CollisionVerdict verdict;
  impl_->check_state(q, &verdict, false);
  return verdict;
}

CollisionVerdict CollisionWorld::check_motion(const Vector& from, const Vector& to, double step) {
  CollisionVerdict verdict;
  const int last = motion_states(from, to, step) - 1;
  if (impl_->batch_ready(from) && impl_->moves_only(from, to)) {
    impl_->check_line(from, to, last, &verdict);
    return verdict;
  }
  const auto at = [&](int i) -> Vector {
    return from + (to - from) * (static_cast<double>(i) / std::max(1, last));
  };
  if (!impl_->check_state(from, &verdict) || (last > 0 && !impl_->check_state(to, &verdict)))
    return verdict;
  int stride = 1;
  while (stride < last) stride *= 2;
  for (; stride > 1; stride /= 2)
    for (int i = stride / 2; i < last; i += stride)
      if (!impl_->check_state(at(i), &verdict)) return verdict;
  return verdict;
}

bool CollisionWorld::surely_free_at_steps(const Vector& from, const Vector& to, double step) {
  Impl& w = *impl_;
  if (!w.batch_ready(from) || !w.moves_only(from, to)) return false;
  const int states = motion_states(from, to, step), last = std::max(1, states - 1);
  const int blocks = (states + BatchWorld::kStates - 1) / BatchWorld::kStates;
  std::array<double, BatchWorld::kStates> at;
  for (int block = 0; block < blocks; ++block) {
    int count = 0;
    for (int i = block; i < states; i += blocks)
      at[static_cast<std::size_t>(count++)] = static_cast<double>(i) / last;
    w.checks += static_cast<std::uint64_t>(count);
    if (w.batch->unclear_on_line(from, to, at.data(), count, true) != 0) return false;
  }
  return true;
}

bool CollisionWorld::surely_free(const Vector& from, const Vector& to) {
  constexpr double kFinest = 1.0 / 4096;
  constexpr int kMaxBlocks = 256;
  return impl_->batch_ready(from) && impl_->moves_only(from, to) &&
         impl_->batch->unclear_stretches(from, to, kFinest, kMaxBlocks).empty();
}

std::uint32_t CollisionWorld::unclear_boxes(const Vector* low, const Vector* high, int count) {
  static_assert(kMaxBoxes == BatchWorld::kStates);
  Impl& w = *impl_;
  w.checks += static_cast<std::uint64_t>(count);
  if (!w.batch_ready(low[0])) return (1u << count) - 1u;
  return w.batch->unclear_boxes(low, high, count);
}

std::uint64_t CollisionWorld::checks() const { return impl_->checks; }
std::uint64_t CollisionWorld::exact_checks() const { return impl_->exact_checks; }

}  // namespace handsel
