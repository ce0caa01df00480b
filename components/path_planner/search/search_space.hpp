// SPDX-License-Identifier: Apache-2.0
// The configuration space of one problem: checks and costs of states and motions, with a budget of
// checks.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "components/path_planner/search/budget.hpp"
#include "components/path_planner/search/path_cost.hpp"
#include "components/path_planner/search/planned_axes.hpp"
#include "components/path_planner/search/upright_bound.hpp"

namespace handsel::path_planner {

class SearchSpace : public Budget {
 public:
  /// Bounds of unlimited axes are start +- 2 pi.
  SearchSpace(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost,
              const Problem& problem, const Settings& settings, const Hooks& hooks);

  /// Returns the number of planned axes.
  int size() const { return axes_.size(); }
  /// Returns the lower bounds of the planned axes [rad, m].
  const Vector& lower() const { return bounds_.first; }
  /// Returns the upper bounds of the planned axes [rad, m].
  const Vector& upper() const { return bounds_.second; }
  /// Returns the problem that was given; must outlive the space.
  const Problem& problem() const { return problem_; }
  /// Returns the settings that were given; must outlive the space.
  const Settings& settings() const { return settings_; }
  /// Returns the start, planned axes only.
  Vector start() const { return axes_.part(problem_.start); }
  /// Returns the costs of states and motions.
  const PathCost& costs() const { return path_cost_; }
  /// Returns the bound on the tilt of the held object.
  const UprightBound& upright() const { return upright_; }

  /// Returns an empty text within the position limits, else axis, position and limits.
  std::string outside_limits(const Vector& q) const;
  /// Returns whether every planned axis is within its bounds, without tolerance.
  bool inside(const Vector& q) const;
  /// Checks a state exactly; the verdict names the contact or the forbidding cost layer. Does not
  /// check tilt and bounds.
  CollisionVerdict verdict(const Vector& q);
  /// Returns whether a state is upright if required, free of contact and not forbidden by a cost
  /// layer. Does not check bounds.
  bool free(const Vector& q);
  /// Checks the straight motion at states at most `step` [rad, max norm] apart, like verdict().
  /// Does not check tilt and bounds.
  CollisionVerdict motion_verdict(const Vector& from, const Vector& to, double step);
  /// Returns whether the straight motion is upright if required and free at states at most step()
  /// apart. Does not check bounds.
  bool motion_free(const Vector& from, const Vector& to);
  /// Returns like motion_free(), but after check_in_batches() without any exact check.
  bool motion_clear(const Vector& from, const Vector& to);
  /// Treats motions that the batch check cannot clear as blocked. Only if the start or one of
  /// `ends` is not clear, motions within `reach` [rad, max norm] of it are checked exactly. Much
  /// faster, but does not find gaps narrower than the spheres around the links.
  void check_in_batches(std::vector<Vector> ends, double reach);
  /// Reverses check_in_batches(): every motion is checked exactly.
  void check_exactly() { in_batches_ = false; }
  /// Sets the step of the checked states of a motion [rad, max norm].
  void set_step(double step) { step_ = step; }
  /// Returns the step of the checked states of a motion [rad, max norm].
  double step() const { return step_; }

  /// Reports the begin of a stage to the caller's hook, if any.
  void enter(Stage stage) const {
    if (hooks().entered) hooks().entered(stage);
  }

 private:
  CollisionVerdict permitted(const Vector& all) const;
  CollisionVerdict permitted_on_line(const Vector& begin, double step) const;

  const RobotModel& robot_;
  CollisionWorld& world_;
  const HumanCost& cost_;
  const Problem& problem_;
  const Settings& settings_;
  PlannedAxes axes_;
  std::pair<Vector, Vector> bounds_;  ///< Lower and upper, planned axes.
  /// Whether forbidding cost layers apply; false if the start is forbidden, so that the arm can
  /// leave.
  bool bound_{};
  PathCost path_cost_;
  UprightBound upright_;
  Vector all_to_;  ///< End of the checked motion, all axes.
  double step_{};
  bool in_batches_{};  ///< False: every motion is checked exactly.
  std::vector<Vector> tight_ends_;
  double reach_{};
};

/// Returns the Euclidean length of a polyline [rad].
double path_length(const std::vector<Vector>& path);

}  // namespace handsel::path_planner
