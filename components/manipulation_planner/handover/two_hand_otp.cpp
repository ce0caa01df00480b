// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/two_hand_otp.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr int kMaxHeadingSteps = 2;  // turns of the object to either side, in steps of a heading

/// An offered pose and its cost.
struct OfferedPose {
  Pose T_world_object{Pose::Identity()};
  double cost{};
};

/// Why poses were left out.
struct LeftOut {
  int no_otp{}, in_furniture{}, out_of_reach{};
};

const Vector3& p_joint(const Person& person, const char* name) {
  return person.joints[static_cast<std::size_t>(body_joint_index(name))].position;
}

Vector3 level(const Vector3& v) { return {v.x(), v.y(), 0}; }

/// Returns the axis of the object along which the hands stand, half as long as the object; object
/// frame [m].
Vector3 long_half_axis(const Eigen::AlignedBox3d& extent) {
  const Vector3 half = 0.5 * extent.sizes();
  return half.x() >= half.y() ? Vector3(half.x(), 0, 0) : Vector3(0, half.y(), 0);
}

/// Returns the direction of the object that points away from the robot, across its long axis;
/// object frame, unit.
Vector3 forward_of(const TwoHandOtpQuery& query) {
  const Vector3 along = long_half_axis(query.extent).normalized();
  const Vector3 across = along.x() > 0 ? Vector3::UnitY() : Vector3::UnitX();
  const Vector3 away = level(query.T_world_object.translation() - query.p_robot).stableNormalized();
  return (query.T_world_object.linear() * across).dot(away) >= 0 ? across : Vector3(-across);
}

/// Returns whether a part of the object is in a box of the scene or nearer to it than `gap` [m].
bool is_in_furniture(const TwoHandOtpQuery& query, const Pose& T_world_object, double gap) {
  constexpr int kParts = 4;  // of each extent
  const Vector3 low = query.extent.min(), size = query.extent.sizes();
  for (int i = 0; i <= kParts; ++i)
    for (int j = 0; j <= kParts; ++j)
      for (int k = 0; k <= kParts; ++k) {
        const Vector3 p = T_world_object * (low + size.cwiseProduct(Vector3(i, j, k)) / kParts);
        for (const SceneBox& box : query.scene.boxes) {
          const Vector3 in_box = box.T_world_box.inverse() * p;
          if ((in_box.array().abs() <= box.size.array() / 2 + gap).all()) return true;
        }
      }
  return false;
}

/// Returns how far the arms stretch to the ends of the object, as a fraction of their reach, by the
/// better assignment of arms to ends.
double stretch_of(const TwoHandOtpQuery& query, const Pose& T_world_object) {
  const Vector3 centre = query.extent.center(), half = long_half_axis(query.extent);
  const Vector3 ends[] = {T_world_object * (centre - half), T_world_object * (centre + half)};
  const auto stretch = [&](const ArmPlace& arm, const Vector3& end) {
    return (end - arm.p_shoulder).norm() / arm.reach;
  };
  const ArmPlace &a = query.arms[0], &b = query.arms[1];
  return std::min(std::max(stretch(a, ends[0]), stretch(b, ends[1])),
                  std::max(stretch(a, ends[1]), stretch(b, ends[0])));
}

