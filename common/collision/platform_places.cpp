// SPDX-License-Identifier: Apache-2.0
#include "common/collision/platform_places.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/model/platform.hpp"

namespace handsel {
namespace {

constexpr double kDistances[] = {0.6, 0.75, 0.45, 0.9};  // ratio to the arm's length
constexpr int kDirections = 16, kHeadings = 12;

double heading_of(const Pose& T) { return std::atan2(T.linear()(1, 0), T.linear()(0, 0)); }

}  // namespace

std::vector<PlatformPlace> places_around(const RobotModel& robot, const Group& arm, const Vector& q,
                                         const Pose& T_world_platform,
                                         const Vector3& p_world_object) {
  std::vector<Pose> T_platform_link;
  robot.forward(q, T_platform_link);
  const Pose T_platform_root = handsel::T_world_platform(robot, q, Pose::Identity()).inverse();
  for (Pose& T : T_platform_link) T = T_platform_root * T;
  std::vector<Vector3> chain;
  for (const int axis : arm.axes) {
    const Joint& joint =
        robot
            .joints()[static_cast<std::size_t>(robot.axes()[static_cast<std::size_t>(axis)].joint)];
    chain.push_back(T_platform_link[static_cast<std::size_t>(joint.child)].translation());
  }
  chain.push_back(T_platform_link[static_cast<std::size_t>(arm.tip)].translation());
  double length = 0;
  for (std::size_t i = 1; i < chain.size(); ++i) length += (chain[i] - chain[i - 1]).norm();
  const double rise = p_world_object.z() - (T_world_platform * chain.front()).z();
  std::vector<PlatformPlace> out;
  if (std::abs(rise) >= length) return out;
  const double level = std::sqrt(length * length - rise * rise),
               heading_now = heading_of(T_world_platform);
  for (const double ratio : kDistances) {
    for (int d = 0; d < kDirections; ++d) {
      const double direction = 2 * std::numbers::pi * d / kDirections;
      const Eigen::Vector2d shoulder =
          p_world_object.head<2>() -
          ratio * level * Eigen::Vector2d(std::cos(direction), std::sin(direction));
      for (int h = 0; h < kHeadings; ++h) {
        const double heading =
            nearest_heading(direction + 2 * std::numbers::pi * h / kHeadings, heading_now);
        const Eigen::Vector2d at = shoulder - Eigen::Rotation2Dd(heading) * chain.front().head<2>();
        const double distance = (at - T_world_platform.translation().head<2>()).norm() +
                                kTurnDistance * std::abs(heading - heading_now);
        out.push_back({{at.x(), at.y(), heading}, distance});
      }
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const PlatformPlace& a, const PlatformPlace& b) {
    return a.distance < b.distance;
  });
  return out;
}

Pose standing_at(const PlatformPlace& place, const Pose& T_world_platform) {
  return make_pose({place.pose.x(), place.pose.y(), T_world_platform.translation().z()},
                   Eigen::Quaterniond(Eigen::AngleAxisd(place.pose.z(), Vector3::UnitZ())));
}

PlatformFloor::PlatformFloor(const RobotModel& mobile, ObjectLibrary library, const Scene& scene,
                             const HumanState& people, const PlatformRoom& room)
    : mobile_(mobile),
      world_(mobile, std::move(library)),
      room_to_people_(room.people),
      anybody_(!people.people.empty()) {
  Scene seen_from_world = scene;
  seen_from_world.T_world_base = Pose::Identity();
  for (SceneBox& box : seen_from_world.boxes)
    box.size.head<2>() += Eigen::Vector2d::Constant(2 * room.furniture);
  world_.set_base(Pose::Identity());
  world_.set_scene(seen_from_world);
  world_.set_people(people);
}

PlatformFloor::Verdict PlatformFloor::check(const Vector& q, const Pose& T_world_platform) {
  const Vector3& p = T_world_platform.translation();
  const Vector whole =
      q.size() == mobile_.dof()
          ? with_platform_at(mobile_, q, {p.x(), p.y(), heading_of(T_world_platform)})
          : with_platform(q, T_world_platform);
  if (!world_.is_free(whole)) return Verdict::blocked;
  return anybody_ && world_.distance_to_people(whole) < room_to_people_ ? Verdict::near_person
                                                                        : Verdict::free;
}

}  // namespace handsel
