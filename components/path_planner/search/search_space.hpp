// The configuration space of one problem: which states and motions are free, what they cost, and how much budget is left.
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

  int size() const { return static_cast<int>(problem_.axes.size()); }
  const Vector& lower() const { return lower_; }
  const Vector& upper() const { return upper_; }
  const Problem& problem() const { return problem_; }
  const Settings& settings() const { return settings_; }
  Vector start() const { return part(problem_.start); }
  bool concerns_people() const { return cost_.concerned() || (problem_.driving && problem_.driving->cost->anyone()); }

  /// Empty when inside the position limits, else which axis is not and by how much.
  std::string outside_limits(const Vector& q) const;
  bool inside(const Vector& q) const;
  CollisionVerdict verdict(const Vector& q);
  bool free(const Vector& q);
  CollisionVerdict motion_verdict(const Vector& from, const Vector& to, double step);
  bool motion_free(const Vector& from, const Vector& to);
  /// As motion_free, but where motions are judged widely nothing goes to the exact check.
  bool motion_clear(const Vector& from, const Vector& to);
  /// From now on motions the wide check cannot clear are taken for blocked; only where the start or one of `ends` is itself not clear,
  /// those within `reach` [rad, max norm] of it go to the exact check. Cheaper by far, and blind to gaps narrower than the spheres around
  /// the links leave.
  void judge_widely(std::vector<Vector> ends, double reach);
  void judge_exactly() { widely_ = false; }
  void set_step(double step) { step_ = step; }
  double step() const { return step_; }

  /// How far what is held leans over [rad]; 0 where nothing asks for it to be upright.
  double tilt(const Vector& q) const;
  bool upright(const Vector& q) const { return !problem_.upright || tilt(q) <= problem_.upright->most; }
  /// Everywhere on the straight line. Its ends may be on the bound, what is between is looked at every few hundredths of a radian.
  bool line_upright(const Vector& from, const Vector& to) const;
  /// The state made upright, near by and inside the limits; may fail, then it is not upright.
  Vector righted(Vector q) const;
  /// The end of a motion toward a target, at most `range` far [rad]; where an upright posture is asked for a short one, bent back to it.
  /// `from` itself when there is none.
  Vector toward(const Vector& from, const Vector& target, double range) const;

  double cost(const Vector& q) const;  ///< of one state, [0, 1]
  /// Of the ends of equal steps of a motion.
  const std::vector<double>& costs_at_steps(const Vector& from, const Vector& to, int steps) const;
  double integral_cost(const Vector& from, const Vector& to) const;  ///< along a motion [rad]
  double work(const Vector& from, const Vector& to) const;           ///< rises of the cost along a motion
  /// What smoothing makes smaller: integral of the cost above that of the cheapest of start and goals, and length_weight times the length.
  double price(const Vector& from, const Vector& to) const;

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
  bool bound_{};        // by what outside layers forbid: not when it starts there, the arm must be able to leave
  bool widely_{};       // else every motion is judged exactly
  std::vector<Vector> tight_ends_;
  double reach_{};
};

/// Euclidean length of a broken line [rad].
double path_length(const std::vector<Vector>& path);

}  // namespace handsel::path_planner
