// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/status.hpp"

#include <cstdio>
#include <set>

#include <nlohmann/json.hpp>

#include "common/messages/names.hpp"
#include "deploy/handsel/system/processes.hpp"

namespace handsel {
namespace {

ProcessLine line_of(const std::string& component, const Snapshot& snapshot, TimePoint now) {
  ProcessLine line{.component = component, .state = "missing"};
  const auto found = snapshot.health.find(component);
  if (found == snapshot.health.end()) return line;
  const ComponentHealth& health = found->second.sample;
  const bool not_running =
      health.state == HealthState::stopping && health.pid == 0;  // reported by its launcher
  line.state = now - found->second.arrival > kSilent ? "silent"
               : not_running                         ? "restarting"
                                                     : name(health.state);
  line.reason = health.reason;
  line.memory_mb = health.memory_mb;
  line.cpu = health.cpu;
  line.uptime = health.uptime;
  line.pid = health.pid;
  for (const TopicHealth& topic : health.topics) {
    line.rate += topic.rate;
    line.deadline_misses += topic.deadline_misses;
    line.rejected += topic.rejected;
    line.refused += topic.refused;
    if (!topic.second_writer.empty())
      line.second_writers +=
          (line.second_writers.empty() ? "" : ", ") + topic.topic + ": " + topic.second_writer;
  }
  return line;
}

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[320];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

}  // namespace

std::string robot_side(const Snapshot& snapshot) {
  return snapshot.health.contains("driver") && !snapshot.health.contains("sim") ? "driver" : "sim";
}

SystemStatus make_status(const Snapshot& snapshot, TimePoint now) {
  SystemStatus status;
  std::set<std::string> listed;
  for (const std::string process : kProcesses) {
    const std::string component = process == "sim" ? robot_side(snapshot) : process;
    status.processes.push_back(line_of(component, snapshot, now));
    listed.insert(component);
  }
  for (const auto& [component, seen] : snapshot.health)
    if (!listed.contains(component)) status.processes.push_back(line_of(component, snapshot, now));
  for (const auto& [component, seen] : snapshot.health)
    for (const NamedCount& one : seen.sample.left_out)
      status.left_out.push_back(component + ": " + one.name + ": " + std::to_string(one.count));
  for (const ProcessLine& line : status.processes) {
    if (line.state == "ok") continue;
    status.troubles.push_back(line.component + " is " + line.state +
                              (line.reason.empty() ? "" : ": " + line.reason));
  }
  const ExecutionStatus& execution = snapshot.execution.sample;
  if (snapshot.execution.ever && (execution.mode != Mode::normal || execution.causes != 0)) {
    const std::string causes = cause_names(execution.causes);
    status.troubles.push_back("mode " + std::string(name(execution.mode)) +
                              (causes.empty() ? "" : " because of " + causes) +
                              (execution.reason.empty() ? "" : ": " + execution.reason));
  }
  if (snapshot.safety.ever) {
    const SafetyState& safety = snapshot.safety.sample;
    if (!safety.reason.empty()) status.troubles.push_back("held: " + safety.reason);
    if (safety.override_factor < 1.0)
      status.troubles.push_back(format("speed override %.0f %%; next: handsel speed 100",
                                       100.0 * safety.override_factor));
    for (const Person& person : safety.lost)
      status.troubles.push_back(
          person.id +
          format(" has been out of sight for %.0f s; next, when gone: handsel task clear-person ",
                 person.age) +
          person.id);
  }
  return status;
}

nlohmann::json to_json(const SystemStatus& status, const Snapshot& snapshot, TimePoint now) {
  nlohmann::json processes = nlohmann::json::array(), clocks = nlohmann::json::object();
  for (const ProcessLine& line : status.processes) {
    processes.push_back({{"component", line.component},
                         {"state", line.state},
                         {"reason", line.reason},
                         {"rate_hz", line.rate},
                         {"deadline_misses", line.deadline_misses},
                         {"rejected", line.rejected},
                         {"refused", line.refused},
                         {"second_writers", line.second_writers},
                         {"memory_mb", line.memory_mb},
                         {"cpu", line.cpu},
                         {"uptime_s", line.uptime},
                         {"pid", line.pid}});
  }
  for (const BehaviourState& behaviour : snapshot.attention.sample.behaviours) {
    clocks[name(behaviour.behaviour)] = {{"period_s", behaviour.period},
                                         {"released", behaviour.released},
                                         {"speed_factor", behaviour.speed_factor}};
  }
  nlohmann::json result{{"processes", std::move(processes)},
                        {"troubles", status.troubles},
                        {"left_out", status.left_out},
                        {"clocks", std::move(clocks)}};
  if (snapshot.task.ever) {
    const TaskStatus& task = snapshot.task.sample;
    result["task"] = {{"id", task.id},     {"kind", name(task.kind)}, {"state", name(task.state)},
                      {"plan", task.plan}, {"step", task.step},       {"reason", task.reason}};
  }
  if (snapshot.action.ever) result["phase"] = phase_text(snapshot.action.sample);
  if (snapshot.execution.ever) {
    const ExecutionStatus& execution = snapshot.execution.sample;
    result["mode"] = name(execution.mode);
    result["causes"] = cause_names(execution.causes);
    result["trajectory"] = {{"id", execution.trajectory}, {"progress", execution.progress}};
    result["cycles"] = execution.cycles;
    result["late_cycles"] = execution.late_cycles;
    result["age_s"] = to_seconds(now - snapshot.execution.arrival);
  }
  if (snapshot.safety.ever) {
    const SafetyState& safety = snapshot.safety.sample;
    nlohmann::json lost = nlohmann::json::array();
    for (const Person& person : safety.lost)
      lost.push_back({{"id", person.id}, {"age_s", person.age}});
    result["safety"] = {{"revision", safety.revision},
                        {"paused", safety.paused},
                        {"fault", safety.fault},
                        {"awaits_person", safety.awaits_person},
                        {"override_factor", safety.override_factor},
                        {"reason", safety.reason},
                        {"lost", std::move(lost)}};
  }
  if (snapshot.advice.ever) result["advised_speed_factor"] = snapshot.advice.sample.speed_factor;
  return result;
}

std::string to_text(const SystemStatus& status, const Snapshot& snapshot, TimePoint) {
  std::string text = format("%-22s %-10s %8s %7s %8s %8s %6s %7s\n", "process", "state", "rate Hz",
                            "misses", "rejected", "memory", "cpu", "pid");
  for (const ProcessLine& line : status.processes) {
    text += format(
        "%-22s %-10s %8.0f %7llu %8llu %5.0f MB %4.0f %% %7u", line.component.c_str(),
        line.state.c_str(), line.rate, static_cast<unsigned long long>(line.deadline_misses),
        static_cast<unsigned long long>(line.rejected), line.memory_mb, 100.0 * line.cpu, line.pid);
    text += line.reason.empty() ? "\n" : "  " + line.reason + "\n";
  }
  if (snapshot.task.ever) {
    const TaskStatus& task = snapshot.task.sample;
    text += "task        " + std::string(name(task.kind)) + " " + name(task.state);
    if (task.step < task.plan.size()) text += ", step " + task.plan[task.step];
    text += (task.reason.empty() ? "" : ": " + task.reason) + "\n";
  }
  if (snapshot.action.ever && snapshot.action.sample.phase != ActionPhase::none)
    text += "phase       " + phase_text(snapshot.action.sample) + "\n";
  if (snapshot.execution.ever) {
    const ExecutionStatus& execution = snapshot.execution.sample;
    const std::string causes = cause_names(execution.causes);
    text += "mode        " + std::string(name(execution.mode)) +
            (causes.empty() ? "" : " because of " + causes) + "\n";
    text +=
        format("trajectory  %llu, %.0f %% done\n",
               static_cast<unsigned long long>(execution.trajectory), 100.0 * execution.progress);
    text += format("control     %llu cycles, %llu late\n",
                   static_cast<unsigned long long>(execution.cycles),
                   static_cast<unsigned long long>(execution.late_cycles));
  }
  if (snapshot.advice.ever)
    text += format("advice      speed factor %.2f %s\n", snapshot.advice.sample.speed_factor,
                   snapshot.advice.sample.reason.c_str());
  for (const BehaviourState& behaviour : snapshot.attention.sample.behaviours) {
    text += format("clock       %-8s every %.3f s%s\n", name(behaviour.behaviour), behaviour.period,
                   behaviour.released ? ", released" : "");
  }
  for (const std::string& one : status.left_out) text += "left out    " + one + "\n";
  for (const std::string& trouble : status.troubles) text += "! " + trouble + "\n";
  return text;
}

}  // namespace handsel
