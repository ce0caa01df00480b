// The bound on how far what is held may lean over.
#pragma once

#include "common/model/robot_model.hpp"
#include "components/path_planner/problem.hpp"
#include "components/path_planner/search/planned_axes.hpp"

namespace handsel::path_planner {

/// Checks and restores the upright axis of a problem; every state is upright where nothing asks for
/// it.
class UprightBound {
 public:
  /// `lower`, `upper`: limits of the planned axes [rad, m]. Robot and problem must outlive this.
  UprightBound(const RobotModel& robot, const Problem& problem, Vector lower, Vector upper);

  /// Returns how far what is held leans over [rad]; 0 where nothing asks for it to be upright.
  double tilt(const Vector& q) const;
  /// Returns whether tilt() is within the bound.
  bool holds(const Vector& q) const {
    return !problem_.upright || tilt(q) <= problem_.upright->max_angle;
  }
  /// Returns whether the whole straight line is upright. Its ends may be on the bound, what is
  /// between is sampled every few hundredths of a radian.
  bool holds_on_line(const Vector& from, const Vector& to) const;
  /// Returns a state near by that is upright and inside the limits; where none is found, one that
  /// is not upright.
  Vector restore(Vector q) const;
  /// Returns the end of a motion toward a target, at most `range` far [rad]; where an upright
  /// configuration is asked for a short motion, bent back to it. `from` itself when there is none.
  Vector toward(const Vector& from, const Vector& target, double range) const;

 private:
  const RobotModel& robot_;
  const Problem& problem_;
  PlannedAxes axes_;
  Vector lower_, upper_;
  int tool_;
};

}  // namespace handsel::path_planner
