// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/search/upright_bound.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::path_planner {
namespace {

constexpr double kTiltStep = 0.03;        // step of tilt checks, sum over the axes [rad]
constexpr double kTiltMargin = 5e-4;      // max increase of the tilt between two checks [rad]
constexpr double kMaxUprightRange = 0.2;  // max length of a corrected motion [rad]
constexpr double kMinProgress = 0.05;  // min progress of a corrected motion, divided by its length

}  // namespace

UprightBound::UprightBound(const RobotModel& robot, const Problem& problem, Vector lower,
                           Vector upper)
    : robot_(robot),
      problem_(problem),
      axes_(problem),
      lower_(std::move(lower)),
      upper_(std::move(upper)),
      tool_(problem.upright && problem.upright->link >= 0 ? problem.upright->link
            : robot.tool_link() >= 0                      ? robot.tool_link()
                                     : static_cast<int>(robot.links().size()) - 1) {}

double UprightBound::tilt(const Vector& q) const {
  if (!problem_.upright) return 0.0;
  const Vector3 axis =
      robot_.link_pose(axes_.whole(q), tool_).linear() * problem_.upright->axis_tool.normalized();
  return std::acos(std::clamp(axis.dot(problem_.upright->up_root.normalized()), -1.0, 1.0));
}

bool UprightBound::holds_on_line(const Vector& from, const Vector& to) const {
  if (!problem_.upright) return true;
  const int last =
      std::max(1, static_cast<int>(std::ceil((to - from).cwiseAbs().sum() / kTiltStep)));
  if (!holds(from) || !holds(to)) return false;
  for (int i = 1; i < last; ++i)
    if (tilt(from + (static_cast<double>(i) / last) * (to - from)) >
        problem_.upright->max_angle - kTiltMargin)
      return false;
  return true;
}

Vector UprightBound::restore(Vector q) const {
  if (!problem_.upright) return q;
  constexpr int kMaxRounds = 12;        // max iterations of the correction
  constexpr double kTarget = 0.9;       // target tilt divided by the bound
  constexpr double kDifference = 1e-5;  // step of the finite differences [rad]
  for (int round = 0; round < kMaxRounds; ++round) {
    const double now = tilt(q), over = now - kTarget * problem_.upright->max_angle;
    if (over <= 0) break;
    Vector slope(axes_.size());
    for (int i = 0; i < axes_.size(); ++i) {
      Vector moved = q;
      moved[i] += kDifference;
      slope[i] = (tilt(moved) - now) / kDifference;
    }
    if (slope.squaredNorm() < 1e-9) break;
    q = (q - slope * (over / slope.squaredNorm())).cwiseMax(lower_).cwiseMin(upper_);
  }
  return q;
}

Vector UprightBound::toward(const Vector& from, const Vector& target, double range) const {
  const double distance = (target - from).norm(),
               reach = problem_.upright ? std::min(range, kMaxUprightRange) : range;
  Vector end = distance > reach ? Vector(from + (target - from) * (reach / distance)) : target;
  if (!problem_.upright || holds_on_line(from, end)) return end;
  Vector bent = restore(end);
  const bool nearer = (target - bent).norm() < distance - kMinProgress * reach;
  if (!nearer || !holds_on_line(from, bent)) return from;
  return bent;
}

}  // namespace handsel::path_planner
