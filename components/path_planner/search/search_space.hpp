// The configuration space of one problem: which states and motions are free, what they cost, and
// how much budget is left.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "components/path_planner/search/budget.hpp"

namespace handsel::path_planner {

class SearchSpace : public Budget {
 public:
  /// Bounds of unlimited axes are start +- 2 pi.
  SearchSpace(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost, const Problem& problem, const Settings& settings,
              const Hooks& hooks);

  /// Returns the number of axes that are planned for.
  int size() const { return static_cast<int>(problem_.axes.size()); }
  /// Returns the lower bounds of the planned axes [rad, m].
  const Vector& lower() const { return lower_; }
  /// Returns the upper bounds of the planned axes [rad, m].
  const Vector& upper() const { return upper_; }
  /// Returns the problem that was given; must outlive the space.
  const Problem& problem() const { return problem_; }
  /// Returns the settings that were given; must outlive the space.
  const Settings& settings() const { return settings_; }
  /// Returns the start, planned axes only.
  Vector start() const { return part(problem_.start); }
  /// Returns whether states may have a cost: a person is there or a layer adds one.
  bool concerns_people() const { return cost_.concerned() || (problem_.driving && problem_.driving->cost->anyone()); }

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
  /// As motion_free, but after judge_widely() nothing goes to the exact check.
  bool motion_clear(const Vector& from, const Vector& to);
  /// From now on motions the batch check cannot clear are taken for blocked; only where the start
  /// or one of `ends` is itself not clear, those within `reach` [rad, max norm] of it go to the
  /// exact check. Cheaper by far, and blind to gaps narrower than the spheres around the links
  /// leave.
  void judge_widely(std::vector<Vector> ends, double reach);
  /// Ends what judge_widely() began: every motion is checked exactly.
  void judge_exactly() { widely_ = false; }
  /// Sets how close the checked states of a motion are [rad, max norm].
  void set_step(double step) { step_ = step; }
  /// Returns how close the checked states of a motion are [rad, max norm].
  double step() const { return step_; }

  /// Returns how far what is held leans over [rad]; 0 where nothing asks for it to be upright.
  double tilt(const Vector& q) const;
  /// Returns whether tilt() is within the bound; true where nothing asks for it.
  bool upright(const Vector& q) const { return !problem_.upright || tilt(q) <= problem_.upright->most; }
  /// Returns whether the whole straight line is upright. Its ends may be on the bound, what is
  /// between is sampled every few hundredths of a radian.
  bool line_upright(const Vector& from, const Vector& to) const;
  /// Returns a state near by that is upright and inside the limits; where none is found, one that
  /// is not upright.
  Vector righted(Vector q) const;
  /// Returns the end of a motion toward a target, at most `range` far [rad]; where an upright
  /// configuration is asked for a short motion, bent back to it. `from` itself when there is none.
  Vector toward(const Vector& from, const Vector& target, double range) const;

  double cost(const Vector& q) const;  ///< of one state, [0, 1]
  /// Returns the costs at the ends of equal steps of a motion; valid until the next call for a
  /// cost.
  const std::vector<double>& costs_at_steps(const Vector& from, const Vector& to, int steps) const;
  double integral_cost(const Vector& from, const Vector& to) const;  ///< along a motion [rad]
  double work(const Vector& from, const Vector& to) const;           ///< rises of the cost along a motion
  /// Returns what smoothing makes smaller: integral of the cost above that of the cheapest of start
  /// and goals, and length_weight times the length.
  double price(const Vector& from, const Vector& to) const;

  /// Reports the begin of a stage to the hook of the caller, when there is one.
  void enter(Stage stage) const {
    if (hooks().entered) hooks().entered(stage);
  }

 private:
  CollisionVerdict permitted(const Vector& all) const;
  CollisionVerdict permitted_on_line(double step) const;
  Vector part(const Vector& all) const;
  const Vector& whole(const Vector& q) const;
  void fill_costs(const Vector& from, const Vector& to) const;
  const std::vector<double>& costs_along(const Vector& from, const Vector& to) const;

  const RobotModel& robot_;
  CollisionWorld& world_;
  const HumanCost& cost_;
  const Problem& problem_;
  const Settings& settings_;
  Vector lower_, upper_;
  double level_{};  // cost that no path between start and goals avoids
  mutable Vector all_, all_to_;
  mutable std::vector<double> at_, costs_;
  double step_{};
  int tool_{-1};
  bool only_drives_{};  // no axis but those of the platform
  // by what outside layers forbid: not when it starts there, the arm must be able to leave
  bool bound_{};
  bool widely_{};  // else every motion is checked exactly
  std::vector<Vector> tight_ends_;
  double reach_{};
};

/// Returns the Euclidean length of a broken line [rad].
double path_length(const std::vector<Vector>& path);

}  // namespace handsel::path_planner
