#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <thread>

#include <google/protobuf/text_format.h>
#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "common/config/attention.pb.h"
#include "common/config/resources.hpp"
#include "deploy/handsel/commands.hpp"
#include "deploy/handsel/lockstep_system.hpp"
#include "deploy/handsel/system_options.hpp"
#include "deploy/handsel/terminal.hpp"
#include "deploy/handsel/trial.hpp"

namespace handsel {
namespace {

struct EvalOptions {
  std::vector<std::string> scenarios{"give_mug"};
  std::string robot, attention{"adaptive"}, law, out, shard;
  int trials{10}, jobs{0};
  std::uint64_t seed{1};
  std::uint64_t replay{0};
  double timeout{0.0};
};

/// Mean period of each behaviour's clock [s].
using Periods = std::map<std::string, double>;

/// How the attention's clocks run: as set ("adaptive"), all at their shortest period ("max"), each always at the mean period of the
/// adaptive ones ("mean"), or no attention ("off").
void set_mode(const std::string& mode, const Periods& mean, config::AttentionSettings& settings) {
  settings.set_off(mode == "off");
  if (mode != "max" && mode != "mean") return;
  for (auto& behaviour : *settings.mutable_behaviours()) {
    behaviour.set_law(config::FIXED);
    const auto period = mean.find(behaviour.name());
    behaviour.set_period(mode == "max" || period == mean.end() ? behaviour.p_min()
                                                               : std::clamp(period->second, behaviour.p_min(), behaviour.p_max()));
  }
}

/// The settings with the attention's law and mode replaced: a copy of the folder, removed with this object.
class DerivedSettings {
 public:
  DerivedSettings(const std::string& law, const std::string& mode, const Periods& mean) {
    if (law.empty() && mode == "adaptive") return;
    namespace fs = std::filesystem;
    folder_ = fs::temp_directory_path() / ("handsel-settings-" + std::to_string(getpid()));
    fs::create_directories(folder_);
    for (const auto& entry : fs::directory_iterator(resource("config"))) fs::copy(entry.path(), folder_ / entry.path().filename());
    config::AttentionSettings settings;
    load_text_proto(folder_ / "attention.txtpb", settings);
    if (!law.empty())
      for (auto& behaviour : *settings.mutable_behaviours()) behaviour.set_law(law == "weber" ? config::WEBER : config::LINEAR);
    set_mode(mode, mean, settings);
    std::string text;
    google::protobuf::TextFormat::PrintToString(settings, &text);
    std::ofstream(folder_ / "attention.txtpb") << text;
  }
  ~DerivedSettings() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }
  const std::filesystem::path& folder() const { return folder_; }  ///< empty: the settings as they are

