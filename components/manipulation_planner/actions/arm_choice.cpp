// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/actions/arm_choice.hpp"

#include <algorithm>

#include "common/model/arm_reach.hpp"
#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {

Vector3 nearest_on_top(const SceneBox& box, const Vector3& p_world) {
  const Vector3 half = 0.5 * box.size;
  Vector3 p = box.T_world_box.inverse() * p_world;
  p.x() = std::clamp(p.x(), -half.x(), half.x());
  p.y() = std::clamp(p.y(), -half.y(), half.y());
  p.z() = half.z();
  return box.T_world_box * p;
}

Routine<Outcome> use_arm(Parts& parts, const std::string& arm) {
  const auto& all = parts.arm.manipulators();
  const auto wanted = std::find_if(all.begin(), all.end(), [&](const Manipulator& m) {
    return m.name == arm && m.arm != nullptr;
  });
  if (wanted == all.end())
    co_return Outcome::failure("robot " + parts.arm.robot().name() + " has no arm \"" + arm + "\"");
  const auto index = static_cast<std::size_t>(wanted - all.begin());
  if (index == parts.arm.index()) co_return Outcome{};
  const bool is_idle = co_await parts.waiting.until([&parts] { return parts.worker.is_idle(); },
                                                    parts.settings.request_timeout);
  if (!is_idle) co_return Outcome::failure("a computation for the other arm does not end");
  parts.arm.select(index);
  parts.held.set_grasp(std::nullopt);
  co_return Outcome{};
}

namespace {

/// An arm and how far it must stretch.
struct Candidate {
  std::string arm;
  double stretch;  // distance over reach
};

/// Returns all arms with the distance that `distance_from` gives for their shoulder [m].
template <class Distance>
std::vector<Candidate> stretches(const Parts& parts, const Distance& distance_from) {
  std::vector<Candidate> all;
  const RobotModel& robot = parts.arm.robot();
  for (const Manipulator& m : parts.arm.manipulators()) {
    const ArmReach reach = arm_reach(robot, m.arm, m.palm);
    if (m.arm == nullptr || reach.shoulder < 0) continue;
    const Vector3 p_shoulder =
        (parts.now.T_world_base() * robot.link_pose(parts.now.set_point(), reach.shoulder))
            .translation();
    all.push_back({m.name, distance_from(p_shoulder) / reach.length});
  }
  return all;
}

}  // namespace

std::vector<std::string> arms_for(const Parts& parts, const Vector3& p_world,
                                  const SceneBox* surface) {
  std::vector<Candidate> all = stretches(parts, [&](const Vector3& p_shoulder) {
    const double distance = (p_world - p_shoulder).norm();
    if (surface == nullptr) return distance;
    return std::max(distance, (nearest_on_top(*surface, p_shoulder) - p_shoulder).norm());
  });
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.stretch < b.stretch; });
  const bool is_any_near = !all.empty() && all.front().stretch < 1;
  std::vector<std::string> out;
  for (const Candidate& one : all)
    if (one.stretch < 1 || !is_any_near) out.push_back(one.arm);
  return out;
}

}  // namespace handsel::manipulation_planner
