// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/eval/report.hpp"

#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "common/messages/names.hpp"

namespace handsel {
namespace {

using Json = nlohmann::json;

Json finite(double value) {
  return std::isfinite(value) && std::abs(value) < 1e8 ? Json(value) : Json(nullptr);
}

Json refusals(const Refusals& list) {
  Json result = Json::array();
  for (const Refusal& refusal : list)
    result.push_back({{"what", refusal.what}, {"reason", refusal.reason}});
  return result;
}

Json task_json(const TaskOutcome& outcome) {
  Json steps = Json::array();
  for (const StepOutcome& step : outcome.steps)
    steps.push_back(
        {{"step", step.step}, {"started_s", step.started}, {"duration_s", step.duration}});
  return {{"task", outcome.task},
          {"success", outcome.success},
          {"state", outcome.state},
          {"reason", outcome.reason},
          {"started_s", outcome.started},
          {"duration_s", outcome.duration},
          {"first_motion_s", outcome.first_motion < 0 ? Json() : Json(outcome.first_motion)},
          {"handover_s", outcome.handover < 0 ? Json() : Json(outcome.handover)},
          {"steps", std::move(steps)},
          {"refusals", refusals(outcome.refusals)}};
}

Json oracle_json(const GroundTruth& ground_truth) {
  return {
      {"carrier", ground_truth.carrier},
      {"held_s", ground_truth.held_time},
      {"constraint_s", ground_truth.constraint_time},
      {"contact_ratio", ground_truth.held_time > 0
                            ? Json(1 - ground_truth.constraint_time / ground_truth.held_time)
                            : Json(nullptr)},
      {"max_lifted_m", ground_truth.max_lifted},
      {"human_contact_before_release_s", ground_truth.human_contact_before_release},
      {"human_alone_s", ground_truth.human_alone},
      {"dropped", ground_truth.dropped},
      {"handover_done", ground_truth.handover_done},
      {"taken_with", ground_truth.taken ? Json(name(ground_truth.taking_side)) : Json(nullptr)},
      {"wrist_strain", ground_truth.taken ? Json(ground_truth.taking_wrist_strain) : Json(nullptr)},
      {"arm_strain", ground_truth.taken ? Json(ground_truth.taking_arm_strain) : Json(nullptr)},
      {"limit_violations", ground_truth.limit_violations},
      {"collisions", ground_truth.self_or_scene_collisions},
      {"contact_force_n", ground_truth.contact_force},
      {"peak_closing_speed_m_s", ground_truth.peak_closing_speed},
      {"commanders", ground_truth.commanders},
      {"hash", ground_truth.hash}};
}

std::string format(const char* pattern, double a, double b = 0, double c = 0) {
  char text[160];
  std::snprintf(text, sizeof text, pattern, a, b, c);
  return text;
}

}  // namespace

std::map<std::string, Counters> counters(const Snapshot& snapshot) {
  std::map<std::string, Counters> result;
  for (const auto& [component, seen] : snapshot.health) {
    Counters& sum = result[component];
    for (const TopicHealth& topic : seen.sample.topics) {
      sum.deadline_misses += topic.deadline_misses;
      sum.rejected += topic.rejected;
    }
  }
  return result;
}

nlohmann::json make_report(const ReportInputs& inputs, const Performer& performer,
                           const Observer& observer) {
  const Snapshot& seen = observer.snapshot();
  const GroundTruth& ground_truth = seen.ground_truth.sample;
  const ExecutionStatus& execution = seen.execution.sample;
  Json tasks = Json::array(), gathered = Json::array(), misses = Json::object(),
       rejected = Json::object(), timeline = Json::array();
  std::string failure;
  for (const TaskOutcome& outcome : performer.outcomes()) {
    tasks.push_back(task_json(outcome));
    for (const Json& refusal : tasks.back()["refusals"]) gathered.push_back(refusal);
    if (!outcome.success && failure.empty())
      failure = outcome.reason.empty() ? outcome.state : outcome.reason;
  }
  for (const auto& [component, now] : counters(seen)) {
    const auto before = inputs.before.find(component);
    const Counters base =
        before == inputs.before.end() || before->second.deadline_misses > now.deadline_misses
            ? Counters{}
            : before->second;
    misses[component] = now.deadline_misses - base.deadline_misses;
    rejected[component] = now.rejected - std::min(base.rejected, now.rejected);
  }
  for (const TimelineEvent& event : observer.timeline()) {
    timeline.push_back({{"t_s", to_seconds(event.at - performer.begin())}, {"event", event.text}});
  }
  const double sim_time = ground_truth.sim_time - inputs.ground_truth_before.sim_time;
  const double set_points =
      static_cast<double>(ground_truth.set_points - inputs.ground_truth_before.set_points);
  return {{"success", performer.succeeded()},
          {"failure", failure},
          {"scenario", inputs.scenario},
          {"robot", inputs.robot},
          {"seed", inputs.seed},
          {"human", seen.partner},
          {"ready_s", inputs.ready},
          {"duration_s", performer.duration()},
          {"tasks", std::move(tasks)},
          {"oracle", oracle_json(ground_truth)},
          {"min_robot_distance_m",
           seen.ground_truth.ever ? finite(ground_truth.min_robot_distance) : Json(nullptr)},
          {"min_separation_m",
           seen.ground_truth.ever ? finite(ground_truth.min_separation) : Json(nullptr)},
          {"ssm_violations", ground_truth.ssm_violations},
          {"limit_ratio",
           {{"v", ground_truth.limit_ratio_velocity},
            {"a", ground_truth.limit_ratio_acceleration},
            {"j", ground_truth.limit_ratio_jerk}}},
          {"limit_ratio_sent",
           {{"v", execution.limit_ratio_velocity},
            {"a", execution.limit_ratio_acceleration},
            {"j", execution.limit_ratio_jerk}}},
          {"deadline_misses", std::move(misses)},
          {"rejected", std::move(rejected)},
          {"refusals", std::move(gathered)},
          {"set_point_gap_max_s", ground_truth.setpoint_gap_max},
          {"set_points", ground_truth.set_points},
          {"set_point_rate_hz", sim_time > 0 ? Json(set_points / sim_time) : Json(nullptr)},
          {"cycles", execution.cycles},
          {"late_cycles", execution.late_cycles},
          {"late_ratio", execution.cycles ? static_cast<double>(execution.late_cycles) /
                                                static_cast<double>(execution.cycles)
                                          : 0.0},
          {"real_time_factor", ground_truth.real_time_factor},
          {"restarts", inputs.restarts},
          {"timeline", std::move(timeline)}};
}

std::string summary(const nlohmann::json& report) {
  std::string text;
  for (const Json& task : report["tasks"]) {
    text += (task["success"].get<bool>() ? "done    " : "failed  ") +
            task["task"].get<std::string>() +
            format(" in %.1f s", task["duration_s"].get<double>());
    if (!task["success"].get<bool>()) text += ": " + task["reason"].get<std::string>();
    text += "\n";
    for (const Json& step : task["steps"]) {
      text += format("          %5.1f s  ", step["started_s"].get<double>()) +
              step["step"].get<std::string>() +
              format(" (%.1f s)", step["duration_s"].get<double>()) + "\n";
    }
    if (task["success"].get<bool>()) continue;
    for (const Json& refusal : task["refusals"]) {
      text += "          refused " + refusal["what"].get<std::string>() + ": " +
              refusal["reason"].get<std::string>() + "\n";
    }
  }
  const Json& oracle = report["oracle"];
  text += format(
      "oracle  lifted %.2f m, person's hand on it %.2f s before release, person alone %.1f s\n",
      oracle["max_lifted_m"].get<double>(), oracle["human_contact_before_release_s"].get<double>(),
      oracle["human_alone_s"].get<double>());
  if (!oracle["contact_ratio"].is_null())
    text += format("hold    %.1f s in the robot's hand, %.0f %% of it by contact alone\n",
                   oracle["held_s"].get<double>(), 100 * oracle["contact_ratio"].get<double>());
  const Json& ratio = report["limit_ratio"];
  text += format("limits  v %.0f %%, a %.0f %%, j %.0f %% of what is allowed",
                 100 * ratio["v"].get<double>(), 100 * ratio["a"].get<double>(),
                 100 * ratio["j"].get<double>());
  text += "; " + std::to_string(oracle["limit_violations"].get<std::uint64_t>()) + " violations\n";
  text += report["min_separation_m"].is_null()
              ? std::string("nearest nobody came near\n")
              : format("nearest %.2f m to the person", report["min_separation_m"].get<double>()) +
                    "; " + std::to_string(report["ssm_violations"].get<std::uint64_t>()) +
                    " speed-and-separation violations\n";
  if (!report["set_point_rate_hz"].is_null()) {
    text += format("timing  %.0f set-points/s, longest gap %.1f ms, %.3f %% of cycles late",
                   report["set_point_rate_hz"].get<double>(),
                   1e3 * report["set_point_gap_max_s"].get<double>(),
                   100 * report["late_ratio"].get<double>());
    text += format(", real-time factor %.3f\n", report["real_time_factor"].get<double>());
  }
  std::uint64_t misses = 0, rejected = 0;
  for (const auto& [component, count] : report["deadline_misses"].items())
    misses += count.get<std::uint64_t>();
  for (const auto& [component, count] : report["rejected"].items())
    rejected += count.get<std::uint64_t>();
  text += "health  " + std::to_string(misses) + " deadline misses, " + std::to_string(rejected) +
          " rejected messages";
  for (const auto& [process, count] : report["restarts"].items())
    text += ", " + process + " restarted " + std::to_string(count.get<int>()) + " times";
  return text + "\n";
}

}  // namespace handsel
