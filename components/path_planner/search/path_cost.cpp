// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/search/path_cost.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::path_planner {

PathCost::PathCost(const HumanCost& cost, const Problem& problem, const Settings& settings)
    : cost_(cost), problem_(problem), settings_(settings), axes_(problem), to_(problem.start) {
  only_platform_ = problem.platform_motion &&
                   std::all_of(problem.axes.begin(), problem.axes.end(), [&](int axis) {
                     return std::count(problem.platform_motion->axes.begin(),
                                       problem.platform_motion->axes.end(), axis) > 0;
                   });
  level_ = of(axes_.part(problem.start));
  for (const Vector& goal : problem.goals) level_ = std::min(level_, of(goal));
}

bool PathCost::concerns_people() const {
  return cost_.concerned() ||
         (problem_.platform_motion && problem_.platform_motion->cost->anyone());
}

double PathCost::of(const Vector& q) const {
  if (!concerns_people()) return 0.0;
  if (!problem_.platform_motion) return cost_(axes_.whole(q));
  at_ = {0.0};
  fill_costs(q, q);
  return costs_.front();
}

/// Writes costs_ at the states at_ of the motion.
void PathCost::fill_costs(const Vector& from, const Vector& to) const {
  costs_.resize(at_.size());
  to_ = axes_.whole(to);
  const Vector& begin = axes_.whole(from);
  if (!only_platform_)
    cost_.on_line(begin, to_, at_.data(), static_cast<int>(at_.size()), costs_.data());
  if (!problem_.platform_motion) return;
  const auto& [x, y, heading] = problem_.platform_motion->axes;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const Vector q = begin + at_[i] * (to_ - begin);
    const double driven = cost_.gain() * (*problem_.platform_motion->cost)(q[x], q[y], q[heading]);
    costs_[i] = only_platform_ ? driven + cost_.outside(q) : std::max(costs_[i], driven);
  }
}

const std::vector<double>& PathCost::at_steps(const Vector& from, const Vector& to,
                                              int steps) const {
  at_.resize(static_cast<std::size_t>(steps));
  costs_.assign(static_cast<std::size_t>(steps), 0.0);
  if (!concerns_people()) return costs_;
  for (int i = 0; i < steps; ++i) at_[static_cast<std::size_t>(i)] = (i + 1.0) / steps;
  fill_costs(from, to);
  return costs_;
}

/// Returns the costs at the midpoints of equal parts of the motion.
const std::vector<double>& PathCost::costs_along(const Vector& from, const Vector& to) const {
  const int pieces =
      std::max(1, static_cast<int>(std::ceil((to - from).norm() / settings_.cost_step)));
  at_.resize(static_cast<std::size_t>(pieces));
  for (int i = 0; i < pieces; ++i) at_[static_cast<std::size_t>(i)] = (i + 0.5) / pieces;
  fill_costs(from, to);
  return costs_;
}

double PathCost::integral(const Vector& from, const Vector& to) const {
  if (!concerns_people()) return 0.0;
  double sum = 0;
  for (double cost : costs_along(from, to)) sum += cost;
  return sum * (to - from).norm() / static_cast<double>(costs_.size());
}

double PathCost::work(const Vector& from, const Vector& to) const {
  if (!concerns_people()) return 0.0;
  double sum = 0, last = of(from);
  const auto rise = [&](double now) {
    sum += std::max(0.0, now - last);
    last = now;
  };
  for (double cost : costs_along(from, to)) rise(cost);
  rise(of(to));
  return sum;
}

double PathCost::price(const std::vector<Vector>& path) const {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += price(path[i - 1], path[i]);
  return sum;
}

double PathCost::price(const Vector& from, const Vector& to) const {
  const double length = (to - from).norm();
  double sum = 0;
  if (concerns_people())
    for (double cost : costs_along(from, to)) sum += std::max(0.0, cost - level_);
  return (sum / static_cast<double>(std::max<std::size_t>(1, costs_.size())) +
          settings_.length_weight) *
         length;
}

}  // namespace handsel::path_planner
