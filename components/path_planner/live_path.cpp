// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/live_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/trajectory/path/broken_line.hpp"
#include "components/path_planner/search/random.hpp"
#include "components/path_planner/search/search.hpp"
#include "components/path_planner/search/search_space.hpp"
#include "components/path_planner/search/smoothing.hpp"

namespace handsel::path_planner {
namespace {

constexpr double kSameGoal = 1e-6;       // max difference of equal goals [rad]
constexpr double kMinReplanGain = 1e-6;  // min reduction of the price by a perturbation
// Duration of an exact check of a state, divided by that of a batch check.
constexpr std::uint64_t kExactCheckCost = 12;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Returns the path with segments of at most `max_length` (max norm).
std::vector<Vector> cut(const std::vector<Vector>& path, double max_length) {
  std::vector<Vector> pieces = {path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vector step = path[i] - path[i - 1];
    const int count =
        std::max(1, static_cast<int>(std::ceil(step.lpNorm<Eigen::Infinity>() / max_length)));
    for (int k = 1; k <= count; ++k)
      pieces.push_back(k == count ? path[i]
                                  : Vector(path[i - 1] + step * (static_cast<double>(k) / count)));
  }
  return pieces;
}

class PathReplanner {
 public:
  PathReplanner(SearchSpace& space, const Problem& problem, const Settings& settings,
                const ReplanSettings& live)
      : space_(space), problem_(problem), settings_(settings), live_(live), random_(problem.seed) {}

  /// Returns the replanned path; nullopt: no part of the path can be used.
  std::optional<ReplanResult> run(std::vector<Vector> rest) {
    ReplanResult out;
    std::size_t goal = goal_of(rest.back());
    bool other_goal = false;
    if (goal == problem_.goals.size() || !space_.free(rest.back())) {
      if (!lead_to_a_goal(rest, goal) && !search_anew(rest, goal)) return std::nullopt;
      other_goal = true;
    }
    const std::vector<Vector> original = rest;
    std::size_t first = 0, last = 0;
    const bool was_blocked = !other_goal && blocked(rest, first, last);
    out.before = was_blocked || other_goal ? kInfinite : space_.costs().price(rest);
    space_.check_in_batches({rest.back()}, live_.near_ends);
    if (was_blocked && !repair(rest)) {
      if (!search_anew(rest, goal)) return std::nullopt;
      other_goal = true;
    }
    std::vector<Vector> path = rest;
    smooth(space_, path, random_);
    // A path that was blocked is returned without delay; later calls reduce the price.
    if (!was_blocked && !other_goal && space_.costs().concerns_people()) {
      deform(path);
      drop_nodes(path, out.before);
    } else {
      prune(space_, path);
    }
    space_.check_exactly();
    if (!verified(path)) {
      path = rest;
      if ((was_blocked || other_goal) && !verified(path)) return std::nullopt;
    }
    out.after = space_.costs().price(path);
    if (was_blocked || other_goal) {
      out.outcome = other_goal ? ReplanOutcome::replanned : ReplanOutcome::repaired;
    } else if (out.after < out.before * (1 - live_.min_gain)) {
      out.outcome = ReplanOutcome::improved;
    } else {
      path = original;
      out.after = out.before;
    }
    out.result.path = std::move(path);
    out.result.goal = goal;
    out.result.planner = name(out.outcome);
    finish(out.result);
    return out;
  }

 private:
  std::size_t goal_of(const Vector& q) const {
    for (std::size_t i = 0; i < problem_.goals.size(); ++i)
      if ((problem_.goals[i] - q).lpNorm<Eigen::Infinity>() < kSameGoal) return i;
    return problem_.goals.size();
  }

  /// Leads the path from one of its waypoints straight to one of the goals, at min price.
  bool lead_to_a_goal(std::vector<Vector>& rest, std::size_t& goal) {
    const std::vector<Vector> nodes = cut(rest, 4 * live_.piece);
    std::size_t reachable = 1;
    while (reachable < nodes.size() && space_.motion_free(nodes[reachable - 1], nodes[reachable]))
      ++reachable;
    double min_cost = kInfinite;
    std::vector<double> so_far(reachable, 0.0);
    for (std::size_t k = 1; k < reachable; ++k)
      so_far[k] = so_far[k - 1] + space_.costs().price(nodes[k - 1], nodes[k]);
    std::size_t leave = 0;
    for (std::size_t i = 0; i < problem_.goals.size(); ++i) {
      const Vector& q = problem_.goals[i];
      if (!space_.outside_limits(q).empty() || !space_.free(q)) continue;
      for (std::size_t k = 0; k < reachable; ++k) {
        const double cost = so_far[k] + space_.costs().price(nodes[k], q);
        if (cost >= min_cost || !space_.motion_free(nodes[k], q)) continue;
        min_cost = cost;
        leave = k;
        goal = i;
      }
    }
    if (min_cost == kInfinite) return false;
    rest.assign(nodes.begin(), nodes.begin() + static_cast<long>(leave) + 1);
    rest.push_back(problem_.goals[goal]);
    return true;
  }

