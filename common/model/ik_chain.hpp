// SPDX-License-Identifier: Apache-2.0
// The chain of joints that moves one group's tip, prepared for inverse kinematics: everything that
// does not turn is folded in.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel::ik {

constexpr int kMaxAxes = 24;

using Axes = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxAxes, 1>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxAxes>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// From one pose to another: translation [m] and turn [rad] in the axes both are given in.
inline Vector6 error_of(const Pose& target, const Pose& now) {
  Vector6 e;
  e.head<3>() = target.translation() - now.translation();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(target.linear() * now.linear().transpose()));
  e.tail<3>() = turn.angle() * turn.axis();
  return e;
}

/// A moving joint of the chain.
struct Element {
  Pose T_before;          ///< joint frame in the frame of the element before (first: the root)
  Vector3 axis;           ///< joint frame, unit
  bool prismatic;         ///< slides instead of turning
  int column;             ///< index of its axis in the group
  double factor, offset;  ///< joint value = factor * q[column] + offset
};

class Chain {
 public:
  Chain(const RobotModel& robot, const Group& group, const Vector& q)
      : size_(static_cast<int>(group.axes.size())) {
    const int kept = std::min(size_, kMaxAxes);  // fits() tells that there are more
    lower_.resize(kept), upper_.resize(kept), rest_.resize(kept);
    for (int i = 0; i < kept; ++i) {
      const Axis& axis = robot.axes()[group.axes[i]];
      lower_[i] = axis.lower, upper_[i] = axis.upper,
      rest_[i] = robot.rest_configuration()[group.axes[i]];
    }
    std::vector<int> path;
    for (int link = group.tip; robot.links()[link].parent_joint >= 0;
         link = robot.joints()[path.back()].parent)
      path.push_back(robot.links()[link].parent_joint);
    Pose T = Pose::Identity();
    for (auto j = path.rbegin(); j != path.rend(); ++j) {
      const Joint& joint = robot.joints()[*j];
      T = T * joint.T_parent_joint;
      if (joint.kind == JointKind::fixed) continue;
      int column = -1;
      for (int c = 0; c < kept; ++c)
        if (group.axes[c] == joint.dof) column = c;
      if (column < 0) {
        const double value =
            (joint.dof >= 0 ? joint.mimic_factor * q[joint.dof] : 0.0) + joint.mimic_offset;
        if (joint.kind == JointKind::prismatic)
          T.translation() += T.linear() * (value * joint.axis);
        else
          T.rotate(Eigen::AngleAxisd(value, joint.axis));
        continue;
      }
      const bool prismatic = joint.kind == JointKind::prismatic;
      if (!elements_.empty()) reach_ += T.translation().norm();
      if (prismatic)
        reach_ += std::max(std::abs(lower_[column]), std::abs(upper_[column])) *
                  std::abs(joint.mimic_factor);
      elements_.push_back(
          {T, joint.axis, prismatic, column, joint.mimic_factor, joint.mimic_offset});
      T = Pose::Identity();
    }
    T_after_ = T;
    reach_ += T.translation().norm();
  }

  int size() const { return size_; }                ///< axes of the group
  bool empty() const { return elements_.empty(); }  ///< no axis of the group moves the tip
  const Axes& lower() const { return lower_; }      ///< position limits [rad] ([m])
  const Axes& upper() const { return upper_; }      ///< position limits [rad] ([m])
  const Axes& rest() const { return rest_; }        ///< rest configuration of the group
  const std::vector<Element>& elements() const { return elements_; }  ///< from root to tip
  /// Returns false for points (root frame [m]) that the tip cannot reach; true is no promise. The
  /// chain must not be empty.
  bool within_reach(const Vector3& p) const {
    return (p - elements_.front().T_before.translation()).norm() <= reach_ + 1e-6;
  }

  /// Returns the tip's pose in the root frame and writes its Jacobian (linear, then angular; root
  /// axes) unless J is null.
  Pose forward(const Axes& q, Jacobian* J) const {
    Pose T = Pose::Identity();
    Vector3 origins[std::size_t{2} * kMaxAxes], axes[2 * kMaxAxes];
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      const Element& e = elements_[i];
      T = T * e.T_before;
      origins[i] = T.translation();
      axes[i] = T.linear() * e.axis;
      const double value = e.factor * q[e.column] + e.offset;
      if (e.prismatic)
        T.translation() += value * axes[i];
      else
        T.linear() = T.linear() * Eigen::AngleAxisd(value, e.axis).toRotationMatrix();
    }
    T = T * T_after_;
    if (J == nullptr) return T;
    J->setZero(6, size_);
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      const Element& e = elements_[i];
      if (e.prismatic) {
        J->block<3, 1>(0, e.column) += e.factor * axes[i];
      } else {
        J->block<3, 1>(0, e.column) += e.factor * axes[i].cross(T.translation() - origins[i]);
        J->block<3, 1>(3, e.column) += e.factor * axes[i];
      }
    }
    return T;
  }
  /// Whether the group has few enough axes and joints for the fixed-size arrays; else forward()
  /// must not be called.
  bool fits() const { return size_ <= kMaxAxes && elements_.size() <= 2 * kMaxAxes; }

 private:
  int size_;
  Axes lower_, upper_, rest_;
  std::vector<Element> elements_;
  Pose T_after_{Pose::Identity()};
  double reach_{0};
};

}  // namespace handsel::ik
