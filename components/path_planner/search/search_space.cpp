#include "components/path_planner/search/search_space.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace handsel::path_planner {

namespace {

constexpr double kTiltStep = 0.03;       // sum over the axes between two states whose tilt is judged [rad]
constexpr double kTiltBetween = 5e-4;    // between them it is at most this much more [rad]
constexpr double kUprightRange = 0.2;    // longest motion that is bent back to upright [rad]
constexpr double kLeastProgress = 0.05;  // of its length
constexpr double kForbiddenStep = 0.01;  // [rad] a meter away that is less than half a cell of our own grids

}  // namespace

SearchSpace::SearchSpace(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost, const Problem& problem,
                         const Settings& settings, const Hooks& hooks)
    : Budget(world, problem.budget, hooks),
      robot_(robot),
      world_(world),
      cost_(cost),
      problem_(problem),
      settings_(settings),
      lower_(problem.axes.size()),
      upper_(problem.axes.size()),
      all_(problem.start),
      all_to_(problem.start),
      step_(settings.step),
      tool_(robot.tool_link() >= 0 ? robot.tool_link() : static_cast<int>(robot.links().size()) - 1),
      bound_(cost.forbids() && cost.forbidden(problem.start).layer == nullptr) {
  for (int i = 0; i < size(); ++i) {
    const Axis& axis = robot.axes()[problem.axes[i]];
    const double center = problem.start[problem.axes[i]];
    lower_[i] = std::isfinite(axis.lower) ? axis.lower : center - 2 * M_PI;
    upper_[i] = std::isfinite(axis.upper) ? axis.upper : center + 2 * M_PI;
  }
  if (problem.room) {
    lower_ = lower_.cwiseMax(problem.room->first);
    upper_ = upper_.cwiseMin(problem.room->second);
  }
  only_drives_ = problem.driving && std::all_of(problem.axes.begin(), problem.axes.end(), [&](int axis) {
                   return std::count(problem.driving->axes.begin(), problem.driving->axes.end(), axis) > 0;
                 });
  level_ = this->cost(start());
  for (const Vector& goal : problem.goals) level_ = std::min(level_, this->cost(goal));
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

CollisionVerdict SearchSpace::permitted(const Vector& all) const {
  const ForbiddenPlace place = cost_.forbidden(all);
  if (place.layer == nullptr) return {};
  return {false,
          "link " + robot_.links()[static_cast<std::size_t>(place.link)].name,
          "what cost layer " + place.layer->layer() + " forbids",
          {}};
}

CollisionVerdict SearchSpace::verdict(const Vector& q) {
  CollisionVerdict verdict = world_.check(whole(q));
  return verdict.free && bound_ ? permitted(all_) : verdict;
}

bool SearchSpace::free(const Vector& q) {
  return upright(q) && world_.is_free(whole(q)) && !(bound_ && cost_.forbidden(all_).layer != nullptr);
}

CollisionVerdict SearchSpace::motion_verdict(const Vector& from, const Vector& to, double step) {
  all_to_ = whole(to);
  CollisionVerdict verdict = world_.check_motion(whole(from), all_to_, step);
  return verdict.free && bound_ ? permitted_on_line(step) : verdict;
}

/// From all_ to all_to_.
CollisionVerdict SearchSpace::permitted_on_line(double step) const {
  const Vector begin = all_;
  const int states = motion_states(begin, all_to_, std::max(step, kForbiddenStep));
  CollisionVerdict verdict;
  for (int i = 0; i < states && verdict.free; ++i)
    verdict = permitted(begin + (static_cast<double>(i) / std::max(1, states - 1)) * (all_to_ - begin));
  return verdict;
}

bool SearchSpace::motion_free(const Vector& from, const Vector& to) {
  if (!line_upright(from, to)) return false;
  if (!widely_) return motion_verdict(from, to, step_).free;
  all_to_ = whole(to);
  if (world_.surely_free_at_steps(whole(from), all_to_, step_)) return !bound_ || permitted_on_line(step_).free;
  const auto near = [this](const Vector& end, const Vector& q) { return (end - q).cwiseAbs().maxCoeff() < reach_; };
  return std::any_of(tight_ends_.begin(), tight_ends_.end(), [&](const Vector& end) { return near(end, from) || near(end, to); }) &&
         motion_verdict(from, to, step_).free;
}

bool SearchSpace::motion_clear(const Vector& from, const Vector& to) {
  if (!widely_) return motion_free(from, to);
  if (!line_upright(from, to)) return false;
  all_to_ = whole(to);
  return world_.surely_free_at_steps(whole(from), all_to_, step_) && (!bound_ || permitted_on_line(step_).free);
}

void SearchSpace::judge_widely(std::vector<Vector> ends, double reach) {
  ends.push_back(start());
  tight_ends_.clear();
  for (const Vector& end : ends) {
    all_to_ = whole(end);
    if (!world_.surely_free_at_steps(all_to_, all_to_)) tight_ends_.push_back(end);
  }
  reach_ = reach;
  widely_ = true;
}

double SearchSpace::tilt(const Vector& q) const {
  if (!problem_.upright) return 0.0;
  const Vector3 axis = robot_.link_pose(whole(q), tool_).linear() * problem_.upright->axis_tool.normalized();
  return std::acos(std::clamp(axis.dot(problem_.upright->up_root.normalized()), -1.0, 1.0));
}

bool SearchSpace::line_upright(const Vector& from, const Vector& to) const {
  if (!problem_.upright) return true;
  const int last = std::max(1, static_cast<int>(std::ceil((to - from).cwiseAbs().sum() / kTiltStep)));
  if (!upright(from) || !upright(to)) return false;
  for (int i = 1; i < last; ++i)
    if (tilt(from + (static_cast<double>(i) / last) * (to - from)) > problem_.upright->most - kTiltBetween) return false;
  return true;
}

Vector SearchSpace::righted(Vector q) const {
  if (!problem_.upright) return q;
  constexpr int kRounds = 12;
  constexpr double kAim = 0.9, kDifference = 1e-5;
  for (int round = 0; round < kRounds; ++round) {
    const double now = tilt(q), over = now - kAim * problem_.upright->most;
    if (over <= 0) break;
    Vector slope(size());
    for (int i = 0; i < size(); ++i) {
      Vector moved = q;
      moved[i] += kDifference;
      slope[i] = (tilt(moved) - now) / kDifference;
    }
    if (slope.squaredNorm() < 1e-9) break;
    q = (q - slope * (over / slope.squaredNorm())).cwiseMax(lower_).cwiseMin(upper_);
  }
  return q;
}

Vector SearchSpace::toward(const Vector& from, const Vector& target, double range) const {
  const double distance = (target - from).norm(), reach = problem_.upright ? std::min(range, kUprightRange) : range;
  Vector end = distance > reach ? Vector(from + (target - from) * (reach / distance)) : target;
  if (!problem_.upright || line_upright(from, end)) return end;
  Vector bent = righted(end);
  const bool nearer = (target - bent).norm() < distance - kLeastProgress * reach;
  if (!nearer || !line_upright(from, bent)) return from;
  return bent;
}

double SearchSpace::cost(const Vector& q) const {
  if (!concerns_people()) return 0.0;
  if (!problem_.driving) return cost_(whole(q));
  at_ = {0.0};
  fill_costs(q, q);
  return costs_.front();
}

/// costs_ of the states at_ of the motion.
void SearchSpace::fill_costs(const Vector& from, const Vector& to) const {
  costs_.resize(at_.size());
  all_to_ = whole(to);
  whole(from);
  if (!only_drives_) cost_.on_line(all_, all_to_, at_.data(), static_cast<int>(at_.size()), costs_.data());
  if (!problem_.driving) return;
  const auto& [x, y, heading] = problem_.driving->axes;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const Vector q = all_ + at_[i] * (all_to_ - all_);
    const double driven = (*problem_.driving->cost)(q[x], q[y], q[heading]);
    costs_[i] = only_drives_ ? driven + cost_.parts(q).outside : std::max(costs_[i], driven);
  }
}

