// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/model_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "deploy/handsel/own_robot/robot_parts.hpp"

namespace handsel {
namespace {

std::string short_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

class Sweep {
 public:
  Sweep(const RobotModel& robot, const HandModel* hand, const SweepSettings& settings)
      : robot_(robot), hand_(hand), settings_(settings) {}

  std::vector<std::string> faults() {
    check_limits();
    check_mimic_ranges();
    if (hand_ != nullptr && hand_->pinches()) check_pads();
    if (hand_ != nullptr) check_tool_frame();
    check_pairs();
    return faults_;
  }

 private:
  const Joint& joint_of(int axis) const {
    return robot_
        .joints()[static_cast<std::size_t>(robot_.axes()[static_cast<std::size_t>(axis)].joint)];
  }

  void check_limits() {
    const KinematicLimits& guard = robot_.guard_limits();
    for (int i = 0; i < robot_.dof(); ++i) {
      const Axis& axis = robot_.axes()[static_cast<std::size_t>(i)];
      const bool slides = joint_of(i).kind == JointKind::prismatic;
      const double range = std::max(std::abs(axis.lower), std::abs(axis.upper)),
                   v = guard.velocity[i], a = guard.acceleration[i], j = guard.jerk[i];
      const auto fault = [&](const std::string& what) {
        faults_.push_back("joint " + axis.name + ": " + what);
      };
      if (!slides && range > settings_.max_angle)
        fault("its limits reach " + short_text(range) +
              " rad, which looks like degrees; a URDF is in radians");
      const double max_speed = slides ? settings_.max_sliding_speed : settings_.max_speed;
      if (v > max_speed)
        fault("guard.velocity is " + short_text(v) +
              (slides ? " m/s, which looks like millimetres" : " rad/s, which looks like degrees") +
              " per second");
      if (v < settings_.min_speed)
        fault("guard.velocity is " + short_text(v) + ", so small that the robot hardly moves");
      if (v / a > settings_.max_ramp)
        fault("guard.acceleration is " + short_text(a) + ": the joint needs " + short_text(v / a) +
              " s to reach its velocity; give the maker's acceleration");
      if (a / j > settings_.max_ramp)
        fault("guard.jerk is " + short_text(j) + ": the joint needs " + short_text(a / j) +
              " s to reach its acceleration; give the maker's jerk");
    }
  }

  /// A mimic joint that leaves its own limits has the wrong sign or scale.
  void check_mimic_ranges() {
    constexpr double kSlack = 0.05;  // of the range of the mimic joint
    for (const Joint& joint : robot_.joints()) {
      if (!joint.is_mimic || joint.dof < 0 || joint.lower >= joint.upper) continue;
      const Axis& axis = robot_.axes()[static_cast<std::size_t>(joint.dof)];
      const auto range_with = [&](double factor) {
        const double at_lower = factor * axis.lower + joint.mimic_offset,
                     at_upper = factor * axis.upper + joint.mimic_offset;
        return std::pair(std::min(at_lower, at_upper), std::max(at_lower, at_upper));
      };
      const double slack = kSlack * (joint.upper - joint.lower);
      const auto inside = [&](double factor) {
        const auto [low, high] = range_with(factor);
        return low >= joint.lower - slack && high <= joint.upper + slack;
      };
      if (inside(joint.mimic_factor)) continue;
      const auto [low, high] = range_with(joint.mimic_factor);
      faults_.push_back("joint " + joint.name + " follows " + axis.name + " to " + short_text(low) +
                        " ... " + short_text(high) + ", outside its limits " +
                        short_text(joint.lower) + " ... " + short_text(joint.upper) +
                        (inside(-joint.mimic_factor)
                             ? ": the multiplier of its mimic has the wrong "
                               "sign"
                             : ": check multiplier and offset of its mimic"));
    }
  }

