// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/pair/carried_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/model/srs_arm.hpp"

namespace handsel::grasp_planner {

std::vector<Pose> path_of_object(const std::vector<Pose>& corners, double step) {
  std::vector<Pose> out(corners.begin(), corners.begin() + (corners.empty() ? 0 : 1));
  for (std::size_t k = 1; k < corners.size(); ++k) {
    const Pose &a = corners[k - 1], &b = corners[k];
    const Eigen::Quaterniond from(a.linear()), to(b.linear());
    const double far =
        std::max((b.translation() - a.translation()).norm(), from.angularDistance(to) / 5);
    const int parts = std::max(1, static_cast<int>(std::ceil(far / step)));
    for (int i = 1; i <= parts; ++i) {
      const double share = static_cast<double>(i) / parts;
      out.push_back(make_pose(a.translation() + share * (b.translation() - a.translation()),
                              from.slerp(share, to)));
    }
  }
  return out;
}

std::vector<CarriedMotion> carried_motions(const RobotModel& robot, const Group& arm,
                                           const Vector& q, const std::vector<Pose>& T_root_tip,
                                           const CarriedSettings& settings) {
  std::vector<CarriedMotion> out;
  const ik::Chain chain(robot, arm, q);
  const std::optional<ik::SrsArm> srs = ik::SrsArm::recognise(chain);
  if (!srs || T_root_tip.empty()) return out;
  const ik::Axes middle = 0.5 * (chain.lower() + chain.upper());
  const auto room_of = [&](const ik::Axes& at) {
    return std::min((at - chain.lower()).minCoeff(), (chain.upper() - at).minCoeff());
  };
  for (int e = 0; e < settings.elbows; ++e) {
    const double elbow = 2 * std::numbers::pi * e / settings.elbows;
    for (const ik::Axes& branch : srs->branches(T_root_tip.front(), elbow)) {
      std::optional<ik::Axes> at = srs->turned_inside(branch, middle);
      CarriedMotion way;
      way.room = at ? room_of(*at) : 0;
      if (at) way.joints.emplace_back(*at);
      for (std::size_t k = 1; at && way.room >= settings.min_room && k < T_root_tip.size(); ++k) {
        const std::optional<ik::Axes> next = srs->nearest(T_root_tip[k], elbow, *at);
        const bool follows =
            next && (*next - *at).lpNorm<Eigen::Infinity>() <= settings.largest_step;
        at = follows ? next : std::nullopt;
        if (!at) break;
        way.room = std::min(way.room, room_of(*at));
        way.joints.emplace_back(*at);
      }
      if (at && way.room >= settings.min_room) out.push_back(std::move(way));
    }
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const CarriedMotion& a, const CarriedMotion& b) { return a.room > b.room; });
  return out;
}

}  // namespace handsel::grasp_planner
