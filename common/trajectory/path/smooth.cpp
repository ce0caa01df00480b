// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/path/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/path/path_segment.hpp"
#include "common/trajectory/path/waypoint_blend.hpp"

namespace handsel {

namespace {

using detail::PathSegment;
using detail::WaypointBlend;

constexpr double kMinSaving = 1e-4;     // min saved time of a transition [s]
constexpr double kMaxCoordinate = 1e9;  // max value of node coordinates and excesses
constexpr double kPathRounding = 1e-9;
constexpr std::array<double, 4> kReaches{1.0, 0.7, 0.45, 0.25};

struct Candidate {
  BlendMethod method{BlendMethod::stop};
  double before{}, after{}, duration{}, excess{};
  double saved() const { return before + after - duration; }
};

std::string percent(double x) {
  std::ostringstream out;
  out.precision(0);
  out << std::fixed << 100 * x << " %";
  return out.str();
}

/// Returns the useful transitions at a waypoint, best first; `why` is the reason if there is none.
std::vector<Candidate> candidates(WaypointBlend& corner, const PathSegment& a, const PathSegment& b,
                                  const SmoothSettings& settings, bool only_best,
                                  std::string& why) {
  std::vector<Candidate> found;
  double best = kMinSaving, first_excess = 0;
  const auto keep = [&](const Candidate& c) {
    found.push_back(c);
    best = std::max(best, c.saved());
  };
  const double max_shared =
      !settings.overlapping
          ? 0.0
          : std::min({a.duration / 2, b.duration / 2, settings.tau.value_or(a.duration)});
  double good = 0, bad = max_shared;
  for (int k = 10; k >= 1 && good == 0; --k) {
    const double shared = max_shared * k / 10;
    (corner.overlap_excess(shared, kPathRounding) <= kPathRounding ? good : bad) = shared;
  }
  for (int k = 0; k < 6 && good > 0 && good < max_shared; ++k) {
    const double shared = 0.5 * (bad + good);
    (corner.overlap_excess(shared, kPathRounding) <= kPathRounding ? good : bad) = shared;
  }
  if (good > kMinSaving) keep({BlendMethod::overlap, good, good, good, 0});
  if (!only_best) best = kMinSaving;
  const double reach_a = std::min(settings.tau.value_or(a.slowing), a.duration / 2);
  const double reach_b = std::min(settings.tau.value_or(b.starting), b.duration / 2);
  for (const double reach : kReaches) {
    if (!settings.three_segments && !settings.stretching) break;
    const double before = reach * reach_a, after = reach * reach_b, stop = before + after;
    if (stop <= best) break;
    corner.place(before, after);
    const auto fits = [&](double T) {
      return corner.three_excess(T, settings.allowed_excess) <= settings.allowed_excess;
    };
    if (best > kMinSaving && !fits(stop - best)) continue;
    const double min_duration = corner.min_duration();
    if (min_duration <= 0 || stop - min_duration <= best) continue;
    const double excess = corner.three_excess(min_duration, kMaxCoordinate);
    if (reach == kReaches.front()) first_excess = excess;
    if (excess <= settings.allowed_excess && settings.three_segments) {
      keep({BlendMethod::three_segment, before, after, min_duration, std::max(0.0, excess)});
      continue;
    }
    if (!settings.stretching) continue;
    double short_of = min_duration, fitting = 0;
    for (int k = 1; k <= 10 && fitting == 0; ++k) {
      const double T = min_duration + (stop - best - min_duration) * k / 10;
      (fits(T) ? fitting : short_of) = T;
    }
    if (fitting == 0) continue;
    for (int k = 0; k < 6; ++k) {
      const double T = 0.5 * (short_of + fitting);
      (fits(T) ? fitting : short_of) = T;
    }
    if (stop - fitting <= kMinSaving) continue;
    keep({BlendMethod::stretched, before, after, fitting,
          std::max(0.0, corner.three_excess(fitting, kMaxCoordinate))});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& x, const Candidate& y) { return x.saved() > y.saved(); });
  if (found.empty()) {
    why = std::min(reach_a, reach_b) <= kMinSaving
              ? "tau leaves no room"
              : "no transition keeps the limits; three segments exceed them by " +
                    percent(first_excess);
  }
  return found;
}

/// Evaluates a candidate again, so that the blend stores its segments.
void settle(WaypointBlend& corner, const Candidate& c) {
  if (c.method == BlendMethod::overlap) {
    corner.overlap_excess(c.before, kMaxCoordinate);
  } else {
    corner.place(c.before, c.after);
    corner.three_excess(c.duration, kMaxCoordinate);
  }
}

void add_path_segment(const PathSegment& path_segment, double begin, double end, Trajectory& out) {
  for (std::size_t k = 0; k < path_segment.knots.size(); ++k) {
    const double ends =
        k + 1 < path_segment.knots.size() ? path_segment.knots[k + 1].time : path_segment.duration;
    const double lasts = std::min(end, ends) - std::max(begin, path_segment.knots[k].time);
    if (!(lasts > 0)) continue;
    for (std::size_t i = 0; i < out.axes.size(); ++i)
      out.axes[i].segments.push_back({lasts, path_segment.step[static_cast<Eigen::Index>(i)] *
                                                 path_segment.knots[k].segment.jerk});
  }
}

bool is_factor(double x) { return x > 0 && x <= 1; }

std::string why_bad_speeds(const std::vector<LimitZones>& speeds, std::size_t nodes) {
  if (!speeds.empty() && speeds.size() + 1 != nodes)
    return "there are speeds of " + std::to_string(speeds.size()) +
           " path segments, the nodes make " + std::to_string(nodes - 1);
  for (const LimitZones& path_segment : speeds)
    for (const LimitZone& zone : path_segment)
      if (!is_factor(zone.scale.velocity) || !is_factor(zone.scale.acceleration) ||
          !is_factor(zone.scale.jerk) || !std::isfinite(zone.end))
        return "a scale of the limits must be in (0, 1]";
  return {};
}

/// Gives the zones on both sides of a node the lower acceleration and jerk of both: a transition
/// keeps the lower ones, and one segment stops as the next one starts.
void match_at_node(LimitZones& before, LimitZones& after) {
  const LimitScale both = before.back().scale.lower(after.front().scale);
  for (LimitScale* scale : {&before.back().scale, &after.front().scale}) {
    scale->acceleration = both.acceleration;
    scale->jerk = both.jerk;
  }
}

std::string why_bad_nodes(const std::vector<Eigen::VectorXd>& nodes,
                          const SmoothSettings& settings) {
  if (nodes.empty()) return "there are no nodes";
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (nodes[k].size() != nodes[0].size()) {
      return "node " + std::to_string(k) + " has " + std::to_string(nodes[k].size()) +
             " axes, node 0 " + std::to_string(nodes[0].size());
    }
    if (!nodes[k].allFinite())
      return "node " + std::to_string(k) + " has a number that is not finite";
    if (nodes[k].lpNorm<Eigen::Infinity>() > kMaxCoordinate)
      return "node " + std::to_string(k) + " has a number that is too large";
  }
  if (settings.tau && !(*settings.tau >= 0)) return "tau must be a number that is not negative";
  if (nodes[0].size() == 0) return "the nodes have no axes";
  return {};
}

}  // namespace

