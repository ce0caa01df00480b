// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/hand/finger_chain.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "common/base/errors.hpp"

namespace handsel::grasp_planner {

FingerChain::FingerChain(const HandModel& hand, int finger) {
  const RobotModel& model = hand.model();
  const Finger& f = hand.fingers().at(static_cast<std::size_t>(finger));
  tip_radius_ = f.tip_radius;
  const int tip = model.link_index(f.tip_link);
  if (tip < 0)
    throw ConfigError("hand " + hand.name() + ": finger " + f.name + " names tip link " +
                      f.tip_link + ", which its URDF does not have");
  // Each joint that this finger's axes drive on the finger's branch is a step; fixed joints are
  // merged into their neighbours. Coupled fingers share axes, so the branch begins at the first
  // joint above the tip that one of these axes moves.
  const auto driven = [&](const Joint& joint) {
    return joint.dof >= 0 && std::find(f.axes.begin(), f.axes.end(), joint.dof) != f.axes.end();
  };
  int root = -1;
  for (int l = tip; model.links()[static_cast<std::size_t>(l)].parent_joint >= 0;) {
    const Joint& joint = model.joints()[static_cast<std::size_t>(
        model.links()[static_cast<std::size_t>(l)].parent_joint)];
    if (driven(joint)) root = l;
    l = joint.parent;
  }
  struct Frame {
    int step{-1};
    Pose T_step_link{Pose::Identity()};
  };
  std::vector<Frame> frames(model.links().size());
  for (std::size_t l = 1; l < model.links().size(); ++l) {
    const Joint& joint = model.joints()[static_cast<std::size_t>(model.links()[l].parent_joint)];
    const Frame& parent = frames[static_cast<std::size_t>(joint.parent)];
    const Pose T_step_joint = parent.T_step_link * joint.T_parent_joint;
    const bool mine = driven(joint) && (static_cast<int>(l) == root || parent.step >= 0);
    if (!mine) {
      frames[l] = {parent.step, T_step_joint};
    } else {
      steps_.push_back({parent.step, T_step_joint, joint.axis, joint.kind == JointKind::prismatic,
                        joint.dof, joint.is_mimic ? joint.mimic_factor : 1.0,
                        joint.is_mimic ? joint.mimic_offset : 0.0});
      frames[l] = {static_cast<int>(steps_.size()) - 1, Pose::Identity()};
    }
    if (frames[l].step >= 0)
      carried_.push_back({static_cast<int>(l), frames[l].step, frames[l].T_step_link});
  }
  const Frame& at_tip = frames[static_cast<std::size_t>(tip)];
  if (at_tip.step < 0)
    throw ConfigError("hand " + hand.name() + ": no joint of finger " + f.name +
                      " moves its tip link " + f.tip_link);
  tip_step_ = at_tip.step;
  T_step_tip_ = at_tip.T_step_link;
  for (int s = tip_step_; s >= 0; s = steps_[static_cast<std::size_t>(s)].parent)
    tip_path_.push_back(s);
  std::reverse(tip_path_.begin(), tip_path_.end());
  for (const int axis : f.axes) {
    const bool used = std::any_of(tip_path_.begin(), tip_path_.end(), [&](int s) {
      return steps_[static_cast<std::size_t>(s)].dof == axis;
    });
    if (used) axes_.push_back(axis);
  }
  turn_to_z();
  const int outermost = axes_.back();
  closing_sign_ = 0.5 * (hand.lower_contact()[outermost] + hand.upper_contact()[outermost]) >=
                          hand.rest()[outermost]
                      ? 1.0
                      : -1.0;
}

// Rotates the frame of every step so that the joint axis is z: a joint rotation then changes only
// two columns.
void FingerChain::turn_to_z() {
  std::vector<Pose> T_old_new(steps_.size(), Pose::Identity());
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    Step& step = steps_[s];
    T_old_new[s].linear() =
        Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), step.axis).toRotationMatrix();
    step.T_parent_joint = step.T_parent_joint * T_old_new[s];
    if (step.parent >= 0)
      step.T_parent_joint =
          T_old_new[static_cast<std::size_t>(step.parent)].inverse() * step.T_parent_joint;
    step.axis = Vector3::UnitZ();
  }
  for (Carried& c : carried_)
    c.T_step_link = T_old_new[static_cast<std::size_t>(c.step)].inverse() * c.T_step_link;
  T_step_tip_ = T_old_new[static_cast<std::size_t>(tip_step_)].inverse() * T_step_tip_;
}

