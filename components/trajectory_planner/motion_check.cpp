// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/motion_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/manipulator.hpp"
#include "common/trajectory/limits_check.hpp"

namespace handsel::trajectory_planner {

namespace {

constexpr double kMaxDivision = 16;     // max division of the finest box for the scene
constexpr double kMaxHeldExtent = 0.5;  // max extent of a held object from the tool [m]

/// Returns the max distance of the link's points from its frame's origin [m].
double extent_of(const Link& link) {
  struct Radius {
    double operator()(const Sphere& s) const { return s.radius; }
    double operator()(const Box& s) const { return 0.5 * s.size.norm(); }
    double operator()(const Cylinder& s) const { return std::hypot(s.radius, 0.5 * s.length); }
    double operator()(const Capsule& s) const { return s.radius + 0.5 * s.length; }
    double operator()(const MeshPtr& s) const {
      double max_radius = 0;
      for (const Vector3& v : s->vertices) max_radius = std::max(max_radius, v.squaredNorm());
      return std::sqrt(max_radius);
    }
  };
  double max_radius = 0;
  for (const PlacedShape& placed : link.collision)
    max_radius = std::max(max_radius, placed.T_parent_shape.translation().norm() +
                                          std::visit(Radius{}, placed.shape));
  return max_radius;
}

/// Returns the max distance of moved points from each axis in any configuration [m]; 1 for a
/// prismatic axis.
Vector max_levers(const RobotModel& robot) {
  std::vector<double> extent;
  for (const Link& link : robot.links()) extent.push_back(extent_of(link));
  for (const Manipulator& hand : hands_of(robot))
    if (hand.palm >= 0) extent[static_cast<std::size_t>(hand.palm)] += kMaxHeldExtent;
  Vector levers = Vector::Zero(robot.dof());
  std::vector<double> from_joint(robot.links().size());
  for (const Joint& joint : robot.joints()) {
    if (joint.dof < 0) continue;
    double lever = 0;
    std::fill(from_joint.begin(), from_joint.end(), -1.0);
    from_joint[static_cast<std::size_t>(joint.child)] = 0;
    for (std::size_t i = 0; i < robot.links().size(); ++i) {
      const int up = robot.links()[i].parent_joint;
      if (up < 0) continue;
      const Joint& above = robot.joints()[static_cast<std::size_t>(up)];
      const double parent = from_joint[static_cast<std::size_t>(above.parent)];
      const double slides = above.kind == JointKind::prismatic
                                ? std::max(std::abs(above.lower), std::abs(above.upper))
                                : 0;
      if (parent >= 0) from_joint[i] = parent + above.T_parent_joint.translation().norm() + slides;
      if (from_joint[i] >= 0) lever = std::max(lever, from_joint[i] + extent[i]);
    }
    levers[joint.dof] +=
        std::abs(joint.mimic_factor) * (joint.kind == JointKind::prismatic ? 1.0 : lever);
  }
  return levers;
}

}  // namespace

MotionCheck::MotionCheck(const RobotModel& robot, CollisionWorld& world,
                         const std::vector<int>& axes, const Vector& rest, double finest)
    : robot_(robot),
      world_(world),
      axes_(axes),
      rest_(rest),
      finest_(finest),
      acceleration_(static_cast<Eigen::Index>(axes.size())),
      low_(CollisionWorld::kMaxBoxes, rest),
      high_(CollisionWorld::kMaxBoxes, rest) {
  world_.set_moving_axes(axes_);
}

/// Encloses a part of the trajectory: between its ends an axis deviates by at most a t^2 / 8 from a
/// line.
void MotionCheck::enclose(const SegmentTable& table, const Piece& piece, Vector& low,
                          Vector& high) {
  const double lasts = piece.end - piece.begin;
  table.evaluate(piece.begin, cursor_, at_begin_);
  table.evaluate(piece.end, cursor_, at_end_);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double off = acceleration_[k] * lasts * lasts / 8;
    low[axes_[i]] = std::min(at_begin_.position[k], at_end_.position[k]) - off;
    high[axes_[i]] = std::max(at_begin_.position[k], at_end_.position[k]) + off;
  }
}

MotionCheck::Leaf MotionCheck::check(const Vector& low, const Vector& high) {
  const Vector middle = 0.5 * (low + high);
  if (!world_.is_free(middle)) return Leaf::contact;
  if (levers_.size() == 0) levers_ = max_levers(robot_);
  const double moves = 0.5 * (high - low).dot(levers_);
  if (world_.distance_to_scene(middle, moves) >= moves) return Leaf::free;
  return (high - low).maxCoeff() > finest_ / kMaxDivision ? Leaf::unclear : Leaf::contact;
}

void MotionCheck::cut_in_two(const Piece& piece) {
  const double middle = 0.5 * (piece.begin + piece.end);
  open_.push_back({middle, piece.end});
  open_.push_back({piece.begin, middle});
}

bool MotionCheck::free(const Trajectory& trajectory, const SegmentTable& table) {
  for (std::size_t i = 0; i < axes_.size(); ++i)
    acceleration_[static_cast<Eigen::Index>(i)] =
        rate_extremes(trajectory.axes[i].start, trajectory.axes[i].segments.data(),
                      static_cast<int>(trajectory.axes[i].segments.size()))
            .acceleration;
  at_begin_ = at_end_ = trajectory.at(0);
  cursor_ = 0;
  open_.clear();
  const double part = table.duration() / CollisionWorld::kMaxBoxes;
  for (int i = CollisionWorld::kMaxBoxes; i > 0; --i) open_.push_back({(i - 1) * part, i * part});
  std::array<Piece, CollisionWorld::kMaxBoxes> pieces;
  while (!open_.empty()) {
    int count = 0;
    for (; count < CollisionWorld::kMaxBoxes && !open_.empty(); ++count, open_.pop_back()) {
      const auto at = static_cast<std::size_t>(count);
      pieces[at] = open_.back();
      enclose(table, pieces[at], low_[at], high_[at]);
    }
    const std::uint32_t unclear = world_.unclear_boxes(low_.data(), high_.data(), count);
    for (int i = count - 1; i >= 0; --i) {
      if ((unclear >> i & 1) == 0) continue;
      const auto at = static_cast<std::size_t>(i);
      if ((high_[at] - low_[at]).maxCoeff() > finest_) {
        cut_in_two(pieces[at]);
        continue;
      }
      const Leaf leaf = check(low_[at], high_[at]);
      if (leaf == Leaf::contact) return false;
      if (leaf == Leaf::unclear) cut_in_two(pieces[at]);
    }
  }
  return true;
}

}  // namespace handsel::trajectory_planner