  /// The pads of a gripper move against each other, not in the same direction.
  void check_pads() {
    const RobotModel& model = hand_->model();
    const auto pads_at = [&](const Vector& q) {
      std::vector<Pose> T;
      model.forward(q, T);
      std::array<Pose, 2> pads;
      for (std::size_t f = 0; f < 2; ++f) {
        const Finger& finger = hand_->fingers()[f];
        pads[f] =
            T[static_cast<std::size_t>(model.link_index(finger.tip_link))] * finger.pad->T_tip_pad;
      }
      return pads;
    };
    for (int i = 0; i < model.dof(); ++i) {
      const bool both =
          std::all_of(hand_->fingers().begin(), hand_->fingers().end(), [&](const Finger& finger) {
            return std::find(finger.axes.begin(), finger.axes.end(), i) != finger.axes.end();
          });
      if (!both) continue;
      Vector low = (hand_->lower_contact() + hand_->upper_contact()) / 2, high = low;
      low[i] = hand_->lower_contact()[i];
      high[i] = hand_->upper_contact()[i];
      const auto a = pads_at(low), b = pads_at(high);
      const Vector3 normal = a[0].linear().col(2);
      const Vector3 first = b[0].translation() - a[0].translation(),
                    second = b[1].translation() - a[1].translation();
      const double drift = std::abs(normal.dot(first + second)) / 2,
                   closing = std::abs(normal.dot(first - second));
      if (drift <= settings_.max_drift * closing) continue;
      faults_.push_back("fingers " + hand_->fingers()[0].name + " and " + hand_->fingers()[1].name +
                        " move in the same direction when joint " +
                        model.axes()[static_cast<std::size_t>(i)].name +
                        " moves: the axis or the multiplier of a mimic joint has the wrong sign");
    }
  }

  /// The grasp frame is farther from the wrist than the tool link.
  void check_tool_frame() {
    constexpr double kMinOffset = 0.01;  // of the grasp frame in the tool link [m]
    const Group* arm = robot_.group("arm");
    if (arm == nullptr || arm->axes.size() < 2 || robot_.tool_link() < 0) return;
    const Vector3 offset = hand_->T_hand_grasp().translation();
    if (offset.norm() < kMinOffset) return;
    std::vector<Pose> T;
    robot_.forward(robot_.rest_configuration(), T);
    const auto wrist = static_cast<std::size_t>(joint_of(arm->axes[arm->axes.size() - 2]).child);
    const Pose T_tool = T[static_cast<std::size_t>(robot_.tool_link())];
    const Vector3 p_wrist = T[wrist].translation();
    if ((T_tool * offset - p_wrist).norm() >= (T_tool.translation() - p_wrist).norm()) return;
    faults_.push_back("the tool frame points backwards: the grasp frame of hand " + hand_->name() +
                      " is nearer to the wrist than tool_link " +
                      robot_.links()[static_cast<std::size_t>(robot_.tool_link())].name +
                      "; turn the pose of `mount`, or correct grasp_frame");
  }

  void check_pairs() {
    const auto name = [&](int link) { return robot_.links()[static_cast<std::size_t>(link)].name; };
    for (const LinkPair& pair : sample_pairs(robot_, settings_.matrix, [](double) { return true; }))
      if (pair.kind == PairKind::always)
        faults_.push_back("links " + name(pair.a) + " and " + name(pair.b) +
                          " are tested against each other and touch in " +
                          short_text(std::round(100 * pair.touched)) +
                          " % of the configurations: disable the pair in the SRDF, or correct the "
                          "shapes");
  }

  const RobotModel& robot_;
  const HandModel* hand_;
  const SweepSettings& settings_;
  std::vector<std::string> faults_;
};

}  // namespace

std::vector<std::string> sweep_faults(const RobotModel& robot, const HandModel* hand,
                                      const SweepSettings& settings) {
  return Sweep(robot, hand, settings).faults();
}

}  // namespace handsel
