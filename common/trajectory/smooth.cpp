#include "common/trajectory/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/trajectory/leg.hpp"
#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/three_segment.hpp"

namespace handsel {

namespace {

using detail::Leg;

constexpr double kLeastSaving = 1e-4;  // [s]
constexpr double kFarthest = 1e9;
constexpr std::array<double, 4> kReaches{1.0, 0.7, 0.45, 0.25};

struct Candidate {
  CornerMethod method{};
  double before{}, after{}, duration{}, excess{};
  double saved() const { return before + after - duration; }
};

/// A corner between two legs: states where a transition would start and end, and what a transition of a given duration costs.
class Corner {
 public:
  Corner(const Leg& a, const Leg& b, const KinematicLimits& limits) : a_(a), b_(b), limits_(limits), n_(a.from.size()) {}

  void place(double before, double after) {
    start_ = a_.path_state(a_.duration - before);
    end_ = b_.path_state(after);
  }
  double least_duration() const noexcept {
    double T = 0;
    for (Eigen::Index i = 0; i < n_; ++i) {
      if (!moves(i)) continue;
      AxisProblem problem;
      if (problem.init(a_.state(start_, i), b_.state(end_, i), limits_of(limits_, i)) != AxisOutcome::ok) return -1;
      T = std::max(T, problem.minimum());
    }
    return T;
  }
  /// Excess of three segments; gives up early beyond `enough`.
  double three_excess(double T, double enough) const noexcept {
    double worst = -1;
    for (Eigen::Index i = 0; i < n_; ++i) {
      if (!moves(i)) continue;
      const AxisState from = a_.state(start_, i);
      const auto g = three_segment(from, b_.state(end_, i), T);
      const double J = limits_.jerk[i];
      worst = std::max(worst, std::max({std::abs(g[0].jerk), std::abs(g[1].jerk), std::abs(g[2].jerk)}) / J - 1);
      if (worst > enough) return worst;
      worst = std::max(worst, excess(from, g.data(), 3, limits_of(limits_, i)));
      if (worst > enough) return worst;
    }
    return worst;
  }
  /// Excess when the second leg starts `shared` before the first ends.
  double overlap_excess(double shared, double enough) const noexcept {
    AxisProfile p, q;
    a_.part(a_.duration - shared, a_.duration, p);
    b_.part(0, shared, q);
    const AxisState from = a_.path_state(a_.duration - shared);
    double worst = -1;
    for (Eigen::Index i = 0; i < n_; ++i) {
      if (!moves(i)) continue;
      AxisProfile sum;
      add(p, a_.step[i], q, b_.step[i], sum);
      worst = std::max(worst, excess(a_.state(from, i), sum.segments.data(), sum.count, limits_of(limits_, i)));
      if (worst > enough) return worst;
    }
    return worst;
  }
  Trajectory build(const Candidate& c) {
    Trajectory out;
    place(c.before, c.after);
    AxisProfile p, q;
    if (c.method == CornerMethod::overlap) {
      a_.part(a_.duration - c.before, a_.duration, p);
      b_.part(0, c.after, q);
    }
    for (Eigen::Index i = 0; i < n_; ++i) {
      const AxisState from = a_.state(start_, i);
      AxisProfile profile;
      if (c.method == CornerMethod::overlap) {
        add(p, a_.step[i], q, b_.step[i], profile);
      } else {
        for (const Segment& g : three_segment(from, b_.state(end_, i), c.duration)) profile.push(g.duration, g.jerk);
      }
      out.axes.push_back({from, {profile.segments.begin(), profile.segments.begin() + profile.count}});
    }
    return out;
  }

 private:
  bool moves(Eigen::Index i) const noexcept { return a_.step[i] != 0 || b_.step[i] != 0; }
  static void add(const AxisProfile& p, double wp, const AxisProfile& q, double wq, AxisProfile& out) noexcept {
    int i = 0, k = 0;
    double left_p = p.segments[0].duration, left_q = q.segments[0].duration;
    while (i < p.count && k < q.count) {
      const double t = std::min(left_p, left_q);
      out.push(t, wp * p.segments[i].jerk + wq * q.segments[k].jerk);
      if ((left_p -= t) <= 0 && ++i < p.count) left_p = p.segments[i].duration;
      if ((left_q -= t) <= 0 && ++k < q.count) left_q = q.segments[k].duration;
    }
  }

