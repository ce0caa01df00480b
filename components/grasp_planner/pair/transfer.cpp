// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/pair/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/model/human/human_body.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kTiltStep = std::numbers::pi / 12;  // [rad]
constexpr int kTiltAxes = 4;                         // tilt axes tried

double promise_of(const TransferPartner& p) {
  return 0.6 * p.opposition / std::numbers::pi + 0.4 * p.quality;
}

// Returns rotations of the object about horizontal axes; the identity without tilt.
std::vector<Eigen::Matrix3d> tilted(double tilt) {
  if (tilt <= 0) return {Eigen::Matrix3d::Identity()};
  std::vector<Eigen::Matrix3d> out;
  for (int k = 0; k < kTiltAxes; ++k) {
    const double heading = 2 * std::numbers::pi * k / kTiltAxes;
    out.push_back(Eigen::AngleAxisd(tilt, Vector3(std::cos(heading), std::sin(heading), 0))
                      .toRotationMatrix());
  }
  return out;
}

}  // namespace

TransferTable::TransferTable(const HandSide& robot, const HandSide& human, const Graspable& object,
                             const TransferSettings& settings,
                             const std::function<bool()>& cancelled)
    : settings_(settings), partners_(robot.list->grasps.size()) {
  DoubleSettings pairs;
  pairs.max_of_each = settings.max_of_each;
  pairs.clearance = settings.clearance;
  pairs.palm_clearance = settings.palm_clearance;
  pairs.min_opposition = settings.min_opposition;
  pairs.passed = &object;
  pairs.taken = Taken::spread;
  pairs.p_object_middle = object.box().center();
  doubles_ = list_double_grasps(robot, human, pairs, cancelled);
  std::vector<std::vector<TransferPartner>> all(partners_.size());
  for (const DoubleGrasp& d : doubles_.grasps)
    all[d.first].push_back({d.second, human.list->grasps[d.second].grasp.id,
                            human.list->grasps[d.second].grasp.T_object_hand, d.opposition,
                            d.quality});
  doubles_.grasps = {};
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::stable_sort(all[i].begin(), all[i].end(),
                     [](const TransferPartner& a, const TransferPartner& b) {
                       return promise_of(a) > promise_of(b);
                     });
    if (all[i].size() > settings.pool) all[i].resize(settings.pool);
    for (const TransferPartner& p : all[i]) {
      if (partners_[i].size() >= settings.partners) break;
      const bool alike =
          std::any_of(partners_[i].begin(), partners_[i].end(), [&](const TransferPartner& o) {
            return Eigen::AngleAxisd(Eigen::Matrix3d(o.T_object_wrist.linear().transpose() *
                                                     p.T_object_wrist.linear()))
                       .angle() < settings.min_turn;
          });
      if (!alike) partners_[i].push_back(p);
    }
  }
}

const std::vector<TransferPartner>& TransferTable::partners(std::size_t robot_grasp) const {
  return partners_[robot_grasp];
}

double TransferTable::promise(std::size_t robot_grasp) const {
  return partners_[robot_grasp].empty() ? 0.0 : promise_of(partners_[robot_grasp].front());
}

TransferPlaces::TransferPlaces(const Person& person, const HumanArm& arm,
                               const Vector3& p_world_robot, const Eigen::Matrix3d& R_world_object,
                               const Vector3& p_object_middle)
    : arm_(arm), R_world_object_(R_world_object), p_object_middle_(p_object_middle) {
  chest_ = person.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  to_robot_ = p_world_robot - chest_;
  to_robot_.z() = 0;
  to_robot_ = to_robot_.norm() > 1e-3 ? Vector3(to_robot_.normalized()) : Vector3(Vector3::UnitX());
  // Places before the person within reach of a bent arm: from the middle of the chest to the
  // shoulder, at heights from elbow to chest.
  const Vector3 across = Vector3::UnitZ().cross(to_robot_);
  const double side = across.dot(arm.outward) >= 0 ? 1.0 : -1.0;
  for (const double ahead : {0.62, 0.54, 0.7}) {
    for (const double aside : {0.1, 0.0, 0.2}) {
      for (const double below : {0.25, 0.15, 0.35}) {
        Vector3 p = chest_ + ahead * to_robot_ + side * aside * across;
        p.z() = arm.shoulder.z() - below;
        places_.push_back(p);
      }
    }
  }
}

std::vector<double> tilt_levels(const TransferSettings& s) {
  std::vector<double> out{0.0};
  while (out.back() + kTiltStep < s.max_tilt + 1e-3) out.push_back(out.back() + kTiltStep);
  return out;
}

