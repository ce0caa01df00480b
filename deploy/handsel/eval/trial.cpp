// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/eval/trial.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "common/base/errors.hpp"
#include "common/config/scenario.hpp"
#include "deploy/handsel/eval/criteria.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/eval/report.hpp"
#include "deploy/handsel/recording/recorder.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"
#include "sim/scene/scene_setup.hpp"
#include "sim/scene/settings.hpp"

namespace handsel {
namespace {

using Json = nlohmann::json;

constexpr double kReadyTimeout = 10.0;  // [s]

std::string failure_kind(const Performer& performer, const GroundTruth& ground_truth) {
  if (ground_truth.dropped) return "dropped";
  if (performer.succeeded()) return "";
  if (performer.outcomes().empty()) return "not_ready";
  const TaskOutcome& last = performer.outcomes().back();
  if (last.timed_out) return "timeout";
  if (last.state == name(TaskState::succeeded)) return "no_handover";
  return "task_" + last.state;
}

/// Returns the traits of the person of the first task; empty without a person of the scenario.
Json traits_of(const NodeContext& context, const config::Scenario& scenario) {
  if (scenario.tasks().empty() || scenario.tasks(0).human().empty()) return {};
  const sim::SimSettings settings = sim::load_settings(context.settings);
  const sim::SceneSetup setup = sim::set_up(scenario, *context.robot, context.objects,
                                            settings.coverage, settings.data_root, context.seed);
  for (const sim::StartPerson& person : setup.people) {
    if (person.settings.id != scenario.tasks(0).human()) continue;
    const sim::BehaviourProfile& behaviour = person.settings.behaviour;
    Json traits = Json::array({behaviour.seated ? "seated" : "standing"});
    const std::pair<bool, const char*> others[] = {
        {person.settings.left_handed, "left-handed"},
        {behaviour.hesitation > 0, "hesitates"},
        {behaviour.withdraws, "withdraws"},
        {behaviour.look_away > 0, "looks away"},
        {!behaviour.sidestep.isZero(), "steps aside"},
        {std::isfinite(behaviour.changes_hand_at), "changes hands"},
        {behaviour.early, "takes early"}};
    for (const auto& [has, trait] : others)
      if (has) traits.push_back(trait);
    return traits;
  }
  return {};
}

/// Returns the values drawn by the seed of a scenario with draws; null otherwise.
Json drawn_of(const NodeContext& context) {
  const DrawnScenario drawn = draw_scenario(context.scenario, context.seed);
  if (drawn.variants.empty() && drawn.tops.empty()) return {};
  Json out(drawn.variants);
  for (const auto& [box, height] : drawn.tops) out[box + "_top_m"] = height;
  try {
    if (Json traits = traits_of(context, drawn.scenario); !traits.is_null()) out["person"] = traits;
  } catch (const std::exception&) {
    // A scene that cannot be set up is reported as the failure of the trial, with its reason.
  }
  return out;
}

Json base_line(const NodeContext& context, const TrialOptions& options) {
  Json line{{"scenario", options.scenario},
            {"seed", context.seed},
            {"robot", context.robot->name()},
            {"attention", options.attention},
            {"law", options.clock_law}};
  line["condition"] = options.condition.empty() ? options.attention : options.condition;
  if (!options.participant.empty()) line["participant"] = options.participant;
  if (options.order > 0) line["order"] = options.order;
  if (Json drawn = drawn_of(context); !drawn.is_null()) line["drawn"] = std::move(drawn);
  return line;
}

struct Worker {
  std::size_t trial{};
  pid_t pid{-1};
  int fd{-1};
  std::string text;
};

/// Returns the line of a trial that was not performed.
Json failed_line(const Trial& trial, const char* failure, const std::string& reason) {
  Json line = base_line(trial.context, trial.options);
  line.update({{"success", false}, {"failure", failure}, {"reason", reason}});
  return line;
}

Worker start_worker(const std::vector<Trial>& trials, std::size_t index) {
  int channel[2];
  if (pipe(channel) != 0)
    throw MissingError(std::string("cannot make a pipe: ") + std::strerror(errno));
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) throw MissingError(std::string("cannot start a worker: ") + std::strerror(errno));
  if (pid > 0) {
    close(channel[1]);
    return {.trial = index, .pid = pid, .fd = channel[0]};
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(3);
  close(channel[0]);
  std::string line;
  try {
    line = run_trial(trials[index].context, trials[index].options).dump();
  } catch (const ConfigError& error) {
    line = failed_line(trials[index], "refused", error.what()).dump();
  } catch (const std::exception& error) {
    line = failed_line(trials[index], "error", error.what()).dump();
  }
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t n = write(channel[1], line.data() + sent, line.size() - sent);
    if (n <= 0) _exit(1);
    sent += static_cast<std::size_t>(n);
  }
  _exit(0);
}

/// Returns the line of a trial. `clean` becomes false if the trial crashed or could not be
/// performed.
Json finish_worker(const Worker& worker, const std::vector<Trial>& trials, bool& clean) {
  close(worker.fd);
  int status = 0;
  waitpid(worker.pid, &status, 0);
  Json line = Json::parse(worker.text, nullptr, false);
  if (!line.is_discarded() && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    clean = clean && line["failure"] != "error" && line["failure"] != "refused";
    return line;
  }
  clean = false;
  return failed_line(trials[worker.trial], "crash",
                     WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "ended without an answer");
}

}  // namespace