  const Leg &a_, &b_;
  const KinematicLimits& limits_;
  Eigen::Index n_;
  AxisState start_, end_;
};

std::string percent(double x) {
  std::ostringstream out;
  out.precision(0);
  out << std::fixed << 100 * x << " %";
  return out.str();
}

/// Every transition worth trying at a corner, best first; `why` says what stood against the others.
std::vector<Candidate> candidates(const Leg& a, const Leg& b, const KinematicLimits& limits, const SmoothSettings& settings,
                                  std::string& why) {
  Corner corner(a, b, limits);
  std::vector<Candidate> found;
  const double reach_a = std::min(settings.tau.value_or(a.slowing), a.duration / 2);
  const double reach_b = std::min(settings.tau.value_or(b.slowing), b.duration / 2);
  double best = kLeastSaving, first_excess = 0;
  for (const double reach : kReaches) {
    if (!settings.three_segments && !settings.stretching) break;
    const double before = reach * reach_a, after = reach * reach_b, stop = before + after;
    corner.place(before, after);
    const double least = corner.least_duration();
    if (least <= 0 || stop - least <= best) continue;
    const double excess = corner.three_excess(least, 1e9);
    if (reach == kReaches.front()) first_excess = excess;
    if (excess <= settings.allowed_excess && settings.three_segments) {
      found.push_back({CornerMethod::three_segment, before, after, least, std::max(0.0, excess)});
      best = std::max(best, found.back().saved());
      continue;
    }
    if (!settings.stretching) continue;
    double bad = least, good = 0;
    for (int k = 1; k <= 10 && good == 0; ++k) {
      const double T = least + (stop - best - least) * k / 10;
      (corner.three_excess(T, settings.allowed_excess) <= settings.allowed_excess ? good : bad) = T;
    }
    if (good == 0) continue;
    for (int k = 0; k < 6; ++k) {
      const double T = 0.5 * (bad + good);
      (corner.three_excess(T, settings.allowed_excess) <= settings.allowed_excess ? good : bad) = T;
    }
    if (stop - good <= kLeastSaving) continue;
    found.push_back({CornerMethod::stretched, before, after, good, std::max(0.0, corner.three_excess(good, 1e9))});
    best = std::max(best, found.back().saved());
  }
  const double most = !settings.overlapping ? 0.0 : std::min({a.duration / 2, b.duration / 2, settings.tau.value_or(a.duration)});
  double good = 0, bad = most;
  for (int k = 10; k >= 1 && good == 0; --k) {
    const double shared = most * k / 10;
    (corner.overlap_excess(shared, 1e-9) <= 1e-9 ? good : bad) = shared;
  }
  if (good > 0 && good < most) {
    for (int k = 0; k < 6; ++k) {
      const double shared = 0.5 * (bad + good);
      (corner.overlap_excess(shared, 1e-9) <= 1e-9 ? good : bad) = shared;
    }
  }
  if (good > kLeastSaving) found.push_back({CornerMethod::overlap, good, good, good, 0});
  std::stable_sort(found.begin(), found.end(), [](const Candidate& x, const Candidate& y) { return x.saved() > y.saved(); });
  if (found.empty()) {
    why = std::min(reach_a, reach_b) <= kLeastSaving
              ? "tau leaves no room"
              : "no transition keeps the limits; three segments exceed them by " + percent(first_excess);
  }
  return found;
}

void add_leg(const Leg& leg, double begin, double end, Trajectory& out) {
  AxisProfile p;
  leg.part(begin, end, p);
  for (std::size_t i = 0; i < out.axes.size(); ++i) {
    const double d = leg.step[static_cast<Eigen::Index>(i)];
    for (int k = 0; k < p.count; ++k) out.axes[i].segments.push_back({p.segments[k].duration, d * p.segments[k].jerk});
  }
}

void add_piece(const Trajectory& piece, Trajectory& out) {
  for (std::size_t i = 0; i < out.axes.size(); ++i) {
    out.axes[i].segments.insert(out.axes[i].segments.end(), piece.axes[i].segments.begin(), piece.axes[i].segments.end());
  }
}

std::string why_bad_nodes(const std::vector<Eigen::VectorXd>& nodes, const SmoothSettings& settings) {
  if (nodes.empty()) return "there are no nodes";
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (nodes[k].size() != nodes[0].size()) {
      return "node " + std::to_string(k) + " has " + std::to_string(nodes[k].size()) + " axes, node 0 " + std::to_string(nodes[0].size());
    }
    if (!nodes[k].allFinite()) return "node " + std::to_string(k) + " has a number that is not finite";
    if (nodes[k].lpNorm<Eigen::Infinity>() > kFarthest) return "node " + std::to_string(k) + " has a number that is too large";
  }
  if (settings.tau && !(*settings.tau >= 0)) return "tau must be a number that is not negative";
  if (nodes[0].size() == 0) return "the nodes have no axes";
  return {};
}

}  // namespace

