// The subcommands of `handsel`, one function a group. Each adds its subcommands to the application; running one sets exit_code:
// 0 yes, 1 the answer is no, 2 bad usage or bad input (ConfigError), 3 something needed is not there (MissingError).
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

void add_up_command(CLI::App& app, int& exit_code);
void add_run_command(CLI::App& app, int& exit_code);
void add_task_commands(CLI::App& app, int& exit_code);  ///< task, speed
void add_story_command(CLI::App& app, int& exit_code);
void add_status_command(CLI::App& app, int& exit_code);
void add_health_command(CLI::App& app, int& exit_code);
void add_topic_commands(CLI::App& app, int& exit_code);
void add_doctor_command(CLI::App& app, int& exit_code);
void add_record_commands(CLI::App& app, int& exit_code);  ///< record, replay
void add_eval_command(CLI::App& app, int& exit_code);
void add_bench_command(CLI::App& app, int& exit_code);

void add_trajectory_commands(CLI::App& app, int& exit_code);
/// Of the group "trajectory".
void add_cartesian_command(CLI::App& trajectory, int& exit_code);
void add_timed_command(CLI::App& trajectory, int& exit_code);
void add_model_commands(CLI::App& app, int& exit_code);
void add_distance_command(CLI::App& app, int& exit_code);
void add_cost_command(CLI::App& app, int& exit_code);
void add_plan_command(CLI::App& app, int& exit_code);
void add_grasp_commands(CLI::App& app, int& exit_code);

}  // namespace handsel
