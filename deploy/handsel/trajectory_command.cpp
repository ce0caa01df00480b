#include <iostream>
#include <memory>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/segment_table.hpp"
#include "common/trajectory/smooth.hpp"
#include "common/trajectory/solve.hpp"
#include "deploy/handsel/commands.hpp"
#include "deploy/handsel/json_lines.hpp"

namespace handsel {
namespace {

using nlohmann::json;
using namespace command;

json list_of(const Vector& v) { return std::vector<double>(v.begin(), v.end()); }

json axes_of(const Trajectory& trajectory) {
  json axes = json::array();
  for (const AxisTrajectory& axis : trajectory.axes) {
    json segments = json::array();
    for (const Segment& s : axis.segments) segments.push_back({s.duration, s.jerk});
    axes.push_back({{"p0", axis.start.position}, {"v0", axis.start.velocity}, {"a0", axis.start.acceleration}, {"segments", segments}});
  }
  return axes;
}

KinematicLimits limits_in(const json& line) { return {vector_of(line, "vmax"), vector_of(line, "amax"), vector_of(line, "jmax")}; }

json solve_line(const json& line) {
  const MotionState3 from{vector_of(line, "p0"), vector_of(line, "v0"), vector_of(line, "a0")};
  const MotionState3 to{vector_of(line, "pf"), vector_of(line, "vf"), vector_of(line, "af")};
  Sync sync = Sync::time;
  if (line.contains("sync")) {
    const json& wanted = line["sync"];
    if (wanted != "time" && wanted != "none") throw LineError("\"sync\" must be \"time\" or \"none\"");
    if (wanted == "none") sync = Sync::none;
  }
  std::optional<double> imposed;
  if (line.contains("impose")) {
    if (!line["impose"].is_boolean()) throw LineError("\"impose\" must be true or false");
    if (line["impose"].get<bool>()) imposed = number(line, "duration");
  }
  const Solution solution = solve(from, to, limits_in(line), sync, imposed);
  if (!solution.ok()) throw LineError(solution.reason);
  json out{{"duration", solution.trajectory.duration()}, {"min_durations", solution.min_durations}, {"axes", axes_of(solution.trajectory)}};
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
  json corners = json::array();
  for (const CornerReport& c : result.corners) {
    json corner{{"node", c.node}, {"method", name(c.method)}, {"excess", c.excess}, {"saved_s", c.saved}};
    if (!c.reason.empty()) corner["reason"] = c.reason;
    corners.push_back(corner);
  }
  return {{"duration", result.trajectory.duration()},
          {"duration_ptp", result.duration_ptp},
          {"corners", corners},
          {"axes", axes_of(result.trajectory)}};
}

Trajectory trajectory_in(const json& line) {
  const json& axes = field(line, "axes");
  if (!axes.is_array() || axes.empty()) throw LineError("\"axes\" must be a list of axes, as trajectory solve writes it");
  Trajectory trajectory;
  for (const json& axis : axes) {
    AxisTrajectory out{{number(axis, "p0"), number(axis, "v0"), number(axis, "a0")}, {}};
    const json& segments = field(axis, "segments");
    if (!segments.is_array()) throw LineError("\"segments\" must be a list of [duration, jerk]");
    for (const json& segment : segments) {
      const Vector pair = vector_of(json{{"segments", segment}}, "segments");
      if (pair.size() != 2 || pair[0] < 0) throw LineError("a segment must be [duration, jerk], the duration not negative");
      out.segments.push_back({pair[0], pair[1]});
    }
    trajectory.axes.push_back(std::move(out));
  }
  return trajectory;
}

json sample_line(const json& line, double period) {
  constexpr double kMostSamples = 1e6;
  const Trajectory trajectory = trajectory_in(line);
  const SegmentTable table(trajectory);
  if (table.duration() / period > kMostSamples) throw LineError("more than a million samples; take a longer --period");
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

CLI::App* batch(CLI::App* group, const char* name, const char* what, int& exit_code, std::function<json(const json&)> answer) {
  CLI::App* command = group->add_subcommand(name, what);
  command->add_flag("--json")->description("JSON Lines (always so)");
  command->callback([&exit_code, answer] { exit_code = for_each_line(std::cin, std::cout, answer); });
  return command;
}

}  // namespace

void add_trajectory_commands(CLI::App& app, int& exit_code) {
  CLI::App* group = app.add_subcommand("trajectory", "Jerk-limited motion: JSON Lines on stdin, one answer a line");
  group->require_subcommand(1);
  batch(group, "solve", "From state to state in minimum or imposed time", exit_code, solve_line)
      ->footer(
          "A line: {\"p0\",\"v0\",\"a0\",\"pf\",\"vf\",\"af\",\"vmax\",\"amax\",\"jmax\": lists over axes, "
          "\"sync\"?: \"time\"|\"none\", \"impose\"?: true, \"duration\"?}");
  batch(group, "smooth", "From a broken line to soft motion", exit_code, smooth_line)
      ->footer("A line: {\"nodes\":[[...],...],\"vmax\",\"amax\",\"jmax\",\"tau\"?}");
  auto period = std::make_shared<double>(0.01);
  batch(group, "sample", "States of trajectories (as solve and smooth write them) at regular times", exit_code,
        [period](const json& line) { return sample_line(line, *period); })
      ->add_option("--period", *period, "[s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

}  // namespace handsel
