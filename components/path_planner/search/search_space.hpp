// The configuration space of one problem: which states and motions are free, what they cost, and
// how many checks are left.
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

  /// Returns the number of axes that are planned for.
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
  /// Returns what states and motions cost.
  const PathCost& costs() const { return path_cost_; }
  /// Returns the bound on how far what is held may lean over.
  const UprightBound& upright() const { return upright_; }

  /// Returns an empty text inside the position limits, else which axis is outside, where and of
  /// which limits.
  std::string outside_limits(const Vector& q) const;
  /// Returns whether every planned axis is within its bounds, without tolerance.
  bool inside(const Vector& q) const;
  /// Checks a state exactly; says what touches what, or which cost layer forbids the place. Tilt
  /// and bounds are not checked.
  CollisionVerdict verdict(const Vector& q);
  /// Returns whether a state is upright where asked for, free of contact and not forbidden by a
  /// cost layer. Bounds are not checked.
  bool free(const Vector& q);
  /// Checks the straight motion at states at most `step` [rad, max norm] apart, as verdict(). Tilt
  /// and bounds are not checked.
  CollisionVerdict motion_verdict(const Vector& from, const Vector& to, double step);
  /// Returns whether the straight motion is upright where asked for and free at states at most
  /// step() apart. Bounds are not checked.
  bool motion_free(const Vector& from, const Vector& to);
  /// As motion_free, but after check_in_batches() nothing goes to the exact check.
  bool motion_clear(const Vector& from, const Vector& to);
  /// From now on motions the batch check cannot clear are taken for blocked; only where the start
  /// or one of `ends` is itself not clear, those within `reach` [rad, max norm] of it go to the
  /// exact check. Cheaper by far, and blind to gaps narrower than the spheres around the links
  /// leave.
  void check_in_batches(std::vector<Vector> ends, double reach);
  /// Ends what check_in_batches() began: every motion is checked exactly.
  void check_exactly() { in_batches_ = false; }
  /// Sets how close the checked states of a motion are [rad, max norm].
  void set_step(double step) { step_ = step; }
  /// Returns how close the checked states of a motion are [rad, max norm].
  double step() const { return step_; }

  /// Reports the begin of a stage to the hook of the caller, when there is one.
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
  /// By what outside layers forbid: not when it starts there, the arm must be able to leave.
  bool bound_{};
  PathCost path_cost_;
  UprightBound upright_;
  Vector all_to_;  ///< End of the motion that is checked, all axes.
  double step_{};
  bool in_batches_{};  ///< Else every motion is checked exactly.
  std::vector<Vector> tight_ends_;
  double reach_{};
};

/// Returns the Euclidean length of a broken line [rad].
double path_length(const std::vector<Vector>& path);

}  // namespace handsel::path_planner
