// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>
#include <random>
#include <thread>

#include <google/protobuf/text_format.h>
#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "common/config/schema/attention.pb.h"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/cli/json_line.hpp"
#include "deploy/handsel/cli/json_lines.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/eval/study.hpp"
#include "deploy/handsel/eval/tally.hpp"
#include "deploy/handsel/eval/trial.hpp"
#include "deploy/handsel/offline/settings_list.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {
namespace {

struct EvalOptions {
  std::vector<std::string> scenarios{"give_mug"}, modes{"adaptive"}, laws, from, by;
  std::string robot, out, shard, report, participant;
  int trials{10}, jobs{0};
  std::uint64_t seed{1};
  std::uint64_t replay{0};
  std::string record;
  double timeout{0.0};
};

/// Mean period of each behaviour's clock and of each piece of work [s].
using Periods = std::map<std::string, double>;

/// Returns the position of all clocks between p_min and p_max, on a logarithmic scale, in the mode
/// "fixed:RATIO"; nullopt: another mode.
std::optional<double> fixed_ratio(const std::string& mode) {
  if (!mode.starts_with("fixed:")) return std::nullopt;
  char* end = nullptr;
  const double ratio = std::strtod(mode.c_str() + 6, &end);
  if (end == mode.c_str() + 6 || *end != 0 || !(ratio >= 0 && ratio <= 1))
    throw ConfigError("--attention is \"" + mode +
                      "\"; what follows fixed: must be a number from 0 to 1");
  return ratio;
}

/// Sets how the attention's clocks run: as set ("adaptive"), all at p_min ("max"), each always at
/// the mean period of the adaptive ones ("mean"), at a ratio between p_min and p_max ("fixed:0.4"),
/// or no attention ("off").
void set_mode(const std::string& mode, const Periods& mean, config::AttentionSettings& settings) {
  settings.set_off(mode == "off");
  const std::optional<double> ratio = fixed_ratio(mode);
  if (mode != "max" && mode != "mean" && !ratio) return;
  const auto period = [&](const auto& clock, const std::string& name) {
    if (ratio) return clock.p_min() * std::pow(clock.p_max() / clock.p_min(), *ratio);
    const auto known = mean.find(name);
    return mode == "max" || known == mean.end()
               ? clock.p_min()
               : std::clamp(known->second, clock.p_min(), clock.p_max());
  };
  for (auto& behaviour : *settings.mutable_behaviours()) {
    behaviour.set_law(config::FIXED);
    behaviour.set_period(period(behaviour, behaviour.name()));
  }
  for (auto& work : *settings.mutable_works()) work.set_period(period(work, "work " + work.name()));
}

/// Sets the adaptation law of a clock; "margin" only for behaviours that observe the distance to
/// people.
void set_law(const std::string& law, config::AttentionBehaviour& behaviour) {
  const bool observes_people = behaviour.kind() == config::AVOID ||
                               (behaviour.kind() == config::BY_NAME && behaviour.name() == "avoid");
  if (law != "margin")
    behaviour.set_law(law == "weber" ? config::WEBER : config::LINEAR);
  else if (observes_people)
    behaviour.set_law(config::MARGIN);
}

/// Copy of the settings folder with the attention's law and mode replaced; deleted with this
/// object.
class DerivedSettings {
 public:
  DerivedSettings(const std::string& law, const std::string& mode, const Periods& mean) {
    if (law.empty() && mode == "adaptive") return;
    namespace fs = std::filesystem;
    static int count = 0;
    folder_ = fs::temp_directory_path() /
              ("handsel-settings-" + std::to_string(getpid()) + "-" + std::to_string(++count));
    fs::create_directories(folder_);
    for (const auto& entry : fs::directory_iterator(resource("config")))
      fs::copy(entry.path(), folder_ / entry.path().filename());
    config::AttentionSettings settings;
    load_text_proto(folder_ / "attention.txtpb", settings);
    if (!law.empty())
      for (auto& behaviour : *settings.mutable_behaviours()) set_law(law, behaviour);
    set_mode(mode, mean, settings);
    std::string text;
    google::protobuf::TextFormat::PrintToString(settings, &text);
    std::ofstream(folder_ / "attention.txtpb") << text;
  }
  ~DerivedSettings() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }
  DerivedSettings(const DerivedSettings&) = delete;
  DerivedSettings& operator=(const DerivedSettings&) = delete;
  const std::filesystem::path& folder() const {
    return folder_;
  }  ///< empty: the unchanged settings

