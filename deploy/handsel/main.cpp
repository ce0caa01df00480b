// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "common/base/errors.hpp"
#include "common/config/nearest_name.hpp"
#include "common/config/search_path.hpp"
#include "common/wire/interface_id.hpp"
#include "deploy/handsel/commands/commands.hpp"

namespace {

/// Returns "; the nearest: ..." if names are similar to a word, otherwise nothing.
std::string nearest_text(const std::string& word, const std::vector<std::string>& names) {
  const std::vector<std::string> nearest = handsel::nearest_names(word, names);
  return nearest.empty() ? "" : "; the nearest: " + handsel::joined(nearest);
}

/// Throws ConfigError at the first option, from the i-th argument on, that a command lacks.
void require_known_options(const CLI::App& command, int i, int argc, char** argv) {
  for (; i < argc && std::string(argv[i]) != "--"; ++i) {
    const std::string word = argv[i], name = word.substr(0, word.find('='));
    if (!word.starts_with("--") || command.get_option_no_throw(name) != nullptr) continue;
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
      for (const std::string& each : option->get_lnames()) names.push_back("--" + each);
    throw handsel::ConfigError("there is no option \"" + name + "\" here" +
                               nearest_text(name, names) + "; --help names those there are");
  }
}

/// Follows the words that name commands; throws ConfigError at an unknown one, and at an option
/// that the command lacks.
void require_known(const CLI::App& app, int argc, char** argv) {
  const CLI::App* command = &app;
  int i = 1;
  for (; i < argc && argv[i][0] != '-'; ++i) {
    const std::string word = argv[i];
    const auto all = command->get_subcommands([](const CLI::App*) { return true; });
    if (all.empty()) break;
    const auto found = command->get_subcommands(
        [&](const CLI::App* candidate) { return candidate->get_name() == word; });
    if (found.empty()) {
      std::vector<std::string> names;
      names.reserve(all.size());
      for (const CLI::App* candidate : all) names.push_back(candidate->get_name());
      throw handsel::ConfigError("there is no command \"" + word + "\" here" +
                                 nearest_text(word, names) + "; --help names those there are");
    }
    command = found.front();
  }
  require_known_options(*command, i, argc, argv);
}

/// Adds --path to each command that has no subcommands: it applies before the command runs.
void add_path_option(CLI::App& command) {
  const auto all = command.get_subcommands([](const CLI::App*) { return true; });
  for (CLI::App* each : all) add_path_option(*each);
  if (!all.empty()) return;
  command
      .add_option_function<std::vector<std::string>>(
          "--path", handsel::search_first,
          "folder in which robots, hands, objects, scenarios, stories, tasks, behaviours and "
          "settings are searched first; may be repeated (then $HANDSEL_PATH, the working "
          "directory, the project's own)")
      ->expected(1)
      ->take_all()
      ->trigger_on_parse();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Handsel lets a robot arm hand things to people. `handsel COMMAND --help` explains a "
      "command."};
  app.name("handsel");
  app.require_subcommand(1);
  app.set_version_flag("--version", handsel::version_text);
  int exit_code = 0;
  handsel::add_up_command(app, exit_code);
  handsel::add_run_command(app, exit_code);
  handsel::add_task_commands(app, exit_code);
  handsel::add_story_command(app, exit_code);
  handsel::add_status_command(app, exit_code);
  handsel::add_health_command(app, exit_code);
  handsel::add_topic_commands(app, exit_code);
  handsel::add_doctor_command(app, exit_code);
  handsel::add_record_commands(app, exit_code);
  handsel::add_eval_command(app, exit_code);
  handsel::add_environment_command(app, exit_code);
  handsel::add_config_commands(app, exit_code);
  handsel::add_object_commands(app, exit_code);
  handsel::add_bench_command(app, exit_code);
  handsel::add_trajectory_commands(app, exit_code);
  handsel::add_model_commands(app, exit_code);
  handsel::add_distance_command(app, exit_code);
  handsel::add_cost_command(app, exit_code);
  handsel::add_plan_command(app, exit_code);
  handsel::add_grasp_commands(app, exit_code);
  add_path_option(app);
  try {
    require_known(app, argc, argv);
    app.parse(argc, argv);
    return exit_code;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app.exit(version);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "handsel: %s\n", error.what());
    return 2;
  } catch (const handsel::ConfigError& error) {
    std::fprintf(stderr, "handsel: %s\n", error.what());
    return 2;
  } catch (const handsel::MissingError& error) {
    std::fprintf(stderr, "handsel: %s\n", error.what());
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "handsel: %s\n", error.what());
    return 2;
  }
}