const char* name(CornerMethod method) {
  switch (method) {
    case CornerMethod::three_segment:
      return "three_segment";
    case CornerMethod::stretched:
      return "stretched";
    case CornerMethod::overlap:
      return "overlap";
    case CornerMethod::stop:
      return "stop";
  }
  return "";
}

Trajectory straight_motion(const Eigen::VectorXd& from, const Eigen::VectorXd& to, const KinematicLimits& limits) {
  Trajectory out;
  for (const double x : from) out.axes.push_back({{x, 0, 0}, {}});
  if (from != to) {
    const Leg leg(from, to, limits);
    add_leg(leg, 0, leg.duration, out);
  }
  return out;
}

SmoothResult smooth(const std::vector<Eigen::VectorXd>& nodes, const KinematicLimits& limits, const SmoothSettings& settings,
                    const CornerIsFree& is_free) {
  SmoothResult out;
  if (!(out.reason = why_bad_nodes(nodes, settings)).empty()) return out;
  if (!(out.reason = why_bad_limits(limits, static_cast<int>(nodes[0].size()))).empty()) return out;
  std::vector<Leg> legs;
  std::vector<int> node_of;
  legs.reserve(nodes.size());
  const Eigen::VectorXd* last = &nodes[0];
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    if ((nodes[k] - *last).lpNorm<Eigen::Infinity>() < 1e-12) continue;
    legs.emplace_back(*last, nodes[k], limits);
    node_of.push_back(static_cast<int>(k));
    last = &nodes[k];
    out.duration_ptp += legs.back().duration;
    if (!(legs.back().duration > 0) || !std::isfinite(legs.back().duration)) {
      out.reason = "the way to node " + std::to_string(k) + " cannot be computed with such limits";
      return out;
    }
  }
  for (const double x : nodes[0]) {
    out.trajectory.axes.push_back({{x, 0, 0}, {}});
    out.trajectory.axes.back().segments.reserve(10 * legs.size());
  }
  double begin = 0;
  for (std::size_t k = 0; k < legs.size(); ++k) {
    double end = legs[k].duration, next_begin = 0;
    Trajectory piece;
    if (k + 1 < legs.size()) {
      CornerReport report;
      report.node = node_of[k];
      const std::vector<Candidate> found = candidates(legs[k], legs[k + 1], limits, settings, report.reason);
      for (const Candidate& c : found) {
        Trajectory corner = Corner(legs[k], legs[k + 1], limits).build(c);
        if (is_free && !is_free(corner)) {
          report.reason = std::string(name(c.method)) + " collides";
          continue;
        }
        report.method = c.method;
        report.excess = c.excess;
        report.saved = c.saved();
        report.reason.clear();
        end -= c.before;
        next_begin = c.after;
        piece = std::move(corner);
        break;
      }
      out.corners.push_back(std::move(report));
    }
    add_leg(legs[k], begin, end, out.trajectory);
    if (!piece.axes.empty()) add_piece(piece, out.trajectory);
    begin = next_begin;
  }
  return out;
}

}  // namespace handsel
