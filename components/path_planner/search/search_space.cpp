// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/search/search_space.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace handsel::path_planner {

namespace {

// Step of the checks for forbidden places; at 1 m less than half a cell of the cost maps [rad].
constexpr double kForbiddenStep = 0.01;

/// Returns the bounds of the planned axes; for unlimited axes start +- 2 pi.
std::pair<Vector, Vector> bounds_of(const RobotModel& robot, const Problem& problem) {
  Vector lower(problem.axes.size()), upper(problem.axes.size());
  for (int i = 0; i < static_cast<int>(problem.axes.size()); ++i) {
    const Axis& axis = robot.axes()[problem.axes[i]];
    const double center = problem.start[problem.axes[i]];
    lower[i] = std::isfinite(axis.lower) ? axis.lower : center - 2 * M_PI;
    upper[i] = std::isfinite(axis.upper) ? axis.upper : center + 2 * M_PI;
  }
  if (problem.room) {
    lower = lower.cwiseMax(problem.room->first);
    upper = upper.cwiseMin(problem.room->second);
  }
  return {lower, upper};
}

}  // namespace

SearchSpace::SearchSpace(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost,
                         const Problem& problem, const Settings& settings, const Hooks& hooks)
    : Budget(world, problem.budget, hooks),
      robot_(robot),
      world_(world),
      cost_(cost),
      problem_(problem),
      settings_(settings),
      axes_(problem),
      bounds_(bounds_of(robot, problem)),
      bound_(cost.forbids() && cost.forbidden(problem.start).layer == nullptr),
      path_cost_(cost, problem, settings),
      upright_(robot, problem, bounds_.first, bounds_.second),
      all_to_(problem.start),
      step_(settings.step) {}

std::string SearchSpace::outside_limits(const Vector& q) const {
  constexpr double kRounding = 1e-6;
  for (int i = 0; i < size(); ++i) {
    if (q[i] >= lower()[i] - kRounding && q[i] <= upper()[i] + kRounding) continue;
    char text[160];
    std::snprintf(text, sizeof text, "axis %s at %.4f is outside its limits %.4f ... %.4f",
                  robot_.axes()[problem_.axes[i]].name.c_str(), q[i], lower()[i], upper()[i]);
    return text;
  }
  return {};
}

bool SearchSpace::inside(const Vector& q) const {
  return (q.array() >= lower().array()).all() && (q.array() <= upper().array()).all();
}

CollisionVerdict SearchSpace::permitted(const Vector& all) const {
  const ForbiddenPlace place = cost_.forbidden(all);
  if (place.layer == nullptr) return {};
  return {false,
          "link " + robot_.links()[static_cast<std::size_t>(place.link)].name,
          "what cost layer " + place.layer->layer() + " forbids",
          {}};
}

CollisionVerdict SearchSpace::verdict(const Vector& q) {
  const Vector& all = axes_.whole(q);
  CollisionVerdict verdict = world_.check(all);
  return verdict.free && bound_ ? permitted(all) : verdict;
}

bool SearchSpace::free(const Vector& q) {
  if (!upright_.holds(q)) return false;
  const Vector& all = axes_.whole(q);
  return world_.is_free(all) && !(bound_ && cost_.forbidden(all).layer != nullptr);
}

CollisionVerdict SearchSpace::motion_verdict(const Vector& from, const Vector& to, double step) {
  all_to_ = axes_.whole(to);
  const Vector& begin = axes_.whole(from);
  CollisionVerdict verdict = world_.check_motion(begin, all_to_, step);
  return verdict.free && bound_ ? permitted_on_line(begin, step) : verdict;
}

/// Checks the line from `begin` to all_to_ against forbidding cost layers.
CollisionVerdict SearchSpace::permitted_on_line(const Vector& begin, double step) const {
  const int states = motion_states(begin, all_to_, std::max(step, kForbiddenStep));
  CollisionVerdict verdict;
  for (int i = 0; i < states && verdict.free; ++i)
    verdict =
        permitted(begin + (static_cast<double>(i) / std::max(1, states - 1)) * (all_to_ - begin));
  return verdict;
}

bool SearchSpace::motion_free(const Vector& from, const Vector& to) {
  if (!upright_.holds_on_line(from, to)) return false;
  if (!in_batches_) return motion_verdict(from, to, step_).free;
  all_to_ = axes_.whole(to);
  const Vector& begin = axes_.whole(from);
  if (world_.surely_free_at_steps(begin, all_to_, step_))
    return !bound_ || permitted_on_line(begin, step_).free;
  const auto near = [this](const Vector& end, const Vector& q) {
    return (end - q).cwiseAbs().maxCoeff() < reach_;
  };
  return std::any_of(tight_ends_.begin(), tight_ends_.end(),
                     [&](const Vector& end) { return near(end, from) || near(end, to); }) &&
         motion_verdict(from, to, step_).free;
}

bool SearchSpace::motion_clear(const Vector& from, const Vector& to) {
  if (!in_batches_) return motion_free(from, to);
  if (!upright_.holds_on_line(from, to)) return false;
  all_to_ = axes_.whole(to);
  const Vector& begin = axes_.whole(from);
  return world_.surely_free_at_steps(begin, all_to_, step_) &&
         (!bound_ || permitted_on_line(begin, step_).free);
}

void SearchSpace::check_in_batches(std::vector<Vector> ends, double reach) {
  ends.push_back(start());
  tight_ends_.clear();
  for (const Vector& end : ends) {
    all_to_ = axes_.whole(end);
    if (!world_.surely_free_at_steps(all_to_, all_to_)) tight_ends_.push_back(end);
  }
  reach_ = reach;
  in_batches_ = true;
}

double path_length(const std::vector<Vector>& path) {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

}  // namespace handsel::path_planner
