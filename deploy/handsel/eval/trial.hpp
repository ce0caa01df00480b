// SPDX-License-Identifier: Apache-2.0
// One randomised performance of a scenario in lock-step, and many of them side by side.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/bus/node_context.hpp"

namespace handsel {

struct TrialOptions {
  std::string scenario;  ///< name or file, copied into the line
  /// Mode of the attention and law of its clocks, for the line.
  std::string attention{"adaptive"}, clock_law{"linear"};
  std::string condition, participant;  ///< of a study; empty: the attention's mode; none
  std::size_t order{};                 ///< number among the trials asked for, from 1; 0: none
  bool hash_outputs{};  ///< adds "output_hash": of every value every component sent, and when
  std::string record;   ///< file that every sample is recorded into; empty: none
  double timeout{};     ///< [s] of virtual time; 0: the scenario's
  /// Time [s] and text of each event; may be empty.
  std::function<void(double, const std::string&)> on_event;
};

/// Performs the scenario of `context` with its seed. The line of `handsel eval`: scenario, seed,
/// success, failure, reason, duration_s, …
nlohmann::json run_trial(const NodeContext& context, const TrialOptions& options);

/// A trial to be done.
struct Trial {
  NodeContext context;   ///< scenario, robot, settings and seed
  TrialOptions options;  ///< `scenario` must name that of `context`
};

/// Each trial in an operating-system process of its own, `jobs` at a time, so that no state is
/// carried over and a crash is one failed trial (failure "crash"). Calls on_line in the order of
/// the trials. False when one crashed or was not performed: scenario or settings were refused
/// (failure "refused"), or another error (failure "error").
bool run_trials(const std::vector<Trial>& trials, int jobs,
                const std::function<void(const nlohmann::json&)>& on_line);

/// Returns the 95 % score interval of a ratio (Wilson 1927): low, high.
std::pair<double, double> wilson_interval(int successes, int trials);

}  // namespace handsel
