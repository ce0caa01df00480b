// SPDX-License-Identifier: Apache-2.0
// The language of stories: one line, one step (docs/stories.md). Pure: text in, steps out.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace handsel {

enum class StepKind {
  start,    ///< start SCENARIO [seed N] [robot R]
  wait,     ///< wait CONDITION within T: must hold now or later; what held before does not count
  task,     ///< task KIND OBJECT [to PERSON | from PERSON | on SURFACE]
  control,  ///< pause | resume | cancel | acknowledge | speed P
  kill,     ///< kill [-9|-15] PROCESS...
  silence,  ///< silence PROCESS [for T]: SIGSTOP, then SIGCONT
  wake,     ///< wake PROCESS: SIGCONT
  sim,      ///< sim ACTION [SUBJECT] [VALUE]: a SimControl
  expect,   ///< expect CONDITION within T: counted from the last step that did something
  never,    ///< never CONDITION for T: from the last step that did something
  listen,   ///< listen for T
  stop,     ///< stop: everything is stopped and must be gone
};

/// What can be waited for, expected or excluded.
enum class ConditionKind {
  ready,     ///< every component is ok
  mode,      ///< mode M: that mode or, but for normal, a more severe one
  cause,     ///< cause C: the controller names it
  phase,     ///< phase P of the running action
  carrier,   ///< carrier robot|human|surface|both
  hand,      ///< hand GROUP: the fingers of this group of joints have grasped something
  task,      ///< task done|failed|cancelled|paused|running|refused
  handover,  ///< the simulator's oracle says so
  moving,
  rest,          ///< the arm by the simulator's word
  back,          ///< back PROCESS: reports ok again (after a kill: another incarnation)
  degraded,      ///< degraded PROCESS
  status_names,  ///< status names NAME: `handsel status` has a trouble that names it
  speed_below,   ///< speed below F: factor advised or in force
  no_limit_violations,
  no_ssm_violations,
  no_collisions,
  one_commander,
  not_dropped,
};

struct Condition {
  ConditionKind kind{};  ///< decides whether `subject` or `value` follows
  std::string subject;   ///< name or word of the condition; empty for kinds without one
  double value{};        ///< of speed_below: the factor; else 0
};

struct StoryStep {
  int line{};                          ///< number in the file, from 1
  std::string text;                    ///< as written
  std::optional<Duration> at;          ///< after the last task line
  StepKind kind{};                     ///< decides which of the fields below are used
  std::vector<std::string> words;      ///< arguments
  std::optional<Condition> condition;  ///< of wait, expect and never
  Duration limit{};                    ///< of wait, expect, never, pause, silence (0: until wake)
};

struct Story {
  std::string name;              ///< for messages: the file
  std::vector<StoryStep> steps;  ///< at least one; the first is start, and no other
};

/// Throws ConfigError "file:line: …" naming the word and what would be right.
Story parse_story(const std::string& text, const std::string& name);
Story read_story(const std::filesystem::path& file);  ///< also throws MissingError
/// "1.2s", "350ms"; nullopt if it is neither.
std::optional<Duration> parse_duration(const std::string& word);
}  // namespace handsel
