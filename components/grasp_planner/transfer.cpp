#include "components/grasp_planner/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/model/human_body.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kDifferent = 0.5;    // [rad] between two partners' hands
constexpr std::size_t kPlaced = 120;  // best double grasps of one robot grasp that partners are picked from

double promise_of(const TransferPartner& p) { return 0.6 * p.opposition / std::numbers::pi + 0.4 * p.quality; }

}  // namespace

TransferTable::TransferTable(const HandSide& robot, const HandSide& human, const Graspable& object, const TransferSettings& settings)
    : settings_(settings), partners_(robot.list->grasps.size()) {
  DoubleSettings pairs;
  pairs.most_of_each = settings.most_of_each;
  pairs.clearance = settings.clearance;
  pairs.least_opposition = settings.least_opposition;
  pairs.passed = &object;
  doubles_ = list_double_grasps(robot, human, pairs);
  std::vector<std::vector<TransferPartner>> all(partners_.size());
  for (const DoubleGrasp& d : doubles_.grasps)
    all[d.first].push_back({d.second, human.list->grasps[d.second].grasp.T_object_hand, d.opposition, d.quality});
  doubles_.grasps = {};
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::stable_sort(all[i].begin(), all[i].end(),
                     [](const TransferPartner& a, const TransferPartner& b) { return promise_of(a) > promise_of(b); });
    if (all[i].size() > kPlaced) all[i].resize(kPlaced);
    for (const TransferPartner& p : all[i]) {
      if (partners_[i].size() >= settings.partners) break;
      const bool alike = std::any_of(partners_[i].begin(), partners_[i].end(), [&](const TransferPartner& o) {
        return Eigen::AngleAxisd(Eigen::Matrix3d(o.T_object_wrist.linear().transpose() * p.T_object_wrist.linear())).angle() < kDifferent;
      });
      if (!alike) partners_[i].push_back(p);
    }
  }
}

const std::vector<TransferPartner>& TransferTable::partners(std::size_t robot_grasp) const { return partners_[robot_grasp]; }

double TransferTable::promise(std::size_t robot_grasp) const {
  return partners_[robot_grasp].empty() ? 0.0 : promise_of(partners_[robot_grasp].front());
}

TransferPlaces::TransferPlaces(const Person& person, const HumanArm& arm, const Vector3& p_world_robot,
                               const Eigen::Matrix3d& R_world_object, const Vector3& p_object_middle)
    : arm_(arm), R_world_object_(R_world_object), p_object_middle_(p_object_middle) {
  chest_ = person.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  to_robot_ = p_world_robot - chest_;
  to_robot_.z() = 0;
  to_robot_ = to_robot_.norm() > 1e-3 ? Vector3(to_robot_.normalized()) : Vector3(Vector3::UnitX());
  // Before the person, the arm bent: from the middle of the chest out to the shoulder, elbow to chest high.
  const Vector3 across = Vector3::UnitZ().cross(to_robot_);
  const double side = across.dot(arm.outward) >= 0 ? 1.0 : -1.0;
  for (const double ahead : {0.54, 0.62, 0.7}) {
    for (const double aside : {0.1, 0.0, 0.2}) {
      for (const double below : {0.2, 0.3}) {
        Vector3 p = chest_ + ahead * to_robot_ + side * aside * across;
        p.z() = arm.shoulder.z() - below;
        places_.push_back(p);
      }
    }
  }
}

std::optional<TransferPose> TransferPlaces::best(
    const TransferTable& table, std::size_t robot_grasp, const Pose& T_object_hand,
    const std::function<std::optional<Vector>(const Pose& T_world_object, const Pose& T_world_hand)>& reach, int most_reaches) const {
  const TransferSettings& s = table.settings();
  const double least_cosine = std::cos(s.most_aim);
  std::vector<TransferPose> found;
  for (int k = 0; k < s.headings; ++k) {
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(2 * std::numbers::pi * k / s.headings, Vector3::UnitZ()).toRotationMatrix() * R_world_object_;
    for (const TransferPartner& partner : table.partners(robot_grasp)) {
      const Vector3 hand = R * partner.T_object_wrist.linear().col(2);
      for (const Vector3& place : places_) {
        Vector3 way = place - chest_;
        way.z() = 0;
        const double cosine = hand.dot(way.normalized());
        if (cosine < least_cosine) continue;
        Pose T_world_object = Pose::Identity();
        T_world_object.linear() = R;
        T_world_object.translation() = place - R * p_object_middle_;
        const auto wrist = wrist_posture(arm_, T_world_object * partner.T_object_wrist);
        if (!wrist || wrist->strain > s.most_strain) continue;
        TransferPose pose{T_world_object, {}, partner, *wrist, std::acos(std::min(1.0, cosine))};
        pose.score = 0.4 * (partner.opposition - s.least_opposition) / (std::numbers::pi - s.least_opposition) +
                     0.4 * (1 - wrist->strain / s.most_strain) + 0.2 * (1 - pose.aim / s.most_aim);
        found.push_back(std::move(pose));
      }
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const TransferPose& a, const TransferPose& b) { return a.score > b.score; });
  for (std::size_t i = 0; i < found.size() && most_reaches > 0; ++i, --most_reaches) {
    auto q = reach(found[i].T_world_object, found[i].T_world_object * T_object_hand);
    if (!q) continue;
    found[i].arm_joints = std::move(*q);
    return found[i];
  }
  return std::nullopt;
}

}  // namespace handsel::grasp_planner
