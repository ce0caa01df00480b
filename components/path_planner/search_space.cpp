#include "components/path_planner/search_space.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace handsel::path_planner {

SearchSpace::SearchSpace(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost, const Problem& problem,
                         const Settings& settings, const Hooks& hooks)
    : robot_(robot),
      world_(world),
      cost_(cost),
      problem_(problem),
      settings_(settings),
      hooks_(hooks),
      lower_(problem.axes.size()),
      upper_(problem.axes.size()),
      all_(problem.start),
      all_to_(problem.start),
      checks_before_(world.checks()),
      limit_(problem.budget),
      step_(settings.step) {
  for (int i = 0; i < size(); ++i) {
    const Axis& axis = robot.axes()[problem.axes[i]];
    const double center = problem.start[problem.axes[i]];
    lower_[i] = std::isfinite(axis.lower) ? axis.lower : center - 2 * M_PI;
    upper_[i] = std::isfinite(axis.upper) ? axis.upper : center + 2 * M_PI;
  }
}

Vector SearchSpace::part(const Vector& all) const {
  Vector q(size());
  for (int i = 0; i < size(); ++i) q[i] = all[problem_.axes[i]];
  return q;
}

const Vector& SearchSpace::whole(const Vector& q) const {
  for (int i = 0; i < size(); ++i) all_[problem_.axes[i]] = q[i];
  return all_;
}

std::string SearchSpace::outside_limits(const Vector& q) const {
  constexpr double kRounding = 1e-6;
  for (int i = 0; i < size(); ++i) {
    if (q[i] >= lower_[i] - kRounding && q[i] <= upper_[i] + kRounding) continue;
    char text[160];
    std::snprintf(text, sizeof text, "axis %s at %.4f is outside its limits %.4f ... %.4f", robot_.axes()[problem_.axes[i]].name.c_str(),
                  q[i], lower_[i], upper_[i]);
    return text;
  }
  return {};
}

bool SearchSpace::inside(const Vector& q) const { return (q.array() >= lower_.array()).all() && (q.array() <= upper_.array()).all(); }

CollisionVerdict SearchSpace::verdict(const Vector& q) { return world_.check(whole(q)); }
bool SearchSpace::free(const Vector& q) { return world_.is_free(whole(q)); }

CollisionVerdict SearchSpace::motion_verdict(const Vector& from, const Vector& to, double step) {
  all_to_ = whole(to);
  return world_.check_motion(whole(from), all_to_, step);
}

double SearchSpace::cost(const Vector& q) const { return cost_.anyone() ? cost_(whole(q)) : 0.0; }

template <class F>
void SearchSpace::along(const Vector& from, const Vector& to, F&& visit) const {
  const double length = (to - from).norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / settings_.cost_step)));
  for (int i = 0; i < pieces; ++i) visit((i + 0.5) / pieces, length / pieces);
}

double SearchSpace::integral_cost(const Vector& from, const Vector& to) const {
  if (!cost_.anyone()) return 0.0;
  double sum = 0;
  along(from, to, [&](double t, double ds) { sum += ds * cost(from + t * (to - from)); });
  return sum;
}

double SearchSpace::work(const Vector& from, const Vector& to) const {
  if (!cost_.anyone()) return 0.0;
  double sum = 0, last = cost(from);
  const auto rise = [&](double now) {
    sum += std::max(0.0, now - last);
    last = now;
  };
  along(from, to, [&](double t, double) { rise(cost(from + t * (to - from))); });
  rise(cost(to));
  return sum;
}

double SearchSpace::price(const Vector& from, const Vector& to) const {
  return integral_cost(from, to) + settings_.length_weight * (to - from).norm();
}

double path_length(const std::vector<Vector>& path) {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

}  // namespace handsel::path_planner
