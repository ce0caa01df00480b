// SPDX-License-Identifier: Apache-2.0
#include "common/cost/batch_cost.hpp"

#include <algorithm>
#include <cmath>

namespace handsel {
namespace {

void put(const Vector3& p, float (&out)[3]) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(p[i]);
}

}  // namespace

BatchCost::BatchCost(const RobotModel& robot, std::vector<LinkCapsule> capsules,
                     std::vector<LinkPoint> points)
    : robot_(robot),
      kernel_(&detail::cost_kernel()),
      link_capsules_(std::move(capsules)),
      link_points_(std::move(points)),
      ends_(rows(8 * link_capsules_.size())),
      point_(rows(3 * link_points_.size())) {}

BatchCost::Floats BatchCost::rows(std::size_t count) {
  const std::size_t size = std::max<std::size_t>(count, 1) * kStates;
  auto* memory = static_cast<float*>(::operator new[](size * sizeof(float), std::align_val_t(64)));
  std::fill_n(memory, size, 0.0f);
  return Floats(memory);
}

void BatchCost::set_axes(const std::vector<int>& axes) {
  axes_ = axes;
  folded_.resize(0);
}

void BatchCost::set_base(const Pose& T_world_base) {
  base_ = T_world_base;
  place_people();
}

void BatchCost::set_people(std::vector<Someone> people, double safety_radius,
                           double visibility_cutoff) {
  someone_ = std::move(people);
  safety_radius_ = safety_radius;
  visibility_cutoff_ = visibility_cutoff;
  place_people();
}

void BatchCost::place_people() {
  people_.clear();
  for (const Someone& one : someone_) {
    detail::CostPerson h{};
    const Vector3 bottom = one.body.axis_bottom - base_.translation();
    h.axis_x = static_cast<float>(bottom.x()), h.axis_y = static_cast<float>(bottom.y()),
    h.bottom = static_cast<float>(bottom.z());
    h.height = static_cast<float>(one.body.height), h.radius = static_cast<float>(one.body.radius);
    put(one.body.head - base_.translation(), h.head);
    h.head_radius = static_cast<float>(one.body.head_radius);
    h.over_safety_radius = 1 / static_cast<float>(safety_radius_);
    if (one.sight) {
      put(one.sight->eyes - base_.translation(), h.eyes);
      put(one.sight->direction, h.gaze);
      h.cutoff = static_cast<float>(visibility_cutoff_);
    }
    people_.push_back(h);
  }
  safety_ = rows(people_.size());
  visibility_ = rows(people_.size());
}

bool BatchCost::fold(const Vector& from, const Vector& to) {
  const auto same = [&](const Vector& a, const Vector& b) {
    for (Eigen::Index i = 0; i < a.size(); ++i)
      if (a[i] != b[i] && chain_.row_of_dof[static_cast<std::size_t>(i)] < 0) return false;
    return true;
  };
  if (folded_.size() != from.size() || !same(from, folded_)) {
    chain_.fold(robot_, axes_, from);
    folded_ = from;
    const auto body_of = [&](int link) {
      return chain_.body_of_link[static_cast<std::size_t>(link)];
    };
    const auto in_body = [&](int link, const Vector3& p) {
      return Vector3(chain_.T_body_link[static_cast<std::size_t>(link)] * p);
    };
    capsules_.clear();
    for (const LinkCapsule& c : link_capsules_) {
      detail::CostCapsule capsule{};
      put(in_body(c.link, c.a), capsule.a);
      put(in_body(c.link, c.b), capsule.b);
      capsule.radius = static_cast<float>(c.radius);
      capsule.half = static_cast<float>(0.5 * (c.b - c.a).norm() + 1e-5);
      capsule.body = body_of(c.link);
      capsules_.push_back(capsule);
    }
    points_.clear();
    for (const LinkPoint& p : link_points_) {
      detail::CostPoint point{};
      put(in_body(p.link, p.p_link), point.p);
      point.body = body_of(p.link);
      points_.push_back(point);
    }
    pose_ = rows(12 * (chain_.joints.size() + 1));
    q_ = rows(axes_.size());
  }
  return same(from, to);
}

bool BatchCost::run(const Vector& from, const Vector& to, const double* at, int count,
                    std::size_t points) {
  if (axes_.empty() || from.size() != robot_.dof() || to.size() != from.size() || !fold(from, to))
    return false;
  for (std::size_t row = 0; row < axes_.size(); ++row) {
    const double start = from[axes_[row]], along = to[axes_[row]] - start;
    if (!(std::abs(start) + std::abs(along) < BatchChain::kMaxTurn)) return false;
    for (int i = 0; i < count; ++i)
      q_[row * kStates + static_cast<std::size_t>(i)] = static_cast<float>(start + at[i] * along);
  }
  detail::CostTables tables{};
  tables.joints = chain_.joints.data();
  tables.capsules = capsules_.data();
  tables.points = points_.data();
  tables.people = people_.data();
  tables.joint_count = static_cast<std::int32_t>(chain_.joints.size());
  tables.capsule_count = static_cast<std::int32_t>(capsules_.size());
  tables.point_count = static_cast<std::int32_t>(std::min(points, points_.size()));
  tables.people_count = static_cast<std::int32_t>(people_.size());
  Pose rotation = base_;
  rotation.translation().setZero();
  put_rows(rotation, tables.root);
  kernel_->run(tables, {pose_.get(), ends_.get(), safety_.get(), visibility_.get(), point_.get()},
               q_.get(), count);
  return true;
}

}  // namespace handsel
