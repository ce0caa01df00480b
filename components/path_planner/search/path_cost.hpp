// SPDX-License-Identifier: Apache-2.0
// Costs of states and motions of one problem.
#pragma once

#include <vector>

#include "common/cost/human_cost.hpp"
#include "components/path_planner/problem.hpp"
#include "components/path_planner/search/planned_axes.hpp"

namespace handsel::path_planner {

/// Human-aware cost of the planned axes: of the arm, and of the platform if it is planned.
class PathCost {
 public:
  /// All arguments must outlive this.
  PathCost(const HumanCost& cost, const Problem& problem, const Settings& settings);

  /// Returns whether states may have a cost, because of people or cost layers.
  bool concerns_people() const;
  /// Returns the cost of one state, [0, 1].
  double of(const Vector& q) const;
  /// Returns the costs at the ends of equal steps of a motion; valid until the next call.
  const std::vector<double>& at_steps(const Vector& from, const Vector& to, int steps) const;
  /// Returns the integral of the cost along a motion [rad].
  double integral(const Vector& from, const Vector& to) const;
  /// Returns the sum of the increases of the cost along a motion.
  double work(const Vector& from, const Vector& to) const;
  /// Returns the price that smoothing minimises: the integral of the cost above the min cost of
  /// start and goals, plus length_weight times the length.
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
  bool only_platform_{};  ///< Only axes of the platform are planned.
  double level_{};        ///< Min cost of start and goals.
  mutable Vector to_;
  mutable std::vector<double> at_, costs_;
};

}  // namespace handsel::path_planner