void FingerChain::forward(const Vector& q, std::vector<Pose>& T) const {
  T.resize(steps_.size());
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    const Step& step = steps_[s];
    const double value = step.factor * q[step.dof] + step.offset;
    Eigen::Matrix3d R = step.T_parent_joint.linear();
    Vector3 p = step.T_parent_joint.translation();
    if (step.prismatic) {
      p += value * R.col(2);
    } else {
      const double c = std::cos(value), k = std::sin(value);
      const Vector3 x = R.col(0);
      R.col(0) = c * x + k * R.col(1);
      R.col(1) = c * R.col(1) - k * x;
    }
    Pose& out = T[s];
    out.makeAffine();
    if (step.parent < 0) {
      out.linear() = R;
      out.translation() = p;
    } else {
      const Pose& parent = T[static_cast<std::size_t>(step.parent)];
      const Eigen::Matrix3d Rp = parent.linear();
      out.linear().noalias() = Rp.lazyProduct(R);
      out.translation() = Rp * p + parent.translation();
    }
  }
}

Vector3 FingerChain::tip(const Vector& q) const {
  std::vector<Pose> T;
  forward(q, T);
  return tip(T);
}

Eigen::Matrix3Xd FingerChain::jacobian(const std::vector<Pose>& T, const Vector3& p_hand) const {
  Eigen::Matrix3Xd J = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(axes_.size()));
  for (const int s : tip_path_) {
    const Step& step = steps_[static_cast<std::size_t>(s)];
    const auto column = std::find(axes_.begin(), axes_.end(), step.dof) - axes_.begin();
    const Pose& frame = T[static_cast<std::size_t>(s)];
    const Vector3 axis = frame.linear() * step.axis;
    J.col(column) +=
        step.factor * (step.prismatic ? axis : axis.cross(p_hand - frame.translation()));
  }
  return J;
}

Vector3 FingerChain::tip_direction(const std::vector<Pose>& T) const {
  const Vector3 d = tip(T) - T[static_cast<std::size_t>(tip_step_)].translation();
  const double length = d.norm();
  return length > 1e-9 ? Vector3(d / length) : Vector3::UnitZ();
}

Vector3 FingerChain::closing_direction(const std::vector<Pose>& T) const {
  const Vector3 d = closing_sign_ * jacobian(T).rightCols<1>();
  const double length = d.norm();
  return length > 1e-9 ? Vector3(d / length) : Vector3::UnitX();
}

void FingerChain::add_effort(const std::vector<Pose>& T_hand_step, const Pose& T_hand_object,
                             const Vector3& p_object, const Vector3& force,
                             Vector& hand_effort) const {
  const Eigen::VectorXd effort = jacobian(T_hand_step, T_hand_object * p_object).transpose() *
                                 (T_hand_object.linear() * force);
  for (std::size_t a = 0; a < axes_.size(); ++a)
    hand_effort[axes_[a]] += effort[static_cast<Eigen::Index>(a)];
}

bool FingerChain::inverse(const Vector3& p_hand_tip, const Vector& lower, const Vector& upper,
                          Vector& q, double tolerance, int iterations) const {
  thread_local std::vector<Pose> T;
  const auto n = static_cast<Eigen::Index>(axes_.size());
  for (const int a : axes_) q[a] = std::clamp(q[a], lower[a], upper[a]);
  forward(q, T);
  Vector3 error = p_hand_tip - tip(T);
  double best = error.squaredNorm(), damping = 1e-6;
  for (int i = 0; i < iterations && best > tolerance * tolerance; ++i) {
    const Eigen::Matrix3Xd J = jacobian(T);
    bool better = false;
    while (!better && damping < 1e3) {
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8> H = J.transpose() * J;
      H.diagonal().array() += damping;
      const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> dq =
          H.ldlt().solve(J.transpose() * error);
      Vector next = q;
      for (Eigen::Index k = 0; k < n; ++k) {
        const int a = axes_[static_cast<std::size_t>(k)];
        next[a] = std::clamp(q[a] + dq[k], lower[a], upper[a]);
      }
      forward(next, T);
      const Vector3 left = p_hand_tip - tip(T);
      if (left.squaredNorm() < best * (1 - 1e-4)) {
        better = true;
        q = next;
        error = left;
        best = left.squaredNorm();
        damping = std::max(1e-8, damping * 0.1);
      } else {
        damping *= 10;
      }
    }
    if (!better) break;
  }
  return best <= tolerance * tolerance;
}

}  // namespace handsel::grasp_planner