 private:
  std::filesystem::path folder_;
};

/// A condition of the comparison: a mode and a law.
struct Condition {
  std::string name, mode, law;
  std::shared_ptr<const DerivedSettings> settings;
};

struct Shard {
  int index{0}, count{1};
};

Shard parse_shard(const std::string& text) {
  Shard shard;
  char rest = 0;
  if (text.empty()) return shard;
  if (std::sscanf(text.c_str(), "%d/%d%c", &shard.index, &shard.count, &rest) != 2 ||
      shard.count < 1 || shard.index < 0 || shard.index >= shard.count) {
    throw ConfigError("--shard is \"" + text + "\"; it must be i/n with 0 <= i < n");
  }
  return shard;
}

void print_table(const TrialTable& table, const std::vector<std::string>& by) {
  const std::vector<std::string> known = table.headings();
  for (const std::string& heading : by) {
    if (std::find(known.begin(), known.end(), heading) != known.end()) continue;
    std::string all;
    for (const std::string& each : known) all += (all.empty() ? "" : ", ") + each;
    std::fprintf(stderr, "--by %s: no trial has drawn it; there is: %s\n", heading.c_str(),
                 all.empty() ? "nothing" : all.c_str());
  }
  std::fputs(table.text(by).c_str(), stderr);
}

/// Caches the inputs of trials: a context is loaded once per robot.
class Contexts {
 public:
  Contexts(std::string scenario, std::string robot, std::filesystem::path settings)
      : scenario_(std::move(scenario)), robot_(std::move(robot)), settings_(std::move(settings)) {}
  NodeContext of(std::uint64_t seed) {
    const std::string robot = robot_.empty() ? scenario_robot(scenario_, seed) : robot_;
    const auto known = loaded_.find(robot);
    NodeContext context =
        known != loaded_.end()
            ? known->second
            : loaded_.emplace(robot, system_context(scenario_, robot, seed, settings_))
                  .first->second;
    context.seed = seed;
    return context;
  }

 private:
  std::string scenario_, robot_;
  std::filesystem::path settings_;
  std::map<std::string, NodeContext> loaded_;
};

/// Plans all conditions of a seed side by side, in an order drawn by the seed: disturbances of a
/// machine, or of a person, affect all alike.
std::vector<Trial> plan_trials(const EvalOptions& options, const std::vector<Condition>& conditions,
                               std::uint64_t first, int count) {
  std::vector<Trial> trials;
  const Shard shard = parse_shard(options.shard);
  for (const std::string& scenario : options.scenarios) {
    std::vector<Contexts> contexts;
    contexts.reserve(conditions.size());
    for (const Condition& condition : conditions)
      contexts.emplace_back(scenario, options.robot, condition.settings->folder());
    for (int i = 0; i < count; ++i) {
      if (i % shard.count != shard.index) continue;
      const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
      std::vector<std::size_t> order(conditions.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::mt19937_64 random(seed);
      for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random() % k]);
      for (const std::size_t k : order) {
        const Condition& condition = conditions[k];
        Trial trial{
            .context = contexts[k].of(seed),
            .options = {
                .scenario = scenario, .attention = condition.mode, .timeout = options.timeout}};
        trial.options.condition = condition.name;
        trial.options.participant = options.participant;
        trial.options.order = trials.size() + 1;
        trial.options.clock_law = condition.law.empty() ? "as set" : condition.law;
        if (options.replay) {
          trial.options.hash_outputs = true;
          trial.options.record = options.record;
          trial.options.on_event = [](double at, const std::string& text) {
            std::fprintf(stderr, "%8.3f s  %s\n", at, text.c_str());
          };
        }
        trials.push_back(std::move(trial));
      }
    }
  }
  return trials;
}