  /// Searches from the switch point by RRT-Connect; later calls reduce the price of the path.
  bool search_anew(std::vector<Vector>& rest, std::size_t& goal) {
    std::vector<Vector> goals;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < problem_.goals.size(); ++i) {
      if (!space_.outside_limits(problem_.goals[i]).empty() || !space_.free(problem_.goals[i]))
        continue;
      goals.push_back(problem_.goals[i]);
      index.push_back(i);
    }
    if (goals.empty()) return false;
    const std::uint64_t limit = space_.limit(), left = limit - std::min(limit, space_.checks());
    space_.limit(limit - left / 2);
    space_.check_in_batches(goals, live_.near_ends);
    Found found = search(space_, goals, PlannerKind::rrt_connect, false, problem_.seed);
    space_.limit(limit);
    if (found.path.empty()) {
      space_.check_exactly();
      found = search(space_, goals, PlannerKind::rrt_connect, false, problem_.seed + 1);
    }
    if (found.path.empty()) return false;
    rest = found.path;
    goal = index[found.goal];
    return true;
  }

  /// Writes first and last blocked segment (index of its end); returns whether any is blocked.
  bool blocked(const std::vector<Vector>& path, std::size_t& first, std::size_t& last) {
    bool any = false;
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (space_.motion_verdict(path[i - 1], path[i], settings_.step).free) continue;
      if (!any) first = i;
      last = i;
      any = true;
    }
    return any;
  }

  /// Repairs the path (chapter section 4.1.1): moves a blocked configuration toward a random one
  /// and reconnects the path on both sides, with distances that increase with the number of tries.
  bool repair(std::vector<Vector>& rest) {
    std::vector<Vector> path = cut(rest, live_.piece);
    std::size_t first = 0, last = 0;
    for (int round = 0; round < 3; ++round) {
      if (!blocked(path, first, last)) {
        rest = path;
        return true;
      }
      std::vector<Vector> best;
      double min_cost = kInfinite;
      int found = 0;
      for (int k = 0; k < live_.tries && found < 3 && !space_.exhausted(); ++k) {
        const double fraction = static_cast<double>(k + 1) / live_.tries;
        const std::size_t span = 1 + static_cast<std::size_t>(random_.unit() * (2 + 12 * fraction));
        const std::size_t from = first > span ? first - span : 0,
                          to = std::min(path.size() - 1, last + span - 1);
        const std::size_t middle =
            first - 1 +
            static_cast<std::size_t>(random_.unit() * static_cast<double>(last - first + 2));
        const Vector center = path[std::min(middle, path.size() - 1)];
        const Vector toward = random_.within(space_.lower(), space_.upper()) - center;
        const double far = random_.between(0.1, 0.3 + 1.5 * fraction);
        Vector q = center + toward * (far / std::max(far, toward.norm()));
        q = q.cwiseMax(space_.lower()).cwiseMin(space_.upper());
        if (!space_.free(q)) continue;
        const double cost =
            found > 0 ? space_.costs().price(path[from], q) + space_.costs().price(q, path[to])
                      : 0.0;
        if (cost >= min_cost || !space_.motion_free(path[from], q) ||
            !space_.motion_free(q, path[to]))
          continue;
        best.assign(path.begin(), path.begin() + static_cast<long>(from) + 1);
        best.push_back(q);
        best.insert(best.end(), path.begin() + static_cast<long>(to), path.end());
        min_cost = found > 0
                       ? cost
                       : space_.costs().price(path[from], q) + space_.costs().price(q, path[to]);
        ++found;
      }
      if (best.empty()) return false;
      path = std::move(best);
    }
    if (blocked(path, first, last)) return false;
    rest = path;
    return true;
  }

  /// Deforms the path: moves one waypoint and its neighbours with linearly decreasing displacement,
  /// in both directions; checks price, bounds, then collisions.
  void deform(std::vector<Vector>& path) {
    path = cut(path, 2 * live_.piece);
    const std::size_t n = path.size();
    if (n < 3) return;
    std::vector<double> costs, prices(n, 0.0), bent_prices(n, 0.0);
    for (const Vector& q : path) costs.push_back(space_.costs().of(q));
    for (std::size_t i = 1; i < n; ++i) prices[i] = space_.costs().price(path[i - 1], path[i]);
    std::vector<Vector> bent = path;
    for (int round = 0; round < live_.rounds && !space_.exhausted(); ++round) {
      const auto any = [&] {
        return 1 + static_cast<std::size_t>(random_.unit() * static_cast<double>(n - 2));
      };
      const std::size_t a = any(), b = any(), middle = costs[a] > costs[b] ? a : b;
      const std::size_t span =
          1 + static_cast<std::size_t>(random_.unit() * 0.3 * static_cast<double>(n));
      const std::size_t from = middle > span ? middle - span : 0,
                        to = std::min(n - 1, middle + span);
      Vector shift =
          random_.within(Vector::Constant(space_.size(), -1), Vector::Constant(space_.size(), 1));
      shift *= random_.between(0.2, 1.0) * live_.piece * static_cast<double>(span) /
               std::max(0.1, shift.norm());
      double before = 0;
      for (std::size_t i = from + 1; i <= to; ++i) before += prices[i];
      for (const double sign : {1.0, -1.0}) {
        bool good = true;
        for (std::size_t i = from + 1; i < to && good; ++i) {
          const double fraction =
              i <= middle ? static_cast<double>(i - from) / static_cast<double>(middle - from)
                          : static_cast<double>(to - i) / static_cast<double>(to - middle);
          bent[i] = path[i] + sign * fraction * shift;
          good = space_.inside(bent[i]);
        }
        bent[from] = path[from];
        bent[to] = path[to];
        double left = before - kMinReplanGain;
        for (std::size_t i = from + 1; i <= to && good; ++i)
          good = (left -= bent_prices[i] = space_.costs().price(bent[i - 1], bent[i])) > 0;
        for (std::size_t i = from + 1; i <= to && good; ++i)
          good = space_.motion_free(bent[i - 1], bent[i]);
        if (!good) continue;
        for (std::size_t i = from + 1; i <= to; ++i) {
          path[i] = bent[i];
          prices[i] = bent_prices[i];
          costs[i] = space_.costs().of(path[i]);
        }
        break;
      }
    }
  }