nlohmann::json run_trial(const NodeContext& context, const TrialOptions& options) {
  const config::Scenario scenario = read_scenario(context.scenario, context.seed);
  LockstepSystem system(context);
  const Criteria criteria(system.bus(), system.network());
  if (options.hash_outputs) system.network().hash_outputs();
  std::unique_ptr<LocalRecording> recording;
  if (!options.record.empty()) {
    recording =
        std::make_unique<LocalRecording>(system.network(), options.record,
                                         mcap::Metadata{{"robot", context.robot->name()},
                                                        {"scenario", options.scenario},
                                                        {"seed", std::to_string(context.seed)},
                                                        {"attention", options.attention}});
  }
  bool is_ready = false;
  const auto ready = [&] {
    is_ready = is_ready || not_ready(system.snapshot(), false).empty();
    return is_ready;
  };
  Performer performer(system.bus(), system.observer(), scenario, options.timeout, ready);
  system.observer().on_event([&](const TimelineEvent& event) {
    if (options.on_event) options.on_event(to_seconds(event.at.time_since_epoch()), event.text);
  });
  const TimePoint start = system.now();
  system.network().run_until([&] { return performer.started(); },
                             start + from_seconds(kReadyTimeout));
  if (performer.started())
    system.network().run_until([&] { return performer.finished(); }, start + std::chrono::hours(1));
  system.observer().on_event({});
  if (!performer.finished()) performer.abort("not ready");

  const ReportInputs inputs{
      .scenario = options.scenario, .robot = context.robot->name(), .seed = context.seed};
  const Json report = make_report(inputs, performer, system.observer());
  const GroundTruth& ground_truth = system.snapshot().ground_truth.sample;
  std::uint64_t activations = 0, fastest = 0;
  Json activations_of = Json::object();
  for (const BehaviourState& behaviour : system.snapshot().attention.sample.behaviours) {
    activations += behaviour.activations;
    activations_of[behaviour.name] = behaviour.activations;
    fastest += behaviour.activations_at_fastest;
  }
  char hash[32];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(ground_truth.hash));
  Json line = base_line(context, options);
  line.update({{"success", report["success"].get<bool>() && !ground_truth.dropped},
               {"failure", failure_kind(performer, ground_truth)},
               {"reason", ground_truth.dropped && report["success"].get<bool>()
                              ? Json(ground_truth.object + " was dropped afterwards")
                              : report["failure"]},
               {"duration_s", report["duration_s"]},
               {"min_separation_m", report["min_separation_m"]},
               {"min_robot_distance_m", report["min_robot_distance_m"]},
               {"ssm_violations", report["ssm_violations"]},
               {"limit_ratio", report["limit_ratio"]},
               {"limit_violations", ground_truth.limit_violations},
               {"collisions", ground_truth.self_or_scene_collisions},
               {"contact_force_n", ground_truth.contact_force},
               {"peak_closing_speed_m_s", ground_truth.peak_closing_speed},
               {"drops", ground_truth.dropped ? 1 : 0},
               {"lifted_m", ground_truth.max_lifted},
               {"contact_ratio", report["oracle"]["contact_ratio"]},
               {"taken_with", report["oracle"]["taken_with"]},
               {"wrist_strain", report["oracle"]["wrist_strain"]},
               {"arm_strain", report["oracle"]["arm_strain"]},
               {"activations", activations},
               {"activations_of", activations_of},
               {"activations_at_pmin", fastest},
               {"tasks", report["tasks"]},
               {"events", system.network().events()},
               {"hash", hash}});
  line.update(criteria.fields());
  if (recording) recording->close();
  if (options.hash_outputs) {
    std::snprintf(hash, sizeof hash, "%016llx",
                  static_cast<unsigned long long>(system.network().output_hash()));
    line["output_hash"] = hash;
  }
  return line;
}

bool run_trials(const std::vector<Trial>& trials, int jobs,
                const std::function<void(const nlohmann::json&)>& on_line) {
  std::vector<Worker> running;
  std::map<std::size_t, Json> done;
  std::size_t next = 0, reported = 0;
  bool clean = true;
  while (reported < trials.size()) {
    while (next < trials.size() && running.size() < static_cast<std::size_t>(jobs))
      running.push_back(start_worker(trials, next++));
    std::vector<pollfd> fds;
    fds.reserve(running.size());
    for (const Worker& worker : running) fds.push_back({worker.fd, POLLIN, 0});
    poll(fds.data(), fds.size(), -1);
    for (std::size_t i = running.size(); i-- > 0;) {
      if (!fds[i].revents) continue;
      char bytes[65536];
      const ssize_t n = read(running[i].fd, bytes, sizeof bytes);
      if (n > 0) {
        running[i].text.append(bytes, static_cast<std::size_t>(n));
        continue;
      }
      if (n < 0 && errno == EINTR) continue;
      done[running[i].trial] = finish_worker(running[i], trials, clean);
      running.erase(running.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (auto line = done.find(reported); line != done.end(); line = done.find(reported)) {
      on_line(line->second);
      done.erase(line);
      ++reported;
    }
  }
  return clean;
}

std::pair<double, double> wilson_interval(int successes, int trials) {
  if (trials <= 0) return {0.0, 1.0};
  const double z = 1.959963984540054, n = trials, p = successes / n;
  const double centre = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

}  // namespace handsel