int jobs_of(const EvalOptions& options) {
  return options.jobs > 0 ? options.jobs
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

/// Returns the mean periods of the adaptive clocks, from trials with separate seeds: the same for
/// every shard.
Periods mean_periods(const EvalOptions& options, const std::string& law) {
  constexpr std::uint64_t kApart = 1'000'000;
  EvalOptions pilot = options;
  pilot.shard.clear();
  pilot.replay = 0;
  pilot.record.clear();
  const std::vector<Condition> adaptive{
      {"adaptive", "adaptive", law, std::make_shared<DerivedSettings>(law, "adaptive", Periods{})}};
  std::map<std::string, double> activations;
  double time = 0;
  run_trials(plan_trials(pilot, adaptive, options.seed + kApart, std::min(options.trials, 8)),
             jobs_of(options), [&](const nlohmann::json& line) {
               if (!line.contains("activations_of")) return;
               const double duration = line["duration_s"];
               time += duration;
               for (const auto& [behaviour, count] : line["activations_of"].items())
                 activations[behaviour] += count.get<double>();
               for (const auto& [work, period] : line["work_period_s"].items())
                 if (period.is_number())
                   activations["work " + work] += duration / period.get<double>();
             });
  Periods mean;
  for (const auto& [what, count] : activations) {
    mean[what] = time / std::max(1.0, count);
    std::fprintf(stderr, "%-13s every %.3f s when adaptive\n", what.c_str(), mean[what]);
  }
  return mean;
}

/// Returns each mode with each law; without adaptive clocks the law has no effect, and one is
/// enough.
std::vector<Condition> conditions_of(const EvalOptions& options) {
  std::vector<Condition> conditions;
  const std::vector<std::string> laws =
      options.laws.empty() ? std::vector<std::string>{""} : options.laws;
  for (const std::string& mode : options.modes) {
    for (const std::string& law : laws) {
      if (&law != &laws.front() && mode != "adaptive" && mode != "mean") continue;
      const Periods mean = mode == "mean" ? mean_periods(options, law) : Periods{};
      conditions.push_back(
          {laws.size() > 1 && (mode == "adaptive" || mode == "mean") ? mode + "/" + law : mode,
           mode, law, std::make_shared<DerivedSettings>(law, mode, mean)});
    }
  }
  return conditions;
}

void report(const EvalOptions& options, const Study& study) {
  if (study.empty()) return;
  const std::vector<std::string> all = study.conditions();
  const auto adaptive = std::find_if(
      all.begin(), all.end(), [](const std::string& c) { return c.starts_with("adaptive"); });
  const std::string reference = adaptive == all.end() ? all.front() : *adaptive;
  if (all.size() > 1) std::fputs(study.table(reference).c_str(), stderr);
  if (!options.report.empty()) write_study(study, reference, options.report);
}

/// Reports lines of earlier trials, e.g. from the shards of a batch system.
int report_files(const EvalOptions& options) {
  Study study;
  TrialTable table;
  for (const std::string& file : options.from) {
    std::ifstream in(file);
    if (std::filesystem::is_directory(file)) throw ConfigError(file + " is not a file");
    if (!in) throw MissingError("cannot read " + file);
    int number = 0;
    for (std::string text; std::getline(in, text);) {
      ++number;
      nlohmann::json line;
      try {
        line = command::parse_line(text);
      } catch (const command::LineError& error) {
        throw ConfigError(file + ":" + std::to_string(number) + ": " + error.what());
      }
      if (!line.contains("scenario") || !line.contains("seed") || !line.contains("success"))
        throw ConfigError(file + ":" + std::to_string(number) +
                          ": this is no line of handsel eval");
      try {
        study.add(line);
        table.add(line);
      } catch (const nlohmann::json::exception&) {
        throw ConfigError(
            file + ":" + std::to_string(number) +
            ": this is no line of handsel eval: a field is missing or of another type");
      }
    }
  }
  print_table(table, options.by);
  report(options, study);
  return 0;
}

int evaluate(const EvalOptions& options) {
  if (!options.from.empty()) return report_files(options);
  if (options.replay && options.modes.size() * std::max<std::size_t>(1, options.laws.size()) > 1)
    throw ConfigError("--replay repeats one trial: name one mode and one law");
  if (!options.record.empty() && !options.replay)
    throw ConfigError("--record is for the one trial of --replay");
  report_changed_settings();
  const std::vector<Condition> conditions = conditions_of(options);
  const std::vector<Trial> trials =
      plan_trials(options, conditions, options.replay ? options.replay : options.seed,
                  options.replay ? 1 : options.trials);
  std::ofstream out;
  if (!options.out.empty()) {
    out.open(options.out, std::ios::app);  // emptied when the first trial was performed
    if (!out) throw ConfigError("cannot write " + options.out);
  }
  const bool to_stdout = options.out.empty();
  TrialTable table;
  Study study;
  std::size_t done = 0, successes = 0;
  const bool clean = run_trials(trials, jobs_of(options), [&](const nlohmann::json& line) {
    // The same settings and scenario would be refused in each trial.
    if (done == 0 && line["failure"] == "refused")
      throw ConfigError(line["reason"].get<std::string>());
    if (done == 0 && !to_stdout) {
      out.close();
      out.open(options.out);
    }
    table.add(line);
    study.add(line);
    successes += line["success"].get<bool>();
    if (to_stdout) {
      std::printf("%s\n", line.dump().c_str());
      std::fflush(stdout);
    } else {
      out << line.dump() << std::endl;
    }
    ++done;
    if (options.replay && line.contains("output_hash"))
      std::fprintf(stderr, "hash of all outputs %s\n",
                   line["output_hash"].get<std::string>().c_str());
    if (progress_wanted())
      std::fprintf(stderr, "\r%zu of %zu trials, %zu succeeded ", done, trials.size(), successes);
  });
  if (progress_wanted()) std::fprintf(stderr, "\n");
  print_table(table, options.by);
  report(options, study);
  if (options.replay) return successes == trials.size() ? 0 : 1;
  return clean ? 0 : 1;
}

}  // namespace