  /// Removes waypoints with little effect on the price, because each one requires a blend.
  void drop_nodes(std::vector<Vector>& path, double before) {
    const double now = space_.costs().price(path);
    double allowed = std::max(live_.max_drop_loss * now, live_.max_drop_gain * (before - now));
    for (std::size_t i = 1; i + 1 < path.size();) {
      const double loss = space_.costs().price(path[i - 1], path[i + 1]) -
                          space_.costs().price(path[i - 1], path[i]) -
                          space_.costs().price(path[i], path[i + 1]);
      if (loss <= 0.5 * allowed && space_.motion_free(path[i - 1], path[i + 1])) {
        allowed -= std::max(0.0, loss);
        path.erase(path.begin() + static_cast<long>(i));
      } else {
        ++i;
      }
    }
  }

  bool verified(const std::vector<Vector>& path) {
    for (std::size_t i = 1; i < path.size(); ++i)
      if (!space_.motion_verdict(path[i - 1], path[i], live_.verify_step).free) return false;
    return true;
  }

  void finish(Result& result) const {
    for (std::size_t i = 1; i < result.path.size(); ++i) {
      result.cost += space_.costs().integral(result.path[i - 1], result.path[i]);
      result.work += space_.costs().work(result.path[i - 1], result.path[i]);
    }
    result.length = path_length(result.path);
    result.solved = true;
  }

  SearchSpace& space_;
  const Problem& problem_;
  const Settings& settings_;
  const ReplanSettings& live_;
  Random random_;
};

}  // namespace

const char* name(ReplanOutcome outcome) {
  switch (outcome) {
    case ReplanOutcome::kept:
      return "kept";
    case ReplanOutcome::improved:
      return "improved";
    case ReplanOutcome::repaired:
      return "repaired";
    case ReplanOutcome::replanned:
      return "replanned";
    default:
      return "blocked";
  }
}

ReplanResult continue_path(const PlanningModels& models, const Problem& problem,
                           const std::vector<Vector>& running, const Settings& settings,
                           const ReplanSettings& live, const Hooks& hooks) {
  ReplanResult out;
  const auto& [robot, world, cost] = models;
  Settings fast_settings = settings;
  fast_settings.smoothing_rounds = live.rounds / 3;
  std::uint64_t spent = 0;
  const bool is_valid =
      problem.start.size() == robot.dof() && problem.start.allFinite() && !problem.axes.empty() &&
      !problem.straight &&
      std::all_of(problem.axes.begin(), problem.axes.end(),
                  [dof = robot.dof()](int a) { return a >= 0 && a < dof; }) &&
      std::all_of(problem.goals.begin(), problem.goals.end(), [&](const Vector& g) {
        return g.size() == static_cast<Eigen::Index>(problem.axes.size()) && g.allFinite();
      });
  if (is_valid && problem.budget > 0) {
    world.set_moving_axes(problem.axes);
    cost.set_moving_axes(problem.axes);
    SearchSpace space(robot, world, cost, problem, fast_settings, hooks);
    space.charge_exact(kExactCheckCost);
    const std::vector<Vector> rest = remainder(running, space.start(), live.reach);
    if (!rest.empty() && space.free(space.start())) {
      if (auto found = PathReplanner(space, problem, fast_settings, live).run(rest)) {
        found->result.checks = space.checks();
        return *found;
      }
    }
    spent = space.checks();
  }
  out.outcome = ReplanOutcome::blocked;
  out.before = kInfinite;
  if (is_valid && problem.budget > 0 && spent >= problem.budget) {
    out.result.checks = spent;
    out.result.reason =
        "no path onward was found within " + std::to_string(problem.budget) + " checks";
    return out;
  }
  Problem new_problem = problem;
  new_problem.budget -= std::min(new_problem.budget, spent);
  out.result = plan(robot, world, cost, new_problem, fast_settings, hooks);
  out.result.checks += spent;
  if (out.result.solved) out.outcome = ReplanOutcome::replanned;
  return out;
}

}  // namespace handsel::path_planner
