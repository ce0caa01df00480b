// SPDX-License-Identifier: Apache-2.0
// The whole system in lock-step, driven by requests: `handsel environment` answers one request a
// line, and the Python class handsel.Environment sends them (docs/environment.md lists them).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "deploy/handsel/environment/observation.hpp"
#include "deploy/handsel/environment/policy_link.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"

namespace handsel::environment {

/// What the policy decides.
enum class Control {
  task,   ///< tasks of the system, which plans and moves by itself
  motion  ///< motions of arm and hand, in the place of the manipulation planner
};

/// One trial of a scenario.
class Trial {
 public:
  /// Runs until every component is ready. Throws ConfigError or MissingError as the components do.
  Trial(const NodeContext& context, Control control);

  /// Carries out an action and advances the virtual time by `duration` [s]. Throws
  /// command::LineError for an action that is none.
  void step(const nlohmann::json& action, double duration);
  /// Returns observation, info, reward, terminated and truncated.
  nlohmann::json state() const;
  /// Returns grasps of an object for {"object", "human", "group", "max_grasps"}.
  nlohmann::json grasps(const nlohmann::json& request);
  /// Plans a motion for the fields of MotionQuery; the plan is run by the action {"run": number}.
  nlohmann::json plan(const nlohmann::json& request);

 private:
  bool succeeded() const;
  void act(const std::string& key, const nlohmann::json& value);
  void send_task(const nlohmann::json& task);
  void send_hand(const nlohmann::json& command);
  PolicyLink& link();

  NodeContext context_;
  config::Scenario scenario_;
  LockstepSystem system_;
  View view_;
  std::unique_ptr<Publisher<TaskGoal>> goals_;
  std::optional<PolicyLink> link_;
  std::map<std::uint64_t, MotionPlan> plans_;
  std::uint64_t tasks_sent_{0}, plans_made_{0};
  TimePoint begin_{};
};

/// Answers requests: "reset", "step", "grasps", "plan".
class Environment {
 public:
  /// Names or paths as on the command line; `robot` empty: that of the scenario.
  Environment(std::string scenario, std::string robot) : scenario_(scenario), robot_(robot) {}
  /// Returns the answer to one request; an error is {"error": sentence}, with "missing": true for a
  /// file that is not there.
  nlohmann::json answer(const nlohmann::json& request);

 private:
  nlohmann::json carry_out(const nlohmann::json& request);
  Trial& trial();

  std::string scenario_, robot_;
  std::unique_ptr<Trial> trial_;
};

}  // namespace handsel::environment
