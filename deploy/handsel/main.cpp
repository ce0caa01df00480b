#include <cstdio>
#include <exception>
#include <string>

#include "common/base/errors.hpp"
#include "common/wire/interface_id.hpp"
#include "deploy/handsel/commands/commands.hpp"

namespace {

/// Follows the words that name commands; throws ConfigError at one that names none.
void require_known(const CLI::App& app, int argc, char** argv) {
  const CLI::App* command = &app;
  for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
    const std::string word = argv[i];
    const auto all = command->get_subcommands([](const CLI::App*) { return true; });
    if (all.empty()) return;
    const auto found = command->get_subcommands(
        [&](const CLI::App* candidate) { return candidate->get_name() == word; });
    if (found.empty())
      throw handsel::ConfigError("there is no command \"" + word +
                                 "\" here; --help names those there are");
    command = found.front();
  }
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
  handsel::add_bench_command(app, exit_code);
  handsel::add_trajectory_commands(app, exit_code);
  handsel::add_model_commands(app, exit_code);
  handsel::add_distance_command(app, exit_code);
  handsel::add_cost_command(app, exit_code);
  handsel::add_plan_command(app, exit_code);
  handsel::add_grasp_commands(app, exit_code);
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
