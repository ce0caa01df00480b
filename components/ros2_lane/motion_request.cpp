// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/motion_request.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace handsel::ros2_lane {
namespace {

constexpr double kSame = 1e-6;  // max distance of two points that count as one [rad]
constexpr std::size_t kMaxStates = 4096;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

/// Returns the index in the arm's group of each named joint.
std::string find_joints(const ros2::JointTrajectory& wanted, const RobotModel& robot,
                        const Group& arm, std::vector<std::size_t>& place) {
  for (const std::string& name : wanted.joint_names) {
    const auto at = std::find_if(arm.axes.begin(), arm.axes.end(), [&](int axis) {
      return robot.axes()[static_cast<std::size_t>(axis)].name == name;
    });
    if (at == arm.axes.end()) return "joint " + name + " is no joint of the arm of " + robot.name();
    const auto index = static_cast<std::size_t>(at - arm.axes.begin());
    if (std::find(place.begin(), place.end(), index) != place.end())
      return "joint " + name + " is named twice";
    place.push_back(index);
  }
  if (place.empty()) return "it names no joints";
  return {};
}

/// Fills the path of `request`, which begins at its start.
std::string fill_path(const ros2::JointTrajectory& wanted, const RobotModel& robot,
                      const std::vector<std::size_t>& place, double start_tolerance,
                      TrajectoryRequest& request) {
  const Group& arm = robot.require_group("arm");
  const Vector here = RobotModel::part(request.start, arm);
  request.nodes = {here};
  for (std::size_t p = 0; p < wanted.points.size(); ++p) {
    Vector waypoint = here;
    for (std::size_t j = 0; j < place.size(); ++j) {
      const Axis& axis = robot.axes()[static_cast<std::size_t>(arm.axes[place[j]])];
      const double value = wanted.points[p].positions[static_cast<Eigen::Index>(j)];
      if (value < axis.lower || value > axis.upper)
        return "point " + std::to_string(p) + " has " + axis.name + " at " + number(value) +
               ", outside " + number(axis.lower) + " to " + number(axis.upper);
      waypoint[static_cast<Eigen::Index>(place[j])] = value;
    }
    const double off = (waypoint - here).cwiseAbs().maxCoeff();
    if (p == 0 && wanted.points[0].time_from_start == 0) {
      if (off > start_tolerance)
        return "its first point, at time 0, is " + number(off) + " rad from where the arm is";
      continue;
    }
    if ((waypoint - request.nodes.back()).cwiseAbs().maxCoeff() > kSame)
      request.nodes.push_back(std::move(waypoint));
  }
  if (request.nodes.size() < 2) return "it ends where the arm is";
  return {};
}

/// Fills `query` with the configurations along the path of `request`, at most `step` [rad] apart.
std::string fill_query(const TrajectoryRequest& request, const Group& arm, double step,
                       StateQuery& query) {
  query.attachment = request.attachment;
  query.allowed_contacts = request.allowed_contacts;
  for (std::size_t n = 1; n < request.nodes.size(); ++n) {
    const Vector move = request.nodes[n] - request.nodes[n - 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(move.cwiseAbs().maxCoeff() / step)));
    for (int i = 1; i <= parts; ++i)
      query.states.push_back(
          RobotModel::with(request.start, arm,
                           Vector(request.nodes[n - 1] + static_cast<double>(i) / parts * move)));
    if (query.states.size() > kMaxStates) return "it is too long to be checked at once";
  }
  return {};
}

}  // namespace

std::string make_motion_request(const ros2::JointTrajectory& wanted, const RobotModel& robot,
                                const ActiveTrajectory& active,
                                const settings::Ros2LaneSettings& settings, MotionRequest& out) {
  const Group& arm = robot.require_group("arm");
  std::vector<std::size_t> place;
  if (std::string why = find_joints(wanted, robot, arm, place); !why.empty()) return why;
  out = {};
  out.request.group = arm.name;
  out.request.start = active.position;
  out.request.attachment = active.attachment;
  if (!out.request.attachment.object.empty())
    out.request.allowed_contacts = {out.request.attachment.object};
  if (std::string why = fill_path(wanted, robot, place, settings.start_tolerance, out.request);
      !why.empty())
    return why;
  out.min_duration = wanted.points.back().time_from_start;
  return fill_query(out.request, arm, settings.check_step, out.query);
}

}  // namespace handsel::ros2_lane