const std::vector<double>& SearchSpace::costs_at_steps(const Vector& from, const Vector& to, int steps) const {
  at_.resize(static_cast<std::size_t>(steps));
  costs_.assign(static_cast<std::size_t>(steps), 0.0);
  if (!concerns_people()) return costs_;
  for (int i = 0; i < steps; ++i) at_[static_cast<std::size_t>(i)] = (i + 1.0) / steps;
  fill_costs(from, to);
  return costs_;
}

/// Of the middles of equal pieces of the motion.
const std::vector<double>& SearchSpace::costs_along(const Vector& from, const Vector& to) const {
  const int pieces = std::max(1, static_cast<int>(std::ceil((to - from).norm() / settings_.cost_step)));
  at_.resize(static_cast<std::size_t>(pieces));
  for (int i = 0; i < pieces; ++i) at_[static_cast<std::size_t>(i)] = (i + 0.5) / pieces;
  fill_costs(from, to);
  return costs_;
}

double SearchSpace::integral_cost(const Vector& from, const Vector& to) const {
  if (!concerns_people()) return 0.0;
  double sum = 0;
  for (double cost : costs_along(from, to)) sum += cost;
  return sum * (to - from).norm() / static_cast<double>(costs_.size());
}

double SearchSpace::work(const Vector& from, const Vector& to) const {
  if (!concerns_people()) return 0.0;
  double sum = 0, last = cost(from);
  const auto rise = [&](double now) {
    sum += std::max(0.0, now - last);
    last = now;
  };
  for (double cost : costs_along(from, to)) rise(cost);
  rise(cost(to));
  return sum;
}

double SearchSpace::price(const Vector& from, const Vector& to) const {
  const double length = (to - from).norm();
  double sum = 0;
  if (concerns_people())
    for (double cost : costs_along(from, to)) sum += std::max(0.0, cost - level_);
  return (sum / static_cast<double>(std::max<std::size_t>(1, costs_.size())) + settings_.length_weight) * length;
}

double path_length(const std::vector<Vector>& path) {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

}  // namespace handsel::path_planner
