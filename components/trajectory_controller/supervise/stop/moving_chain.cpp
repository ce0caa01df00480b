// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/moving_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "common/model/manipulator.hpp"

namespace handsel::trajectory_controller {

namespace {

/// Place of a link on the chain.
struct Place {
  int frame{-1};
  int finger_frame{-1};                 // of a finger: index into the frames of its hand
  Pose T_frame_link{Pose::Identity()};  // in the finger's frame, if it has one
  bool finger{};
  double reach{};            // of a finger: max distance of the link's origin from the base [m]
  double mass{};             // of a finger: mass of its links up to this one [kg]
  std::vector<Lever> inner;  // of a finger: axes from its base to the link, with their own reaches
  std::vector<double> factors;  // ratio of each of these axes to the axis that drives it
};

std::vector<char> finger_axes(const RobotModel& robot) {
  std::vector<char> fingers(static_cast<std::size_t>(robot.dof()), 0);
  for (const Manipulator& hand : hands_of(robot))
    if (hand.fingers != nullptr)
      for (int axis : hand.fingers->axes) fingers[static_cast<std::size_t>(axis)] = 1;
  return fingers;
}

double max_value(const RobotModel& robot, const Joint& joint) {
  const Axis& axis = robot.axes()[static_cast<std::size_t>(joint.dof)];
  return std::abs(joint.mimic_factor) * std::max(std::abs(axis.lower), std::abs(axis.upper)) +
         std::abs(joint.mimic_offset);
}

Pose held_at(const Joint& joint) {
  Pose held = Pose::Identity();
  if (joint.kind == JointKind::prismatic) held.translation() = joint.mimic_offset * joint.axis;
  if (joint.kind == JointKind::revolute || joint.kind == JointKind::continuous)
    held.linear() = Eigen::AngleAxisd(joint.mimic_offset, joint.axis).toRotationMatrix();
  return held;
}

/// Returns the axes that carry a capsule, from its frame to the root.
std::vector<Lever> levers(const RobotModel& robot, const std::vector<ChainFrame>& frames,
                          const ChainCapsule& capsule) {
  std::vector<Lever> out;
  double reach = std::max(capsule.a.norm(), capsule.b.norm()) + capsule.radius;
  for (int k = capsule.frame; k >= 0; k = frames[static_cast<std::size_t>(k)].parent) {
    const ChainFrame& frame = frames[static_cast<std::size_t>(k)];
    out.push_back({frame.axis, std::abs(frame.factor) * (frame.sliding ? 1.0 : reach)});
    reach += frame.p_parent_joint.norm();
    const Axis& axis = robot.axes()[static_cast<std::size_t>(frame.axis)];
    if (frame.sliding)
      reach += std::abs(frame.factor) * std::max(std::abs(axis.lower), std::abs(axis.upper)) +
               std::abs(frame.offset);
  }
  return out;
}

/// Computes the pose of a frame, but no velocities.
void place(const ChainFrame& frame, const FrameMotion& parent, double position,
           FrameMotion& out) noexcept {
  const double value = frame.factor * position + frame.offset;
  out.p = parent.p + parent.R * frame.p_parent_joint;
  out.R = parent.R * frame.R_parent_joint;
  if (frame.sliding) {
    out.p += value * (out.R * frame.direction);
    return;
  }
  const double s = std::sin(value), c = std::cos(value);
  const Vector3& d = frame.direction;
  Eigen::Matrix3d turn;  // Rodrigues' rotation matrix
  turn << c + (1 - c) * d.x() * d.x(), (1 - c) * d.x() * d.y() - s * d.z(),
      (1 - c) * d.x() * d.z() + s * d.y(), (1 - c) * d.x() * d.y() + s * d.z(),
      c + (1 - c) * d.y() * d.y(), (1 - c) * d.y() * d.z() - s * d.x(),
      (1 - c) * d.x() * d.z() - s * d.y(), (1 - c) * d.y() * d.z() + s * d.x(),
      c + (1 - c) * d.z() * d.z();
  out.R = out.R * turn;
}

double sum(const std::vector<Lever>& levers, const std::vector<double>& by_axis) noexcept {
  double out = 0.0;
  for (const Lever& lever : levers)
    out += lever.length * by_axis[static_cast<std::size_t>(lever.axis)];
  return out;
}

}  // namespace

double ChainCapsule::inner_bound(const std::vector<double>& by_axis) const noexcept {
  double most = 0.0;
  for (const std::vector<Lever>& finger : fingers) most = std::max(most, sum(finger, by_axis));
  return most;
}

double ChainCapsule::carried_bound(const std::vector<double>& by_axis) const noexcept {
  return sum(carried, by_axis);
}

double ChainCapsule::bound(const std::vector<double>& by_axis) const noexcept {
  return carried_bound(by_axis) + inner_bound(by_axis);
}

MovingChain::MovingChain(const RobotModel& robot, const std::vector<LinkCapsule>& capsules)
    : sliding_(static_cast<std::size_t>(robot.dof()), 0) {
  const std::vector<char> fingers = finger_axes(robot);
  std::vector<Place> places(robot.links().size());
  std::map<int, Hand> hands;  // by frame
  for (const Joint& joint : robot.joints()) {
    const Place& parent = places[static_cast<std::size_t>(joint.parent)];
    Place& child = places[static_cast<std::size_t>(joint.child)];
    child = parent;
    const bool moves = joint.kind != JointKind::fixed && joint.dof >= 0,
               slides = joint.kind == JointKind::prismatic;
    const Pose T_frame_joint = parent.T_frame_link * joint.T_parent_joint;
    const bool finger = parent.finger || (moves && fingers[static_cast<std::size_t>(joint.dof)]);
    if (finger && parent.finger) child.reach += joint.T_parent_joint.translation().norm();
    child.finger = finger;
    if (finger) child.mass += robot.links()[static_cast<std::size_t>(joint.child)].mass;
    if (!moves) {
      child.T_frame_link =
          T_frame_joint * (joint.kind == JointKind::fixed ? Pose::Identity() : held_at(joint));
      continue;
    }
    sliding_[static_cast<std::size_t>(joint.dof)] = slides;
    if (finger) {
      child.inner.push_back({joint.dof, child.reach});
      child.factors.push_back(std::abs(joint.mimic_factor));
      if (slides) child.reach += max_value(robot, joint);
    }
    std::vector<ChainFrame>& frames = finger ? hands[parent.frame].frames : frames_;
    int& frame = finger ? child.finger_frame : child.frame;
    frames.push_back({frame, joint.dof, slides, joint.mimic_factor, joint.mimic_offset,
                      T_frame_joint.linear(), T_frame_joint.translation(), joint.axis});
    frame = static_cast<int>(frames.size()) - 1;
    child.T_frame_link = Pose::Identity();
  }
  std::map<int, ChainCapsule> spheres;
  for (const LinkCapsule& capsule : capsules) {
    const Place& place = places[static_cast<std::size_t>(capsule.link)];
    if (place.frame < 0) continue;
    const Vector3 a = place.T_frame_link * capsule.a, b = place.T_frame_link * capsule.b;
    if (!place.finger) {
      capsules_.push_back({place.frame, capsule.link, a, b, capsule.radius, {}, {}, 0.0});
      continue;
    }
    hands[place.frame].parts.push_back({place.finger_frame, a, b, capsule.radius});
    ChainCapsule& sphere = spheres[place.frame];
    sphere.frame = place.frame;
    sphere.link = capsule.link;
    sphere.finger_mass = std::max(sphere.finger_mass, place.mass);
    const double reach =
        place.reach + std::max(capsule.a.norm(), capsule.b.norm()) + capsule.radius;
    std::vector<Lever> inner;
    for (std::size_t k = 0; k < place.inner.size(); ++k) {
      const Lever& axis = place.inner[k];
      inner.push_back({axis.axis, place.factors[k] * (sliding_[static_cast<std::size_t>(axis.axis)]
                                                          ? 1.0
                                                          : reach - axis.length)});
    }
    sphere.fingers.push_back(std::move(inner));
    // The levers use the max radius.
    double from_frame = reach;
    for (const ChainFrame& frame : hands[place.frame].frames)
      if (frame.parent < 0) from_frame = std::max(from_frame, reach + frame.p_parent_joint.norm());
    sphere.radius = std::max(sphere.radius, from_frame);
  }
  for (auto& [frame, hand] : hands) {
    if (hand.parts.empty()) continue;
    hand.capsule = capsules_.size();
    hand.enclosed_at.assign(hand.frames.size(), std::numeric_limits<double>::quiet_NaN());
    hand.placed.resize(hand.frames.size());
    capsules_.push_back(spheres[frame]);
    hands_.push_back(std::move(hand));
  }
  for (ChainCapsule& capsule : capsules_) capsule.carried = levers(robot, frames_, capsule);
  enclose_hands(Vector::Zero(robot.dof()));
}

void MovingChain::enclose_hands(const Vector& position) noexcept {
  constexpr double kSame =
      1e-3;  // max finger motion without an update; it enlarges the sphere [rad, m]
  for (Hand& hand : hands_) {
    bool moved = false;
    for (std::size_t k = 0; k < hand.frames.size(); ++k)
      moved = moved || !(std::abs(position[hand.frames[k].axis] - hand.enclosed_at[k]) <= kSame);
    if (!moved) continue;
    for (std::size_t k = 0; k < hand.frames.size(); ++k) {
      const ChainFrame& frame = hand.frames[k];
      hand.enclosed_at[k] = position[frame.axis];
      static const FrameMotion at_hand;
      place(frame, frame.parent < 0 ? at_hand : hand.placed[static_cast<std::size_t>(frame.parent)],
            position[frame.axis], hand.placed[k]);
    }
    Vector3 low = Vector3::Constant(1e9), high = -low;
    const auto each_end = [&](const auto& use) {
      for (const FingerPart& part : hand.parts) {
        static const FrameMotion at_hand;
        const FrameMotion& at =
            part.frame < 0 ? at_hand : hand.placed[static_cast<std::size_t>(part.frame)];
        use(Vector3(at.p + at.R * part.a), part.radius);
        use(Vector3(at.p + at.R * part.b), part.radius);
      }
    };
    each_end([&](const Vector3& p, double) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    });
    ChainCapsule& sphere = capsules_[hand.capsule];
    sphere.a = sphere.b = 0.5 * (low + high);
    sphere.radius = 0.0;
    each_end([&](const Vector3& p, double radius) {
      sphere.radius = std::max(sphere.radius, (p - sphere.a).norm() + radius);
    });
    sphere.radius += 2.0 * kSame;
  }
}

void MovingChain::move(const Vector& position, const Vector& velocity,
                       const std::vector<char>& needed,
                       std::vector<FrameMotion>& out) const noexcept {
  static const FrameMotion at_root;
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    if (!needed[k]) continue;
    const ChainFrame& frame = frames_[k];
    const FrameMotion& parent =
        frame.parent < 0 ? at_root : out[static_cast<std::size_t>(frame.parent)];
    FrameMotion& motion = out[k];
    place(frame, parent, position[frame.axis], motion);
    const Vector3 rate = frame.factor * velocity[frame.axis] * (motion.R * frame.direction);
    motion.linear = parent.linear + parent.angular.cross(motion.p - parent.p);
    motion.angular = parent.angular;
    (frame.sliding ? motion.linear : motion.angular) += rate;
  }
}

}  // namespace handsel::trajectory_controller
