// SPDX-License-Identifier: Apache-2.0
// The subcommands of `handsel`, one function a group. Each adds its subcommands to the application;
// running one sets exit_code: 0 yes, 1 the answer is no, 2 bad usage or bad input (ConfigError), 3
// something needed is not there (MissingError).
#pragma once

#include <CLI/CLI.hpp>

namespace handsel {

/// Adds `up`: starts every process and keeps them running until Ctrl-C.
void add_up_command(CLI::App& app, int& exit_code);
/// Adds `run`: performs a scenario with all processes.
void add_run_command(CLI::App& app, int& exit_code);
/// Adds `task` and its subcommands, and `speed`.
void add_task_commands(CLI::App& app, int& exit_code);
/// Adds `story`: runs story files over real processes.
void add_story_command(CLI::App& app, int& exit_code);
/// Adds `status`: processes, task, trajectory and mode.
void add_status_command(CLI::App& app, int& exit_code);
/// Adds `health`: exit code for scripts.
void add_health_command(CLI::App& app, int& exit_code);
/// Adds `topic` and its subcommands: DDS traffic.
void add_topic_commands(CLI::App& app, int& exit_code);
/// Adds `doctor`: what would stop the system here.
void add_doctor_command(CLI::App& app, int& exit_code);
/// Adds `record` and `replay`.
void add_record_commands(CLI::App& app, int& exit_code);
/// Adds `eval`: randomised trials in lock-step.
void add_eval_command(CLI::App& app, int& exit_code);
/// Adds `environment`: a scenario in lock-step, driven by requests on the standard input.
void add_environment_command(CLI::App& app, int& exit_code);
/// Adds `config show` and `config diff`: settings and their sources.
void add_config_commands(CLI::App& app, int& exit_code);
/// Adds `object new`: an object of a user's mesh.
void add_object_commands(CLI::App& app, int& exit_code);
/// Adds `bench`: benchmarks against a peer.
void add_bench_command(CLI::App& app, int& exit_code);

/// Adds `trajectory` and its subcommands.
void add_trajectory_commands(CLI::App& app, int& exit_code);
/// Adds `cartesian` to the group "trajectory": motion through poses of the tool.
void add_cartesian_command(CLI::App& trajectory, int& exit_code);
/// Adds `timed` to the group "trajectory": timing of a given path.
void add_timed_command(CLI::App& trajectory, int& exit_code);
/// Adds `model` and its subcommands.
void add_model_commands(CLI::App& app, int& exit_code);
/// Adds `distance`: contact and distance of shapes.
void add_distance_command(CLI::App& app, int& exit_code);
/// Adds `cost`: human-aware costs around a person.
void add_cost_command(CLI::App& app, int& exit_code);
/// Adds `plan`: collision-free paths.
void add_plan_command(CLI::App& app, int& exit_code);
/// Adds `grasp` and its subcommands.
void add_grasp_commands(CLI::App& app, int& exit_code);

}  // namespace handsel