 private:
  std::filesystem::path folder_;
};

struct Shard {
  int index{0}, count{1};
};

Shard parse_shard(const std::string& text) {
  Shard shard;
  char rest = 0;
  if (text.empty()) return shard;
  if (std::sscanf(text.c_str(), "%d/%d%c", &shard.index, &shard.count, &rest) != 2 || shard.count < 1 || shard.index < 0 ||
      shard.index >= shard.count) {
    throw ConfigError("--shard is \"" + text + "\"; it must be i/n with 0 <= i < n");
  }
  return shard;
}

struct Tally {
  int trials{0}, successes{0};
  std::map<std::string, int> failures;
};

void print_table(const std::map<std::string, Tally>& tallies) {
  std::fprintf(stderr, "%-24s %7s %8s   %s\n", "scenario", "trials", "success", "95 % interval (Wilson)");
  for (const auto& [scenario, tally] : tallies) {
    const auto [low, high] = wilson_interval(tally.successes, tally.trials);
    std::fprintf(stderr, "%-24s %7d %6.1f %%   %.1f … %.1f %%\n", scenario.c_str(), tally.trials, 100.0 * tally.successes / tally.trials,
                 100 * low, 100 * high);
    for (const auto& [failure, count] : tally.failures) std::fprintf(stderr, "  %4d %s\n", count, failure.c_str());
  }
}

std::vector<Trial> plan_trials(const EvalOptions& options, const std::string& mode, const std::filesystem::path& settings) {
  std::vector<Trial> trials;
  const Shard shard = parse_shard(options.shard);
  const int count = options.replay ? 1 : options.trials;
  const std::uint64_t first = options.replay ? options.replay : options.seed;
  for (const std::string& scenario : options.scenarios) {
    NodeContext context = system_context(scenario, options.robot, first, settings);
    for (int i = 0; i < count; ++i) {
      if (i % shard.count != shard.index) continue;
      context.seed = first + static_cast<std::uint64_t>(i);
      Trial trial{.context = context, .options = {.scenario = scenario, .attention = mode, .timeout = options.timeout}};
      trial.options.law = options.law.empty() ? "as set" : options.law;
      if (options.replay) {
        trial.options.on_event = [](double at, const std::string& text) { std::fprintf(stderr, "%8.3f s  %s\n", at, text.c_str()); };
      }
      trials.push_back(std::move(trial));
    }
  }
  return trials;
}

int jobs_of(const EvalOptions& options) {
  return options.jobs > 0 ? options.jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

/// What the adaptive clocks come to in the trials that were asked for.
Periods mean_periods(const EvalOptions& options) {
  const DerivedSettings settings(options.law, "adaptive", {});
  std::map<std::string, double> activations;
  double time = 0;
  run_trials(plan_trials(options, "adaptive", settings.folder()), jobs_of(options), [&](const nlohmann::json& line) {
    if (!line.contains("activations_of")) return;
    time += line["duration_s"].get<double>();
    for (const auto& [behaviour, count] : line["activations_of"].items()) activations[behaviour] += count.get<double>();
  });
  Periods mean;
  for (const auto& [behaviour, count] : activations) {
    mean[behaviour] = time / std::max(1.0, count);
    std::fprintf(stderr, "%-8s every %.3f s when adaptive\n", behaviour.c_str(), mean[behaviour]);
  }
  return mean;
}

int evaluate(const EvalOptions& options) {
  const DerivedSettings settings(options.law, options.attention, options.attention == "mean" ? mean_periods(options) : Periods{});
  const std::vector<Trial> trials = plan_trials(options, options.attention, settings.folder());
  std::ofstream out;
  if (!options.out.empty()) {
    out.open(options.out);
    if (!out) throw ConfigError("cannot write " + options.out);
  }
  const bool to_stdout = options.out.empty();
  std::map<std::string, Tally> tallies;
  std::size_t done = 0, successes = 0;
  const bool clean = run_trials(trials, jobs_of(options), [&](const nlohmann::json& line) {
    Tally& tally = tallies[line["scenario"]];
    const bool success = line["success"];
    ++tally.trials;
    tally.successes += success;
    successes += success;
    if (!success) ++tally.failures[line["failure"].get<std::string>() + ": " + line["reason"].get<std::string>()];
    if (to_stdout) {
      std::printf("%s\n", line.dump().c_str());
      std::fflush(stdout);
    } else {
      out << line.dump() << std::endl;
    }
    ++done;
    if (progress_wanted()) std::fprintf(stderr, "\r%zu of %zu trials, %zu succeeded ", done, trials.size(), successes);
  });
  if (progress_wanted()) std::fprintf(stderr, "\n");
  print_table(tallies);
  if (options.replay) return successes == trials.size() ? 0 : 1;
  return clean ? 0 : 1;
}

}  // namespace

void add_eval_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<EvalOptions>();
  CLI::App* command = app.add_subcommand("eval", "randomised trials in lock-step: one JSON line each, a table at the end");
  command->add_option("--scenario", options->scenarios, "scenarios: names or files")->capture_default_str();
  command->add_option("--robot", options->robot, "robot description (default: the scenario's)");
  command->add_option("--trials", options->trials, "of each scenario")->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--seed", options->seed, "of the first trial; each next has one more")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--replay", options->replay, "one trial with this seed, bit for bit, telling what happens")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--attention", options->attention,
                   "how its clocks run: adaptive; max: all at their shortest period; mean: each at the mean period of the adaptive ones,\n"
                   "which run first; off: no attention")
      ->check(CLI::IsMember({"adaptive", "max", "mean", "off"}))
      ->capture_default_str();
  command->add_option("--law", options->law, "of the attention's clocks (default: as in its settings)")
      ->check(CLI::IsMember({"linear", "weber"}));
  add_no_weld_option(*command);
  command->add_option("--jobs", options->jobs, "trials at a time (default: one a core)")->check(CLI::PositiveNumber);
  command->add_option("--shard", options->shard, "i/n: only every n-th trial, from the i-th (0 <= i < n)");
  command->add_option("--timeout", options->timeout, "[s] of virtual time for all tasks (default: the scenario's)")
      ->check(CLI::PositiveNumber);
  command->add_option("--out", options->out, "write the lines to this file");
  command->callback([options, &exit_code] { exit_code = evaluate(*options); });
}

}  // namespace handsel
