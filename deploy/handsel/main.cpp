#include <cstdio>
#include <exception>

#include "common/base/errors.hpp"
#include "deploy/handsel/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Handsel lets a robot arm hand things to people. `handsel COMMAND --help` explains a command."};
  app.name("handsel");
  app.require_subcommand(1);
  int exit_code = 0;
  handsel::add_up_command(app, exit_code);
  handsel::add_run_command(app, exit_code);
  handsel::add_task_commands(app, exit_code);
  handsel::add_story_command(app, exit_code);
  handsel::add_status_command(app, exit_code);
  handsel::add_topic_commands(app, exit_code);
  handsel::add_doctor_command(app, exit_code);
  handsel::add_eval_command(app, exit_code);
  handsel::add_trajectory_commands(app, exit_code);
  handsel::add_model_commands(app, exit_code);
  handsel::add_distance_command(app, exit_code);
#ifdef HANDSEL_PLAN_COMMAND
  handsel::add_plan_command(app, exit_code);
#endif
  handsel::add_grasp_commands(app, exit_code);
  try {
    app.parse(argc, argv);
    return exit_code;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app.exit(help);
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
