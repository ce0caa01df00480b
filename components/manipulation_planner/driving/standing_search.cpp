// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/driving/standing_search.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/arm_reach.hpp"
#include "common/model/platform.hpp"

namespace handsel::manipulation_planner {
namespace {

double heading_of(const Pose& T) { return std::atan2(T.linear()(1, 0), T.linear()(0, 0)); }

/// Level angle between two vectors [rad].
double level_angle(const Vector3& a, const Vector3& b) {
  return std::abs(std::remainder(std::atan2(a.y(), a.x()) - std::atan2(b.y(), b.x()), 2 * M_PI));
}

/// Returns the places from which the arm reaches a point, those before a person only.
void add_candidates(const StandingQuery& query, const Vector3& point,
                    const std::optional<Vector3>& front, const Pose& T_world_platform,
                    const settings::ManipulationPlannerSettings& settings,
                    std::vector<StandingPlace>& out) {
  const Pose T_root_world = query.T_world_root.inverse();
  const double heading_now = heading_of(T_root_world * T_world_platform);
  const ArmReach reach = arm_reach(query.robot, &query.arm, query.arm.tip);
  const Vector3 p_platform_shoulder = T_world_platform.inverse() * query.T_world_root *
                                      query.robot.link_pose(query.q, reach.shoulder).translation();
  for (const PlatformPlace& place :
       places_around(query.robot, query.arm, query.q, T_world_platform, point)) {
    StandingPlace one;
    one.T_world_platform = standing_at(place, T_world_platform);
    const Vector3 p_shoulder = one.T_world_platform * p_platform_shoulder;
    if ((point - p_shoulder).norm() > settings.standing_reach * reach.length) continue;
    const Vector3 to_target = point - one.T_world_platform.translation();
    if (front && level_angle(-to_target, *front) > settings.standing_bearing) continue;
    const Pose T_root_platform = T_root_world * one.T_world_platform;
    const double heading = nearest_heading(heading_of(T_root_platform), heading_now);
    one.place = {T_root_platform.translation().x(), T_root_platform.translation().y(), heading};
    const double turned = level_angle(to_target, one.T_world_platform.linear().col(0));
    one.cost = settings.w_drive * place.distance + settings.w_standing_turn * turned +
               settings.w_standing_people * query.people(one.place.x(), one.place.y(), heading);
    out.push_back(std::move(one));
  }
}

}  // namespace

StandingSearch find_standing_places(const StandingQuery& query, const StandingTarget& target,
                                    PlatformFloor& floor,
                                    const settings::ManipulationPlannerSettings& settings,
                                    const ServesFrom& serves) {
  const Pose T_world_platform = handsel::T_world_platform(query.robot, query.q, query.T_world_root);
  std::vector<StandingPlace> candidates;
  for (const Vector3& point : target.points)
    add_candidates(query, point, target.front, T_world_platform, settings, candidates);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const StandingPlace& a, const StandingPlace& b) { return a.cost < b.cost; });
  StandingSearch out;
  std::size_t blocked = 0, near_person = 0, useless = 0, checks = 0;
  for (StandingPlace& candidate : candidates) {
    if (out.places.size() >= settings.standing_places || checks >= settings.standing_checks) break;
    const bool known =
        std::any_of(out.places.begin(), out.places.end(), [&](const StandingPlace& other) {
          return (other.place - candidate.place).head<2>().norm() < settings.standing_spacing;
        });
    if (known) continue;
    const PlatformFloor::Verdict verdict = floor.check(query.q, candidate.T_world_platform);
    blocked += verdict == PlatformFloor::Verdict::blocked;
    near_person += verdict == PlatformFloor::Verdict::near_person;
    if (verdict != PlatformFloor::Verdict::free) continue;
    checks += serves != nullptr;
    if (serves && !serves(candidate))
      ++useless;
    else
      out.places.push_back(std::move(candidate));
  }
  const auto refuse = [&](std::size_t count, const char* why) {
    if (count > 0) out.refusals.push_back({std::to_string(count) + " places", why});
  };
  refuse(blocked, "the robot would collide there");
  refuse(near_person, "too near to a person");
  refuse(useless, "from there no pose of what is held can be reached in which the person takes it");
  if (candidates.empty())
    out.refusals.push_back(
        {"all places", target.front ? "the arm reaches nothing from before the person"
                                    : "nothing to reach is at a height that the arm reaches"});
  return out;
}

}  // namespace handsel::manipulation_planner