LimitScale LimitScale::lower(const LimitScale& other) const {
  return {std::min(velocity, other.velocity), std::min(acceleration, other.acceleration),
          std::min(jerk, other.jerk)};
}

const char* name(BlendMethod method) {
  switch (method) {
    case BlendMethod::three_segment:
      return "three_segment";
    case BlendMethod::stretched:
      return "stretched";
    case BlendMethod::overlap:
      return "overlap";
    case BlendMethod::stop:
      return "stop";
  }
  return "";
}

Trajectory straight_motion(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                           const KinematicLimits& limits, const LimitZones& speeds) {
  Trajectory out;
  for (const double x : from) out.axes.push_back({{x, 0, 0}, {}});
  if (from != to) {
    const PathSegment path_segment(from, to, limits, speeds);
    add_path_segment(path_segment, 0, path_segment.duration, out);
  }
  return out;
}

SmoothResult smooth(const std::vector<Eigen::VectorXd>& nodes, const KinematicLimits& limits,
                    const SmoothSettings& settings, const BlendIsFree& is_free,
                    const std::vector<LimitZones>& speeds) {
  SmoothResult out;
  if (!(out.reason = why_bad_nodes(nodes, settings)).empty()) return out;
  if (!(out.reason = why_bad_speeds(speeds, nodes.size())).empty()) return out;
  if (!(out.reason = why_bad_limits(limits, static_cast<int>(nodes[0].size()))).empty()) return out;
  std::vector<int> node_of;  // node at the end of each path segment
  std::vector<LimitZones> zones;
  for (std::size_t k = 1, last = 0; k < nodes.size(); ++k) {
    if ((nodes[k] - nodes[last]).lpNorm<Eigen::Infinity>() < 1e-12) continue;
    node_of.push_back(static_cast<int>(k));
    zones.push_back(speeds.empty() ? LimitZones{} : speeds[k - 1]);
    if (zones.back().empty()) zones.back().push_back({});
    if (zones.size() > 1) match_at_node(zones[zones.size() - 2], zones.back());
    last = k;
  }
  std::vector<PathSegment> path_segments;
  path_segments.reserve(nodes.size());
  out.segment_durations.assign(nodes.size() - 1, 0.0);
  for (std::size_t i = 0; i < node_of.size(); ++i) {
    const auto to = static_cast<std::size_t>(node_of[i]),
               from = i == 0 ? 0 : static_cast<std::size_t>(node_of[i - 1]);
    path_segments.emplace_back(nodes[from], nodes[to], limits, zones[i]);
    const double duration = path_segments.back().duration;
    out.duration_ptp += out.segment_durations[to - 1] = duration;
    if (!(duration > 0) || !std::isfinite(duration)) {
      out.reason =
          "the motion to node " + std::to_string(to) + " cannot be computed with such limits";
      return out;
    }
  }
  for (const double x : nodes[0]) {
    out.trajectory.axes.push_back({{x, 0, 0}, {}});
    out.trajectory.axes.back().segments.reserve(10 * path_segments.size());
  }
  const detail::SegmentBatch batch(path_segments, limits);
  double begin = 0;
  for (std::size_t k = 0; k < path_segments.size(); ++k) {
    if (k + 1 == path_segments.size()) {
      add_path_segment(path_segments[k], begin, path_segments[k].duration, out.trajectory);
      break;
    }
    BlendReport report;
    report.node = node_of[k];
    WaypointBlend corner(path_segments, k, batch, limits);
    Candidate taken;
    for (const Candidate& c : candidates(corner, path_segments[k], path_segments[k + 1], settings,
                                         !is_free, report.reason)) {
      settle(corner, c);
      if (is_free && !is_free(corner.piece())) {
        report.reason = std::string(name(c.method)) + " collides";
        continue;
      }
      taken = c;
      report.method = c.method;
      report.excess = c.excess;
      report.saved = c.saved();
      report.reason.clear();
      break;
    }
    out.corners.push_back(std::move(report));
    add_path_segment(path_segments[k], begin, path_segments[k].duration - taken.before,
                     out.trajectory);
    if (taken.method != BlendMethod::stop) corner.add_to(out.trajectory);
    begin = taken.after;
  }
  return out;
}

}  // namespace handsel
