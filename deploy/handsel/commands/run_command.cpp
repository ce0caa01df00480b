// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <fstream>

#include <google/protobuf/text_format.h>
#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/eval/report.hpp"
#include "deploy/handsel/offline/scene_check.hpp"
#include "deploy/handsel/offline/settings_list.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"
#include "deploy/handsel/system/system_options.hpp"
#include "sim/recordings/recording.hpp"
#include "sim/scene/settings.hpp"

namespace handsel {
namespace {

struct RunOptions {
  SystemOptions system;
  bool headless{false}, stay{false}, json{false};
  std::string human, report, condition, participant;
  std::uint64_t trial{};
  double timeout{0.0};
};

struct TemporaryFile {
  std::filesystem::path path;
  ~TemporaryFile() {
    std::error_code ignored;
    if (!path.empty()) std::filesystem::remove(path, ignored);
  }
};

/// Writes the scenario with its first person played from a recording into a separate file. Each
/// process draws the random values from it.
std::filesystem::path with_recording(const std::string& name, const std::string& recording) {
  config::Scenario scenario;
  load_text_proto(scenario_file(name), scenario);
  if (scenario.people().empty())
    throw ConfigError("--human needs a scenario with a person; " + name + " has none");
  scenario.mutable_people(0)->set_behaviour(config::RECORDING);
  const std::filesystem::path own = std::filesystem::exists(recording)
                                        ? std::filesystem::absolute(recording)
                                        : std::filesystem::path(recording);
  sim::load_recording(
      sim::resolve_recording(own, sim::data_root()));  // an invalid recording starts nothing
  scenario.mutable_people(0)->set_recording(own.string());
  std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("handsel-" + std::to_string(getpid()) + ".txtpb");
  std::string text;
  google::protobuf::TextFormat::PrintToString(scenario, &text);
  std::ofstream(file) << text;
  return file;
}

/// Notes for the record of a study.
class Marks {
 public:
  Marks(Bus& bus, const RunOptions& options)
      : out_(bus.advertise<StudyMark>()),
        mark_{.condition = options.condition,
              .participant = options.participant,
              .trial = options.trial} {}
  void operator()(const std::string& text) {
    mark_.text = text;
    out_->publish(mark_);
  }

 private:
  std::unique_ptr<Publisher<StudyMark>> out_;
  StudyMark mark_;
};

void write_report(const std::string& file, const nlohmann::json& report) {
  std::ofstream out(file);
  out << report.dump(2) << "\n";
  if (!out.flush()) throw ConfigError("cannot write the report to " + file);
}

int run(RunOptions& options) {
  catch_interrupts();
  const config::Scenario scenario =
      read_scenario(scenario_file(options.system.scenario), options.system.seed);
  scenario_goals(scenario);  // a scenario without a valid task starts nothing
  const std::string shown = options.system.scenario;
  if (!options.report.empty())
    write_report(options.report, nlohmann::json{{"success", false}, {"failure", "did not end"}});
  TemporaryFile derived;
  if (!options.human.empty()) {
    derived.path = with_recording(options.system.scenario, options.human);
    options.system.scenario = derived.path;
  }

  if (!options.condition.empty()) options.system.notes["condition"] = options.condition;
  if (!options.participant.empty()) options.system.notes["participant"] = options.participant;
  if (options.trial > 0) options.system.notes["trial"] = std::to_string(options.trial);
  report_changed_settings();
  check_scene(options.system);
  System system(options.system);
  std::fprintf(
      stderr, "starting %zu processes on DDS domain %d, scenario %s, seed %llu; logs in %s\n",
      kProcesses.size(), options.system.domain, shown.c_str(),
      static_cast<unsigned long long>(options.system.seed), system.log_directory().c_str());
  Session& session = system.session();
  Marks mark(session.bus(), options);
  Performer performer(session.bus(), session.observer(), scenario, options.timeout,
                      [&] { return not_ready(session.snapshot()).empty(); });
  const auto ready = system.wait_ready(kReadyTimeout);
  if (!ready) return 1;
  std::fprintf(stderr, "ready after %.1f s\n", to_seconds(*ready));
  announce_page(system, options.headless);

  ReportInputs inputs{
      .scenario = shown, .robot = robot_of(options.system), .seed = options.system.seed};
  inputs.ready = to_seconds(*ready);
  inputs.before = counters(session.snapshot());
  inputs.ground_truth_before = session.snapshot().ground_truth.sample;
  session.observer().on_event([&](const TimelineEvent& event) {
    std::fprintf(stderr, "%7.2f s  %s\n",
                 performer.started() ? to_seconds(event.at - performer.begin()) : 0.0,
                 event.text.c_str());
  });
  system.wait(std::chrono::hours(24), [&] { return performer.started(); });
  mark("begin");
  system.wait(std::chrono::hours(24), [&] { return performer.finished(); });
  if (!performer.finished()) performer.abort("interrupted");
  mark(performer.succeeded() ? "done" : "failed");
  session.listen(from_seconds(0.3));  // receives the last health samples
  session.observer().on_event({});

  for (const ProcessStatus& process : system.launcher().processes()) {
    if (process.restarts > 0) inputs.restarts[process.name] = process.restarts;
  }
  nlohmann::json report = make_report(inputs, performer, session.observer());
  if (!options.condition.empty()) report["condition"] = options.condition;
  if (!options.participant.empty()) report["participant"] = options.participant;
  if (options.trial > 0) report["trial"] = options.trial;
  std::fprintf(stderr, "\n%s", summary(report).c_str());
  if (!options.report.empty()) write_report(options.report, report);
  if (json_wanted(options.json)) std::printf("%s\n", report.dump().c_str());
  std::fflush(stdout);
  if (options.stay && !interrupted()) {
    std::fprintf(
        stderr,
        "\nthe system keeps running; `handsel task …` starts further tasks, Ctrl-C stops all\n");
    while (!interrupted()) system.wait(from_seconds(3600), [] { return false; });
  }
  return performer.succeeded() ? 0 : 1;
}

}  // namespace

void add_run_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run",
                                         "starts all processes, performs the scenario's tasks, "
                                         "prints a report and stops all processes");
  add_system_options(*command, options->system);
  command->add_flag("--headless", options->headless, "open no browser");
  command->add_flag("--stay", options->stay,
                    "keep the processes running after the tasks until Ctrl-C");
  command->add_flag("--json", options->json, "print the report as JSON");
  command->add_option(
      "--human", options->human,
      "recording that the first person replays: .csv, .bvh, or a folder of the KTH handover set");
  command->add_option("--report", options->report, "write the report to this file");
  command->add_option("--condition", options->condition,
                      "condition of a study, written into the report and, as a mark at begin and "
                      "end, into the recording");
  command->add_option("--participant", options->participant,
                      "pseudonym of a participant, written into the report and the recording");
  command->add_option("--trial", options->trial,
                      "number of the trial, written into the report and the recording");
  command
      ->add_option("--timeout", options->timeout,
                   "max time for all tasks [s] (default: the scenario's)")
      ->check(kAboveZero);
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace handsel