/// Sorts the best pose of each rotation first: where the robot does not reach one, it seldom
/// reaches its neighbours. Poses of one rotation are adjacent in `found`.
static std::vector<TransferPose> best_of_turns_first(std::vector<TransferPose> found) {
  const auto better = [](const TransferPose& x, const TransferPose& y) {
    return x.score > y.score;
  };
  std::vector<TransferPose> ordered, again;
  for (auto begin = found.begin(); begin != found.end();) {
    const auto end = std::find_if(begin, found.end(), [&](const TransferPose& p) {
      return !p.T_world_object.linear().isApprox(begin->T_world_object.linear(), 1e-9);
    });
    std::stable_sort(begin, end, better);
    ordered.push_back(std::move(*begin));
    std::move(begin + 1, end, std::back_inserter(again));
    begin = end;
  }
  std::stable_sort(ordered.begin(), ordered.end(), better);
  std::stable_sort(again.begin(), again.end(), better);
  std::move(again.begin(), again.end(), std::back_inserter(ordered));
  return ordered;
}

std::optional<TransferPose> TransferPlaces::best(
    const TransferTable& table, std::size_t robot_grasp, const Pose& T_object_hand, double tilt,
    const std::function<std::optional<Vector>(const Pose& T_world_object,
                                              const Pose& T_world_hand)>& reach,
    int max_reaches) const {
  const TransferSettings& s = table.settings();
  const double min_cosine = std::cos(s.max_aim);
  struct Held {
    Eigen::Matrix3d R;
    const TransferPartner* partner;
  };
  // Returns the pose, without arm joints, if the partner's hand at the place is feasible.
  const auto evaluate = [&](const Held& held, const Vector3& place,
                            double max_strain) -> std::optional<TransferPose> {
    Vector3 heading = place - chest_;
    heading.z() = 0;
    const double cosine =
        (held.R * held.partner->T_object_wrist.linear().col(2)).dot(heading.normalized());
    if (cosine < min_cosine) return std::nullopt;
    TransferPose pose;
    pose.T_world_object.linear() = held.R;
    pose.T_world_object.translation() = place - held.R * p_object_middle_;
    const auto wrist = wrist_posture(arm_, pose.T_world_object * held.partner->T_object_wrist);
    if (!wrist || wrist->strain > max_strain) return std::nullopt;
    pose.partner = *held.partner;
    pose.wrist = *wrist;
    pose.aim = std::acos(std::min(1.0, cosine));
    pose.tilt = tilt;
    pose.score = 0.4 * (held.partner->opposition - s.min_opposition) /
                     (std::numbers::pi - s.min_opposition) +
                 0.4 * (1 - wrist->strain / s.max_strain) + 0.2 * (1 - pose.aim / s.max_aim) -
                 0.3 * tilt;
    return pose;
  };
  std::vector<TransferPose> found;
  std::vector<Eigen::Matrix3d> turns;
  for (const Eigen::Matrix3d& R_tilt : tilted(tilt)) {
    for (int k = 0; k < s.headings; ++k)
      turns.push_back(Eigen::AngleAxisd(2 * std::numbers::pi * k / s.headings, Vector3::UnitZ()) *
                      R_tilt * R_world_object_);
  }
  for (const Eigen::Matrix3d& R : turns) {
    std::vector<Held> likely;  // partners feasible at the first place
    for (const TransferPartner& partner : table.partners(robot_grasp)) {
      if (evaluate({R, &partner}, places_.front(), 1.3 * s.max_strain))
        likely.push_back({R, &partner});
    }
    for (const Vector3& place : places_) {
      std::optional<TransferPose> at_place;
      for (const Held& held : likely) {
        auto pose = evaluate(held, place, s.max_strain);
        if (pose && (!at_place || pose->score > at_place->score)) at_place = std::move(pose);
      }
      if (at_place) found.push_back(std::move(*at_place));
    }
  }
  std::vector<TransferPose> ordered = best_of_turns_first(std::move(found));
  for (std::size_t i = 0; i < ordered.size() && max_reaches > 0; ++i, --max_reaches) {
    auto q = reach(ordered[i].T_world_object, ordered[i].T_world_object * T_object_hand);
    if (!q) continue;
    ordered[i].arm_joints = std::move(*q);
    return ordered[i];
  }
  return std::nullopt;
}

}  // namespace handsel::grasp_planner
