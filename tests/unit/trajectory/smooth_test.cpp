// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/path/smooth.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"

namespace handsel::smooth_test {
namespace {

using Eigen::VectorXd;

VectorXd point(std::initializer_list<double> x) {
  VectorXd v(static_cast<Eigen::Index>(x.size()));
  std::copy(x.begin(), x.end(), v.begin());
  return v;
}

const KinematicLimits kFigure18{VectorXd::Constant(2, 0.1), VectorXd::Constant(2, 0.3),
                                VectorXd::Constant(2, 0.9)};

TEST(Smooth, straight_metre_of_figure18) {
  EXPECT_NEAR(straight_motion(point({0, 0}), point({1, 0}), kFigure18).duration(), 10.0 + 2.0 / 3.0,
              1e-12);
}

/// Runs a set of methods on random blends of 7 axes: checks every one and prints the figures of
/// docs/trajectory.md.
double smooth_corners(int corners, const SmoothSettings& settings, const char* title) {
  const std::uint64_t seed = 41;
  std::mt19937_64 random(seed);
  const auto draw = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  std::map<std::string, int> count;
  std::map<std::string, double> saved;
  double total = 0, stops = 0;
  for (int k = 0; k < corners; ++k) {
    const int n = 7;
    KinematicLimits l{VectorXd(n), VectorXd(n), VectorXd(n)};
    for (int i = 0; i < n; ++i)
      l.velocity[i] = draw(0.3, 2), l.acceleration[i] = draw(0.6, 4), l.jerk[i] = draw(2, 16);
    std::vector<VectorXd> nodes(3, VectorXd(n));
    for (VectorXd& q : nodes) {
      for (double& x : q) x = draw(-2, 2);
    }
    const SmoothResult r = smooth(nodes, l, settings);
    const auto fail = [&](const std::string& why) {
      ADD_FAILURE() << why << ", seed " << seed << " case " << k;
    };
    if (!r.ok()) return fail(r.reason), 0;
    const BlendReport& corner = r.corners[0];
    const MotionState3 end = final_state(r.trajectory);
    const double allowed =
        corner.method == BlendMethod::overlap || corner.method == BlendMethod::stop ? 1e-9
                                                                                    : 0.1 + 1e-9;
    if (const std::string why = why_not_within(r.trajectory, l, allowed); !why.empty())
      return fail(why), 0;
    if (limit_ratio(r.trajectory, l) > 1 + corner.excess + 1e-9)
      return fail("more excess than reported"), 0;
    if (r.trajectory.duration() > r.duration_ptp + 1e-9) return fail("longer than stopping"), 0;
    if (std::abs(r.trajectory.duration() - r.duration_ptp + corner.saved) > 1e-9)
      return fail("the saving is not what is reported"), 0;
    if ((end.position - nodes[2]).lpNorm<Eigen::Infinity>() > 1e-9 ||
        end.velocity.norm() + end.acceleration.norm() > 1e-9) {
      return fail("it does not end at rest at the last node"), 0;
    }
    ++count[name(corner.method)];
    saved[name(corner.method)] += corner.saved;
    total += corner.saved;
    stops += r.duration_ptp;
  }
  printf("%s, %d corners:\n", title, corners);
  for (const auto& [method, times] : count) {
    printf("  %-14s %5.1f %% of corners, mean saving %.3f s, %4.1f %% of all time\n",
           method.c_str(), 100.0 * times / corners, saved[method] / times,
           100 * saved[method] / stops);
  }
  printf("  time saved: %.1f %%\n", 100 * total / stops);
  return total / stops;
}

TEST(Smooth, corners_keep_their_limits_and_never_cost_time) {
  const int corners = 10000;
  const double all = smooth_corners(corners, {}, "best of all");
  SmoothSettings three, stretched, overlap;
  three.stretching = three.overlapping = false;
  stretched.three_segments = stretched.overlapping = false;
  overlap.three_segments = overlap.stretching = false;
  EXPECT_GE(all, smooth_corners(corners, three, "three segments alone"));
  EXPECT_GE(all, smooth_corners(corners, stretched, "stretched alone"));
  EXPECT_GE(all, smooth_corners(corners, overlap, "overlap alone"));
  EXPECT_GT(all, 0.1);
}

TEST(Smooth, the_predicate_is_offered_exactly_what_is_then_run) {
  std::mt19937_64 random(42);
  const auto draw = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  std::map<std::string, int> seen;
  for (int k = 0; k < 300; ++k) {
    const KinematicLimits l{VectorXd::Constant(3, draw(0.3, 2)),
                            VectorXd::Constant(3, draw(0.6, 4)),
                            VectorXd::Constant(3, draw(2, 16))};
    std::vector<VectorXd> nodes(3, VectorXd(3));
    for (VectorXd& q : nodes) {
      for (double& x : q) x = draw(-1, 1);
    }
    Trajectory offered;
    int refusals = k % 3;
    const SmoothResult r = smooth(nodes, l, {}, [&](const Trajectory& corner) {
      offered = corner;
      return refusals-- <= 0;
    });
    const BlendReport& c = r.corners[0];
    ++seen[name(c.method)];
    if (c.method == BlendMethod::stop) continue;
    // Begin of the blend: the time at which the whole trajectory is in the first state of the
    // blend.
    const double segment_duration = straight_motion(nodes[0], nodes[1], l).duration();
    double begin = -1;
    for (double t = 0; t <= segment_duration && begin < 0; t += segment_duration / 4000) {
      if ((r.trajectory.at(t).position - offered.at(0).position).norm() < 2e-3) begin = t;
    }
    ASSERT_GE(begin, 0);
    for (int i = 0; i <= 40; ++i) {
      const double t = offered.duration() * i / 40;
      ASSERT_LT((r.trajectory.at(begin + t).position - offered.at(t).position).norm(), 1e-2)
          << name(c.method) << " case " << k;
    }
  }
  EXPECT_GT(seen["overlap"], 20);
  EXPECT_GT(seen["three_segment"] + seen["stretched"], 20);
}

TEST(Smooth, tau_zero_stops_at_the_node) {
  const std::vector<VectorXd> nodes{point({0, 0}), point({1, 0}), point({0.4, 0.8})};
  SmoothSettings settings;
  settings.tau = 0;
  const SmoothResult stop = smooth(nodes, kFigure18, settings);
  ASSERT_TRUE(stop.ok());
  EXPECT_EQ(stop.corners[0].method, BlendMethod::stop);
  EXPECT_NE(stop.corners[0].reason, "");
  EXPECT_NEAR(stop.trajectory.duration(), stop.duration_ptp, 1e-12);
  settings.tau = 1.0;
  EXPECT_LT(smooth(nodes, kFigure18, settings).trajectory.duration(), stop.duration_ptp - 0.1);
}

/// Returns the min scales between two places of a path segment.
LimitScale scale_between(const LimitZones& zones, double from, double to) {
  LimitScale least;
  double begin = 0;
  for (const LimitZone& zone : zones) {
    if (begin <= to && from <= zone.end) {
      least.velocity = std::min(least.velocity, zone.scale.velocity);
      least.acceleration = std::min(least.acceleration, zone.scale.acceleration);
      least.jerk = std::min(least.jerk, zone.scale.jerk);
    }
    begin = zone.end;
  }
  return least;
}

/// Returns the scales at a place of a path segment; at the border of two zones, the higher ones.
LimitScale scale_at(const LimitZones& zones, double s) {
  const LimitScale a = scale_between(zones, s - 1e-7, s - 1e-7),
                   b = scale_between(zones, s + 1e-7, s + 1e-7);
  return {std::max(a.velocity, b.velocity), std::max(a.acceleration, b.acceleration),
          std::max(a.jerk, b.jerk)};
}

KinematicLimits scaled(const KinematicLimits& limits, const LimitScale& scale) {
  return {scale.velocity * limits.velocity, scale.acceleration * limits.acceleration,
          scale.jerk * limits.jerk};
}

/// Returns the ratio along the straight line from a to b, and the distance from the line.
std::pair<double, double> place_on(const VectorXd& a, const VectorXd& b, const VectorXd& q) {
  const double s = std::clamp((q - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return {s, (q - a - s * (b - a)).norm()};
}

/// Corners of lines with zones, and the durations of all lines [s].
struct ZonedLines {
  int smoothed{}, stops{};
  double zoned{}, at_lowest{};
};

/// Smooths random lines with random zones and checks each state; `all`: the zones scale
/// acceleration and jerk as well.
ZonedLines smooth_with_zones(bool all) {
  const std::uint64_t seed = 43;
  std::mt19937_64 random(seed);
  const auto draw = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  constexpr int kLines = 300, kAxes = 7;
  const KinematicLimits limits{VectorXd::Constant(kAxes, 0.5), VectorXd::Constant(kAxes, 1),
                               VectorXd::Constant(kAxes, 3)};
  double unhindered = 0;
  ZonedLines out;
  for (int line = 0; line < kLines; ++line) {
    std::vector<VectorXd> nodes(static_cast<std::size_t>(2 + random() % 4), VectorXd(kAxes));
    for (VectorXd& q : nodes)
      for (double& x : q) x = draw(-1.2, 1.2);
    std::vector<LimitZones> speeds(nodes.size() - 1);
    LimitScale lowest;
    const auto draw_scale = [&] {
      const double velocity = draw(0.2, 1);
      return all ? LimitScale{velocity, draw(0.2, 1), draw(0.2, 1)} : LimitScale{velocity};
    };
    for (LimitZones& zones : speeds) {
      for (double end = draw(0.02, 0.4); end < 1; end += draw(0.02, 0.4))
        zones.push_back({end, draw_scale()});
      zones.push_back({1, draw_scale()});
      lowest = lowest.lower(scale_between(zones, 0, 1));
    }
    const auto where = [&] {
      return "seed " + std::to_string(seed) + " line " + std::to_string(line);
    };
    const SmoothResult r = smooth(
        nodes, limits, {},
        [&](const Trajectory& corner) {
          std::size_t node = 0;
          double least = 1e-7;
          const VectorXd left = corner.at(0).position,
                         joined = corner.at(corner.duration()).position;
          for (std::size_t k = 1; k + 1 < nodes.size(); ++k)
            if (const double d = place_on(nodes[k - 1], nodes[k], left).second +
                                 place_on(nodes[k], nodes[k + 1], joined).second;
                d < least) {
              node = k;
              least = d;
            }
          if (node == 0) return ADD_FAILURE() << where() << ": a corner of no node", true;
          const LimitScale scale =
              scale_between(speeds[node - 1],
                            place_on(nodes[node - 1], nodes[node], left).first + 1e-9, 1)
                  .lower(
                      scale_between(speeds[node], 0,
                                    place_on(nodes[node], nodes[node + 1], joined).first - 1e-9));
          EXPECT_EQ(why_not_within(corner, scaled(limits, scale), 0.1 + 1e-6), "") << where();
          return true;
        },
        speeds);
    EXPECT_TRUE(r.ok()) << r.reason;
    for (const BlendReport& corner : r.corners)
      ++(corner.method == BlendMethod::stop ? out.stops : out.smoothed);
    EXPECT_EQ(why_not_within(r.trajectory, limits, 0.1 + 1e-9), "") << where();
    EXPECT_LE(r.trajectory.duration(), r.duration_ptp + 1e-9) << where();
    EXPECT_LT((final_state(r.trajectory).position - nodes.back()).lpNorm<Eigen::Infinity>(), 1e-9)
        << where();
    double sum = 0;
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
      sum += r.segment_durations[k];
      const Trajectory motion = straight_motion(nodes[k], nodes[k + 1], limits, speeds[k]);
      EXPECT_EQ(why_not_within(motion, limits, 1e-9), "") << where();
      EXPECT_LE(motion.duration(), straight_motion(nodes[k], nodes[k + 1], limits,
                                                   {{1, scale_between(speeds[k], 0, 1)}})
                                           .duration() +
                                       1e-9);
      EXPECT_GE(motion.duration(),
                straight_motion(nodes[k], nodes[k + 1], limits).duration() - 1e-9);
      for (int i = 0; i <= 500; ++i) {
        const MotionState3 state = motion.at(motion.duration() * i / 500);
        const auto [s, off] = place_on(nodes[k], nodes[k + 1], state.position);
        EXPECT_LT(off, 1e-9) << where();
        const LimitScale scale = scale_at(speeds[k], s);
        EXPECT_LE(state.velocity.cwiseAbs().maxCoeff(), 0.5 * scale.velocity + 1e-7)
            << where() << " leg " << k << " at " << s;
        EXPECT_LE(state.acceleration.cwiseAbs().maxCoeff(), scale.acceleration + 1e-5)
            << where() << " leg " << k << " at " << s;
      }
      for (const AxisTrajectory& axis : motion.axes) {
        double begin = 0;
        for (const Segment& segment : axis.segments) {
          const double middle = begin + segment.duration / 2;
          begin += segment.duration;
          if (segment.duration < 1e-6) continue;
          const double s = place_on(nodes[k], nodes[k + 1], motion.at(middle).position).first;
          EXPECT_LE(std::abs(segment.jerk), 3 * scale_at(speeds[k], s).jerk + 1e-6)
              << where() << " leg " << k << " at " << s;
        }
      }
    }
    EXPECT_NEAR(sum, r.duration_ptp, 1e-9);
    out.zoned += r.trajectory.duration();
    out.at_lowest += smooth(nodes, scaled(limits, lowest)).trajectory.duration();
    unhindered += smooth(nodes, limits).trajectory.duration();
  }
  std::printf(
      "seed %llu: %d lines, %d corners, %d keep their stop: %.0f s; %.0f s at the lowest scales "
      "all "
      "along, %.0f s unhindered\n",
      static_cast<unsigned long long>(seed), kLines, out.smoothed + out.stops, out.stops, out.zoned,
      out.at_lowest, unhindered);
  return out;
}

TEST(Smooth, speed_follows_the_zones_of_the_legs_exactly) {
  const ZonedLines lines = smooth_with_zones(false);
  EXPECT_LT(lines.zoned, 0.9 * lines.at_lowest);
  EXPECT_LT(lines.stops, lines.smoothed / 20);
}

TEST(Smooth, acceleration_and_jerk_follow_the_zones_of_the_legs_as_well) {
  const ZonedLines lines = smooth_with_zones(true);
  EXPECT_LT(lines.zoned, 0.9 * lines.at_lowest);
  // A blend that reaches a second zone of lower limits is replaced by a stop.
  EXPECT_LT(lines.stops, lines.smoothed / 7);
}

TEST(Smooth, one_share_everywhere_is_that_limit) {
  const std::vector<VectorXd> nodes = {point({0, 0}), point({1, 0}), point({1, 1})};
  const LimitScale scale{0.5, 0.6, 0.7};
  const KinematicLimits half = scaled(kFigure18, scale);
  const LimitZones zones = {{0.3, scale}, {0.6, scale}, {1, scale}};
  EXPECT_NEAR(smooth(nodes, kFigure18, {}, {}, {zones, zones}).trajectory.duration(),
              smooth(nodes, half).trajectory.duration(), 1e-9);
  EXPECT_NE(smooth(nodes, kFigure18, {}, {}, {zones}).reason, "");
  for (const LimitScale& bad : {LimitScale{0, 1, 1}, LimitScale{1, 1.1, 1}, LimitScale{1, 1, -1}})
    EXPECT_NE(smooth(nodes, kFigure18, {}, {}, {zones, {{1, bad}}}).reason, "");
}

TEST(Smooth, a_forbidden_corner_keeps_its_stop_and_says_why) {
  const std::vector<VectorXd> nodes{point({0, 0}), point({1, 0}), point({1, 1}), point({2, 1})};
  int asked = 0;
  const SmoothResult r = smooth(nodes, kFigure18, {}, [&asked](const Trajectory& corner) {
    ++asked;
    return corner.axes[0].start.position > 0.95;
  });
  ASSERT_TRUE(r.ok());
  ASSERT_EQ(r.corners.size(), 2u);
  EXPECT_GT(asked, 1);
  for (const BlendReport& c : r.corners)
    EXPECT_EQ(c.method == BlendMethod::stop, !c.reason.empty());
  const SmoothResult none = smooth(nodes, kFigure18, {}, [](const Trajectory&) { return false; });
  EXPECT_NEAR(none.trajectory.duration(), none.duration_ptp, 1e-9);
  EXPECT_NE(none.corners[1].reason, "");
}

TEST(Smooth, refuses_bad_nodes_and_limits) {
  EXPECT_NE(smooth({}, kFigure18).reason, "");
  EXPECT_NE(smooth({point({0, 0}), point({1})}, kFigure18).reason, "");
  EXPECT_NE(smooth({point({0, 0}), point({1, std::nan("")})}, kFigure18).reason, "");
  EXPECT_NE(smooth({point({0}), point({1})}, kFigure18).reason, "");
  const SmoothResult same = smooth({point({0, 1}), point({0, 1})}, kFigure18);
  EXPECT_TRUE(same.ok());
  EXPECT_EQ(same.trajectory.duration(), 0);
}

}  // namespace
}  // namespace handsel::smooth_test
