// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/driving.hpp"

#include <algorithm>
#include <cmath>

#include "components/path_planner/search/random.hpp"

namespace handsel::path_planner {

bool is_of_platform(const std::string& group) {
  return group == kPlatformGroup || group == kWholeRobotGroup;
}

void drive(const RobotModel& mobile, const NavigationCost& cost, double roam, Problem& problem) {
  const std::vector<int>& platform = mobile.require_group(kPlatformGroup).axes;
  problem.platform_motion = PlatformMotion{{platform[0], platform[1], platform[2]}, &cost};
  if (problem.start.size() != mobile.dof()) return;
  const auto n = static_cast<Eigen::Index>(problem.axes.size());
  Vector lower(n), upper(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const int axis = problem.axes[static_cast<std::size_t>(i)];
    double low = problem.start[axis], high = low;
    const bool heading = axis == platform[2], place = axis == platform[0] || axis == platform[1];
    for (Vector& goal : problem.goals) {
      if (goal.size() != n) return;
      if (heading) goal[i] = nearest_heading(goal[i], problem.start[axis]);
      low = std::min(low, goal[i]);
      high = std::max(high, goal[i]);
    }
    const Axis& of = mobile.axes()[static_cast<std::size_t>(axis)];
    lower[i] = place ? low - roam : heading ? low - M_PI : of.lower;
    upper[i] = place ? high + roam : heading ? high + M_PI : of.upper;
  }
  problem.room = {lower, upper};
}

void keep_clear_of_furniture(CollisionWorld& world, const Scene& scene, const FurnitureRoom& room,
                             const std::vector<Vector>& ends) {
  Scene wider = scene;
  Scene one_box = scene;
  one_box.objects.clear();
  for (SceneBox& box : wider.boxes) {
    one_box.boxes = {box};
    world.set_scene(one_box);
    double clearance = room.room;
    for (const Vector& q : ends)
      clearance =
          std::min(clearance, room.fraction_at_ends * world.distance_to_scene(q, room.room));
    box.size.head<2>() += Eigen::Vector2d::Constant(2 * clearance);
  }
  world.set_scene(wider);
}

PoseGoals reach_with_platform(const RobotModel& mobile, CollisionWorld& world,
                              const std::vector<PoseGoal>& poses, const Vector& q_start,
                              std::uint64_t seed, const PlatformSampling& sampling) {
  PoseGoals found;
  Random random(seed);
  const Group& whole = mobile.require_group(kWholeRobotGroup);
  const std::vector<int>& platform = mobile.require_group(kPlatformGroup).axes;
  const Group* arm = mobile.group("arm");
  const Eigen::Vector2d here(q_start[platform[0]], q_start[platform[1]]);
  for (std::size_t i = 0; i < poses.size() && arm != nullptr; ++i) {
    struct Place {
      double x, y, heading, far;
    };
    std::vector<Place> places = {{here.x(), here.y(), q_start[platform[2]], -1}};
    for (int k = 0; k < sampling.tries; ++k) {
      const double bearing = random.between(-M_PI, M_PI),
                   range = sampling.max_distance * std::sqrt(random.unit());
      const Eigen::Vector2d at = poses[i].T_root_tip.translation().head<2>() +
                                 range * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
      const double heading = nearest_heading(random.between(-M_PI, M_PI), q_start[platform[2]]);
      places.push_back(
          {at.x(), at.y(), heading, (at - here).norm() + std::abs(heading - q_start[platform[2]])});
    }
    std::sort(places.begin(), places.end(),
              [](const Place& a, const Place& b) { return a.far < b.far; });
    int configurations = 0;
    for (std::size_t k = 0; k < places.size() && configurations < sampling.each; ++k) {
      Vector q = q_start;
      q[platform[0]] = places[k].x;
      q[platform[1]] = places[k].y;
      q[platform[2]] = places[k].heading;
      const PoseGoals here_reached = reach(mobile, *arm, {poses[i]}, q, random.bits(), 1);
      if (here_reached.goals.empty()) continue;
      q = RobotModel::with(q, *arm, here_reached.goals.front());
      if (!world.is_free(q)) continue;
      found.goals.push_back(RobotModel::part(q, whole));
      found.pose.push_back(i);
      ++configurations;
    }
  }
  if (found.goals.empty())
    found.reason =
        poses.empty()
            ? "no goal was given"
            : "no place of the platform was found from which the arm reaches the goal freely";
  return found;
}

}  // namespace handsel::path_planner
