// SPDX-License-Identifier: Apache-2.0
// The bound on the tilt of the held object.
#pragma once

#include "common/model/robot_model.hpp"
#include "components/path_planner/problem.hpp"
#include "components/path_planner/search/planned_axes.hpp"

namespace handsel::path_planner {

/// Checks and restores the upright axis of a problem; without such a bound every state is upright.
class UprightBound {
 public:
  /// `lower`, `upper`: limits of the planned axes [rad, m]. Robot and problem must outlive this.
  UprightBound(const RobotModel& robot, const Problem& problem, Vector lower, Vector upper);

  /// Returns the tilt of the held object [rad]; 0 without a bound.
  double tilt(const Vector& q) const;
  /// Returns whether tilt() is within the bound.
  bool holds(const Vector& q) const {
    return !problem_.upright || tilt(q) <= problem_.upright->max_angle;
  }
  /// Returns whether the straight line is upright, checked at samples every 0.03 rad; only the ends
  /// may be on the bound.
  bool holds_on_line(const Vector& from, const Vector& to) const;
  /// Returns a nearby upright state within the limits; if none is found, a state that is not
  /// upright.
  Vector restore(Vector q) const;
  /// Returns the end of a motion toward a target of at most `range` [rad]; with a bound a short
  /// motion, corrected to an upright state. Returns `from` if there is none.
  Vector toward(const Vector& from, const Vector& target, double range) const;

 private:
  const RobotModel& robot_;
  const Problem& problem_;
  PlannedAxes axes_;
  Vector lower_, upper_;
  int tool_;
};

}  // namespace handsel::path_planner
