// What states and motions of one problem cost.
#pragma once

#include <vector>

#include "common/cost/human_cost.hpp"
#include "components/path_planner/problem.hpp"
#include "components/path_planner/search/planned_axes.hpp"

namespace handsel::path_planner {

/// Human-aware cost of the planned axes: that of the arm, and of the platform where it is planned
/// for.
class PathCost {
 public:
  /// All arguments must outlive this.
  PathCost(const HumanCost& cost, const Problem& problem, const Settings& settings);

  /// Returns whether states may have a cost: a person is there or a layer adds one.
  bool concerns_people() const;
  /// Returns the cost of one state, [0, 1].
  double of(const Vector& q) const;
  /// Returns the costs at the ends of equal steps of a motion; valid until the next call for a
  /// cost.
  const std::vector<double>& at_steps(const Vector& from, const Vector& to, int steps) const;
  /// Returns the integral of the cost along a motion [rad].
  double integral(const Vector& from, const Vector& to) const;
  /// Returns the sum of the rises of the cost along a motion.
  double work(const Vector& from, const Vector& to) const;
  /// Returns what smoothing makes smaller: integral of the cost above that of the cheapest of start
  /// and goals, and length_weight times the length.
  double price(const Vector& from, const Vector& to) const;
  /// Returns the sum of the prices of the segments of a path.
  double price(const std::vector<Vector>& path) const;

 private:
  void fill_costs(const Vector& from, const Vector& to) const;
  const std::vector<double>& costs_along(const Vector& from, const Vector& to) const;

  const HumanCost& cost_;
  const Problem& problem_;
  const Settings& settings_;
  PlannedAxes axes_;
  bool only_platform_{};  ///< No axis but those of the platform is planned for.
  double level_{};        ///< Cost that no path between start and goals avoids.
  mutable Vector to_;
  mutable std::vector<double> at_, costs_;
};

}  // namespace handsel::path_planner