/// Evaluates poses of the object at one place before the person.
class TwoHandCosts {
 public:
  TwoHandCosts(const TwoHandOtpQuery& query, const settings::ManipulationPlannerSettings& settings)
      : query_(query), settings_(settings), forward_(forward_of(query)) {
    // The hands stand on the robot's side of the object.
    T_tool_object_.translation() = forward_;
  }
  /// Adds the poses at a place, the object turned toward the person and a little beside.
  void add_at(const Vector3& p_world, const Vector3& to_person, std::vector<OfferedPose>& poses,
              LeftOut& left_out) const {
    const OtpQuery otp{query_.scene,
                       query_.person,
                       query_.layers,
                       query_.T_world_object,
                       T_tool_object_,
                       nothing_barred_,
                       no_partners_,
                       {},
                       {},
                       query_.p_robot};
    const Vector3 now = level(query_.T_world_object.linear() * forward_);
    const double turn = std::atan2(now.cross(to_person).z(), now.dot(to_person));
    const double step = 2 * std::numbers::pi / settings_.otp_headings;
    for (int k = -kMaxHeadingSteps; k <= kMaxHeadingSteps; ++k) {
      Pose T = query_.T_world_object;
      T.linear() = Eigen::AngleAxisd(turn + k * step, Vector3::UnitZ()) * T.linear();
      T.translation() = p_world;
      const double stretch = stretch_of(query_, T);
      if (stretch > settings_.two_hand_max_stretch) {
        ++left_out.out_of_reach;
      } else if (is_in_furniture(query_, T, settings_.two_hand_furniture_gap)) {
        ++left_out.in_furniture;
      } else if (const auto cost = otp_cost(otp, T, settings_)) {
        poses.push_back({T, *cost + settings_.w_two_hand_stretch * stretch});
      } else {
        ++left_out.no_otp;
      }
    }
  }

 private:
  const TwoHandOtpQuery& query_;
  const settings::ManipulationPlannerSettings& settings_;
  Vector3 forward_;
  Pose T_tool_object_{Pose::Identity()};
  std::vector<Vector3> nothing_barred_;
  std::vector<PartnerGrasp> no_partners_;
};

}  // namespace

TwoHandOtp find_two_hand_otp(const TwoHandOtpQuery& query,
                             const settings::ManipulationPlannerSettings& settings) {
  TwoHandOtp out;
  const Vector3& p_torso = p_joint(query.person, "torso");
  const Vector3 to_robot = level(query.p_robot - p_torso);
  if (query.arms.size() != 2 || query.extent.isEmpty() || to_robot.norm() < 1e-3) {
    out.reason =
        "no exchange point for both hands: two arms, an object of known size and a person "
        "beside the robot are needed";
    return out;
  }
  const Vector3 toward_robot = to_robot.normalized();
  const Vector3 across(-toward_robot.y(), toward_robot.x(), 0);
  const double shoulder_z = p_joint(query.person, "r_shoulder").z();
  const TwoHandCosts costs(query, settings);
  std::vector<OfferedPose> poses;
  LeftOut left_out;
  const int ahead_steps = static_cast<int>(
      std::floor((settings.otp_max_ahead - settings.otp_min_ahead) / settings.otp_ahead_step));
  const int below_steps = static_cast<int>(
      std::floor((settings.otp_max_below - settings.otp_min_below) / settings.otp_below_step));
  const int aside_steps =
      static_cast<int>(std::floor(settings.otp_max_aside / settings.otp_aside_step));
  for (int i = 0; i <= ahead_steps; ++i)
    for (int j = -aside_steps; j <= aside_steps; ++j)
      for (int k = 0; k <= below_steps; ++k) {
        Vector3 p = p_torso +
                    (settings.otp_min_ahead + i * settings.otp_ahead_step) * toward_robot +
                    j * settings.otp_aside_step * across;
        p.z() = shoulder_z - settings.otp_min_below - k * settings.otp_below_step;
        costs.add_at(p, -toward_robot, poses, left_out);
      }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const OfferedPose& a, const OfferedPose& b) { return a.cost < b.cost; });
  for (const OfferedPose& pose : poses) {
    if (out.T_world_object.size() >= settings.two_hand_exchange_goals) break;
    const auto is_near = [&](const Pose& T) {
      return (T.translation() - pose.T_world_object.translation()).norm() <
             settings.two_hand_otp_apart;
    };
    if (std::none_of(out.T_world_object.begin(), out.T_world_object.end(), is_near))
      out.T_world_object.push_back(pose.T_world_object);
  }
  if (poses.empty())
    out.reason = "no exchange point for both hands with " + query.person.id + ": " +
                 std::to_string(left_out.out_of_reach) + " poses beyond the reach of both arms, " +
                 std::to_string(left_out.in_furniture) + " in or near furniture, " +
                 std::to_string(left_out.no_otp) + " beyond the reach of the person or forbidden";
  return out;
}

}  // namespace handsel::manipulation_planner
