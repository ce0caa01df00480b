// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/edit.hpp"

#include <algorithm>

#include "common/trajectory/min_time.hpp"

namespace handsel {

namespace {
AxisState end_of(const AxisTrajectory& axis) {
  AxisState s = axis.start;
  for (const Segment& g : axis.segments) s = advanced(s, g.duration, g.jerk);
  return s;
}
}  // namespace

Trajectory cut(const Trajectory& whole, double from, double to) {
  const double last = whole.duration();
  from = std::clamp(from, 0.0, last);
  to = std::clamp(to, from, last);
  Trajectory part;
  for (const AxisTrajectory& axis : whole.axes) {
    AxisTrajectory piece{axis.start, {}};
    double t = 0;
    for (const Segment& g : axis.segments) {
      const double end = t + g.duration;
      const double skip = std::clamp(from - t, 0.0, g.duration),
                   take = std::clamp(to - t, 0.0, g.duration) - skip;
      if (end <= from || skip > 0) piece.start = advanced(piece.start, skip, g.jerk);
      if (take > 0) piece.segments.push_back({take, g.jerk});
      t = end;
    }
    part.axes.push_back(std::move(piece));
  }
  return part;
}

void append(Trajectory& first, const Trajectory& next) {
  for (std::size_t i = 0; i < first.axes.size() && i < next.axes.size(); ++i) {
    auto& segments = first.axes[i].segments;
    segments.insert(segments.end(), next.axes[i].segments.begin(), next.axes[i].segments.end());
  }
}

Trajectory split_alike(const Trajectory& whole) {
  std::vector<double> instants{whole.duration()};
  for (const AxisTrajectory& axis : whole.axes) {
    double t = 0;
    for (const Segment& g : axis.segments) instants.push_back(t += g.duration);
  }
  std::sort(instants.begin(), instants.end());
  std::vector<double> kept;
  for (const double t : instants) {
    if (t > 0 && (kept.empty() || t - kept.back() > 1e-12)) kept.push_back(t);
  }
  Trajectory out;
  for (const AxisTrajectory& axis : whole.axes) {
    AxisTrajectory piece{axis.start, {}};
    std::size_t k = 0;
    double end = axis.segments.empty() ? 0 : axis.segments[0].duration, t = 0;
    for (const double next : kept) {
      const double middle = (t + next) / 2;
      while (k < axis.segments.size() && end <= middle)
        end += ++k < axis.segments.size() ? axis.segments[k].duration : 0;
      piece.segments.push_back({next - t, k < axis.segments.size() ? axis.segments[k].jerk : 0.0});
      t = next;
    }
    out.axes.push_back(std::move(piece));
  }
  return out;
}

Trajectory shifted(const Trajectory& whole, double by) {
  if (by < 0) return cut(whole, -by, whole.duration());
  Trajectory out = whole;
  if (by > 0) {
    for (AxisTrajectory& axis : out.axes) axis.segments.insert(axis.segments.begin(), {by, 0.0});
  }
  return out;
}

Trajectory reversed(const Trajectory& whole) {
  Trajectory out;
  for (const AxisTrajectory& axis : whole.axes) {
    const AxisState end = end_of(axis);
    AxisTrajectory back{{end.position, -end.velocity, end.acceleration}, axis.segments};
    std::reverse(back.segments.begin(), back.segments.end());
    for (Segment& s : back.segments) s.jerk = -s.jerk;
    out.axes.push_back(std::move(back));
  }
  return out;
}

Trajectory stretched(const Trajectory& whole, double factor) {
  Trajectory out = whole;
  for (AxisTrajectory& axis : out.axes) {
    axis.start.velocity /= factor;
    axis.start.acceleration /= factor * factor;
    for (Segment& s : axis.segments) s = {s.duration * factor, s.jerk / (factor * factor * factor)};
  }
  return out;
}

Trajectory to_trajectory(const SegmentTable& table) {
  Trajectory out;
  const auto n = static_cast<std::size_t>(table.axes());
  MotionState3 start = rest_state(Eigen::VectorXd::Zero(table.axes()));
  int cursor = 0;
  table.evaluate(0, cursor, start);
  for (int i = 0; i < table.axes(); ++i)
    out.axes.push_back({{start.position[i], start.velocity[i], start.acceleration[i]}, {}});
  for (int k = 0; k < table.segments(); ++k) {
    for (std::size_t i = 0; i < n; ++i)
      out.axes[i].segments.push_back({table.knot(k + 1) - table.knot(k), table.jerks(k)[i]});
  }
  return out;
}

MotionState3 final_state(const Trajectory& whole) {
  MotionState3 out;
  out.position.resize(whole.size());
  out.velocity.resize(whole.size());
  out.acceleration.resize(whole.size());
  for (int i = 0; i < whole.size(); ++i) {
    const AxisState s = end_of(whole.axes[i]);
    out.position[i] = s.position;
    out.velocity[i] = s.velocity;
    out.acceleration[i] = s.acceleration;
  }
  return out;
}

Trajectory standing(const Eigen::VectorXd& position) {
  Trajectory out;
  for (const double x : position) out.axes.push_back({{x, 0, 0}, {}});
  return out;
}

MotionState3 rest_state(const Eigen::VectorXd& position) {
  return {position, Eigen::VectorXd::Zero(position.size()), Eigen::VectorXd::Zero(position.size())};
}

}  // namespace handsel