void add_eval_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<EvalOptions>();
  CLI::App* command = app.add_subcommand("eval",
                                         "performs randomised trials in lock-step; prints one line "
                                         "of JSON for each and a table at the end");
  command->add_option("scenarios,--scenario", options->scenarios, "scenarios: names or files")
      ->capture_default_str();
  add_overlay_options(*command);
  command->add_option("--robot", options->robot, "robot description (default: the scenario's)");
  command->add_option("--trials", options->trials, "number of trials of each scenario")
      ->check(kAboveZero)
      ->capture_default_str();
  command
      ->add_option("--seed", options->seed,
                   "seed of the first trial; each following trial has the next number")
      ->check(kAboveZero)
      ->capture_default_str();
  command
      ->add_option("--replay", options->replay,
                   "performs the one trial with this seed, bit for bit, and prints the events")
      ->check(kAboveZero);
  command->add_option("--record", options->record,
                      "with --replay: write all messages into this MCAP file");
  command
      ->add_option("--attention", options->modes,
                   "mode of the attention's clocks: adaptive; max: all at their shortest period; "
                   "mean: each at its mean period in a few adaptive trials before; fixed:RATIO: "
                   "all at this ratio, 0 to 1, between their shortest and longest period; off: no "
                   "attention. Several modes are compared with the same seeds")
      ->check([](const std::string& mode) {
        for (const char* known : {"adaptive", "max", "mean", "off"})
          if (mode == known) return std::string();
        try {
          return fixed_ratio(mode)
                     ? std::string()
                     : "\"" + mode + "\" is none of adaptive, max, mean, off, fixed:RATIO";
        } catch (const ConfigError& error) {
          return std::string(error.what());
        }
      })
      ->capture_default_str();
  command
      ->add_option("--law", options->laws,
                   "adaptation law of the attention's clocks (default: as in its settings); "
                   "several laws are compared. margin applies only to behaviours that observe the "
                   "distance to people; the others keep theirs")
      ->check(CLI::IsMember({"linear", "weber", "margin"}));
  command->add_option("--report", options->report,
                      "folder for the comparison (JSON Lines, table), a CSV file with one row for "
                      "each trial, and plots (SVG)");
  command->add_option("--from", options->from,
                      "report on these files with lines of trials, e.g. of all shards, instead of "
                      "performing trials");
  command->add_option("--by", options->by,
                      "tables by these random choices only, e.g. object (default: by all)");
  command->add_option("--participant", options->participant, "pseudonym in the lines");
  add_help_hold_option(*command);
  command
      ->add_option("--jobs", options->jobs,
                   "number of trials at a time (default: one for each core)")
      ->check(kAboveZero);
  command->add_option("--shard", options->shard,
                      "i/n: perform only every n-th trial, from the i-th (0 <= i < n)");
  command
      ->add_option("--timeout", options->timeout,
                   "simulated time for all tasks [s] (default: the scenario's)")
      ->check(kAboveZero);
  command->add_option("--out", options->out, "write the lines of the trials to this file");
  command->callback([options, &exit_code] { exit_code = evaluate(*options); });
}

}  // namespace handsel
