// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/offline/trajectory_lines.hpp"

#include <cmath>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/path/segment_table.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "common/trajectory/solve.hpp"

namespace handsel::command {

using nlohmann::json;

namespace {

json list_of(const Vector& v) { return std::vector<double>(v.begin(), v.end()); }

KinematicLimits limits_in(const json& line) {
  return {vector_of(line, "vmax"), vector_of(line, "amax"), vector_of(line, "jmax")};
}

/// Rejects numbers near the limits of a double, which give invalid results.
void require_finite(const Trajectory& trajectory) {
  const MotionState3 end = final_state(trajectory);
  if (!std::isfinite(trajectory.duration()) || !end.position.allFinite() ||
      !end.velocity.allFinite() || !end.acceleration.allFinite()) {
    throw LineError("the numbers are too large or too small to compute with");
  }
}

}  // namespace

json axes_of(const Trajectory& trajectory) {
  json axes = json::array();
  for (const AxisTrajectory& axis : trajectory.axes) {
    json segments = json::array();
    for (const Segment& s : axis.segments) segments.push_back({s.duration, s.jerk});
    axes.push_back({{"p0", axis.start.position},
                    {"v0", axis.start.velocity},
                    {"a0", axis.start.acceleration},
                    {"segments", segments}});
  }
  return axes;
}

Trajectory trajectory_in(const json& line) {
  const json& axes = field(line, "axes");
  if (!axes.is_array() || axes.empty())
    throw LineError("\"axes\" must be a list of axes, as trajectory solve writes it");
  Trajectory trajectory;
  for (const json& axis : axes) {
    AxisTrajectory out{{number(axis, "p0"), number(axis, "v0"), number(axis, "a0")}, {}};
    const json& segments = field(axis, "segments");
    if (!segments.is_array()) throw LineError("\"segments\" must be a list of [duration, jerk]");
    for (const json& segment : segments) {
      const Vector pair = vector_of(json{{"segments", segment}}, "segments");
      if (pair.size() != 2 || pair[0] < 0)
        throw LineError("a segment must be [duration, jerk], the duration not negative");
      out.segments.push_back({pair[0], pair[1]});
    }
    trajectory.axes.push_back(std::move(out));
  }
  require_finite(trajectory);
  constexpr double kSame = 1e-6;
  for (const AxisTrajectory& axis : trajectory.axes) {
    double sum = 0;
    for (const Segment& s : axis.segments) sum += s.duration;
    if (trajectory.duration() - sum > kSame) throw LineError("the axes do not last equally long");
  }
  return trajectory;
}

json solve_line(const json& line) {
  const MotionState3 from{vector_of(line, "p0"), vector_of(line, "v0"), vector_of(line, "a0")};
  const MotionState3 to{vector_of(line, "pf"), vector_of(line, "vf"), vector_of(line, "af")};
  Sync sync = Sync::time;
  if (line.contains("sync")) {
    const json& wanted = line["sync"];
    if (wanted != "time" && wanted != "none")
      throw LineError("\"sync\" must be \"time\" or \"none\"");
    if (wanted == "none") sync = Sync::none;
  }
  std::optional<double> imposed;
  if (line.contains("impose")) {
    if (!line["impose"].is_boolean()) throw LineError("\"impose\" must be true or false");
    if (line["impose"].get<bool>()) imposed = number(line, "duration");
  }
  const Solution solution = solve(from, to, limits_in(line), sync, imposed);
  if (!solution.ok()) throw LineError(solution.reason);
  require_finite(solution.trajectory);
  json out{{"duration", solution.trajectory.duration()},
           {"min_durations", solution.min_durations},
           {"axes", axes_of(solution.trajectory)}};
  if (imposed) out["excess"] = solution.excess;
  return out;
}

json smooth_line(const json& line) {
  const json& list = field(line, "nodes");
  if (!list.is_array()) throw LineError("\"nodes\" must be a list of lists of numbers");
  std::vector<Vector> nodes;
  for (const json& node : list) nodes.push_back(vector_of(json{{"nodes", node}}, "nodes"));
  SmoothSettings settings;
  if (line.contains("tau")) settings.tau = number(line, "tau");
  const SmoothResult result = smooth(nodes, limits_in(line), settings);
  if (!result.ok()) throw LineError(result.reason);
  require_finite(result.trajectory);
  json corners = json::array();
  for (const BlendReport& c : result.corners) {
    json corner{
        {"node", c.node}, {"method", name(c.method)}, {"excess", c.excess}, {"saved_s", c.saved}};
    if (!c.reason.empty()) corner["reason"] = c.reason;
    corners.push_back(corner);
  }
  return {{"duration", result.trajectory.duration()},
          {"duration_ptp", result.duration_ptp},
          {"corners", corners},
          {"axes", axes_of(result.trajectory)}};
}

json sample_line(const json& line, double period) {
  constexpr double kMaxSamples = 1e6;
  const Trajectory trajectory = trajectory_in(line);
  const SegmentTable table(trajectory);
  if (table.duration() / period > kMaxSamples)
    throw LineError("more than a million samples; take a longer --period");
  MotionState3 state = trajectory.at(0);
  json out{{"t", json::array()}, {"p", json::array()}, {"v", json::array()}, {"a", json::array()}};
  int cursor = 0;
  for (long k = 0;; ++k) {
    const double t = std::min(static_cast<double>(k) * period, table.duration());
    table.evaluate(t, cursor, state);
    out["t"].push_back(t);
    out["p"].push_back(list_of(state.position));
    out["v"].push_back(list_of(state.velocity));
    out["a"].push_back(list_of(state.acceleration));
    if (t >= table.duration()) return out;
  }
}

}  // namespace handsel::command
