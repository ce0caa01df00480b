// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/story/story.hpp"

#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "common/base/errors.hpp"
#include "common/config/text_check.hpp"
#include "common/config/text_file.hpp"

namespace handsel {
namespace {

using Words = std::vector<std::string>;

Words split(const std::string& line) {
  std::istringstream in(line.substr(0, line.find('#')));
  Words words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::optional<double> parse_number(const std::string& word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

struct ConditionRule {
  ConditionKind kind;
  bool subject;  ///< one more word follows
  bool number;   ///< one number follows
};

const std::map<std::string, ConditionRule>& condition_rules() {
  static const std::map<std::string, ConditionRule> rules{
      {"ready", {ConditionKind::ready, false, false}},
      {"mode", {ConditionKind::mode, true, false}},
      {"cause", {ConditionKind::cause, true, false}},
      {"phase", {ConditionKind::phase, true, false}},
      {"carrier", {ConditionKind::carrier, true, false}},
      {"hand", {ConditionKind::hand, true, false}},
      {"task", {ConditionKind::task, true, false}},
      {"handover", {ConditionKind::handover, false, false}},
      {"moving", {ConditionKind::moving, false, false}},
      {"rest", {ConditionKind::rest, false, false}},
      {"back", {ConditionKind::back, true, false}},
      {"degraded", {ConditionKind::degraded, true, false}},
      {"status names", {ConditionKind::status_names, true, false}},
      {"speed below", {ConditionKind::speed_below, false, true}},
      {"no limit violations", {ConditionKind::no_limit_violations, false, false}},
      {"no separation violations", {ConditionKind::no_ssm_violations, false, false}},
      {"no collisions", {ConditionKind::no_collisions, false, false}},
      {"one commander", {ConditionKind::one_commander, false, false}},
      {"nothing dropped", {ConditionKind::not_dropped, false, false}},
  };
  return rules;
}

class LineParser {
 public:
  LineParser(StoryStep& step, const std::string& where, Words words)
      : step_(step), where_(where), words_(std::move(words)) {}

  void parse() {
    if (word() == "at") {
      take();
      step_.at = take_duration("at");
    }
    const std::string verb = take();
    if (verb == "start") {
      step_.kind = StepKind::start;
      take_rest("a scenario");
    } else if (verb == "wait" || verb == "expect") {
      step_.kind = verb == "wait" ? StepKind::wait : StepKind::expect;
      take_condition();
      if (word() == "within") {
        take();
        step_.limit = take_duration("within");
      } else if (step_.kind == StepKind::wait) {
        fail("wait needs \"within\" and a time, e.g. within 10s");
      }
    } else if (verb == "never") {
      step_.kind = StepKind::never;
      take_condition();
      expect_word("for");
      step_.limit = take_duration("for");
    } else if (verb == "task") {
      step_.kind = StepKind::task;
      take_task();
    } else if (verb == "pause" || verb == "resume" || verb == "cancel" || verb == "acknowledge" ||
               verb == "speed") {
      step_.kind = StepKind::control;
      step_.words = {verb};
      if (verb == "speed") step_.words.push_back(take_number("speed"));
    } else if (verb == "kill") {
      step_.kind = StepKind::kill;
      if (word() != "-9" && word() != "-15") step_.words = {"-9"};
      take_rest("a process");
    } else if (verb == "silence") {
      step_.kind = StepKind::silence;
      step_.words = {take_any("a process")};
      if (word() == "for") {
        take();
        step_.limit = take_duration("for");
      }
    } else if (verb == "wake") {
      step_.kind = StepKind::wake;
      step_.words = {take_any("a process")};
    } else if (verb == "sim") {
      step_.kind = StepKind::sim;
      take_rest("an action of the simulator");
    } else if (verb == "listen") {
      step_.kind = StepKind::listen;
      expect_word("for");
      step_.limit = take_duration("for");
    } else if (verb == "stop") {
      step_.kind = StepKind::stop;
    } else {
      fail("\"" + verb +
           "\" is no step; a line begins with start, wait, task, pause, resume, cancel, "
           "acknowledge, speed, kill, silence, wake, sim, "
           "expect, never, listen or stop");
    }
    if (position_ < words_.size()) fail("\"" + word() + "\" is one word too many");
  }

 private:
  std::string word() const { return position_ < words_.size() ? words_[position_] : std::string(); }
  std::string take() { return position_ < words_.size() ? words_[position_++] : std::string(); }
  [[noreturn]] void fail(const std::string& what) const {
    constexpr std::size_t kMaxComplaint = 700;  // max length; a wrong word is quoted [bytes]
    throw ConfigError(where_ + printable(what, kMaxComplaint));
  }

  std::string take_any(const std::string& wanted) {
    if (word().empty()) fail("the line ends where " + wanted + " should follow");
    return take();
  }
  std::string take_number(const std::string& after) {
    if (!parse_number(word())) fail("\"" + after + "\" needs a number, not \"" + word() + "\"");
    return take();
  }
  Duration take_duration(const std::string& after) {
    const auto duration = parse_duration(word());
    if (!duration)
      fail("\"" + after + "\" needs a time such as 1.2s or 350ms, not \"" + word() + "\"");
    take();
    return *duration;
  }
  void expect_word(const std::string& wanted) {
    if (word() != wanted) fail("\"" + wanted + "\" should follow, not \"" + word() + "\"");
    take();
  }
  void take_rest(const std::string& wanted) {
    const std::size_t before = position_;
    while (position_ < words_.size()) step_.words.push_back(take());
    if (position_ == before) fail("the line ends where " + wanted + " should follow");
  }
  /// Reads kind and object of a task, then pairs of a preposition and a name.
  void take_task() {
    take_rest("a kind of task");
    for (std::size_t i = 2; i < step_.words.size(); i += 2) {
      const std::string& word = step_.words[i];
      if (word != "to" && word != "from" && word != "on")
        fail("\"" + word +
             "\" is not understood here; to PERSON, from PERSON or on SURFACE may follow");
      if (i + 1 == step_.words.size())
        fail("the line ends where a name should follow \"" + word + "\"");
    }
  }
  void take_condition() {
    std::string phrase;
    for (std::size_t used = 1; used <= 3 && position_ + used <= words_.size(); ++used) {
      phrase += (used > 1 ? " " : "") + words_[position_ + used - 1];
      const auto rule = condition_rules().find(phrase);
      if (rule == condition_rules().end()) continue;
      position_ += used;
      step_.condition =
          Condition{.kind = rule->second.kind,
                    .subject = rule->second.subject ? take_any("a name") : std::string()};
      if (rule->second.number) step_.condition->value = *parse_number(take_number(phrase));
      return;
    }
    std::string known;
    for (const auto& [text, rule] : condition_rules()) known += (known.empty() ? "" : ", ") + text;
    fail("\"" + word() + "\" is no condition; there are " + known);
  }

  StoryStep& step_;
  std::string where_;
  Words words_;
  std::size_t position_{0};
};

}  // namespace

std::optional<Duration> parse_duration(const std::string& word) {
  for (const auto& [unit, scale] : {std::pair<const char*, double>{"ms", 1e-3}, {"s", 1.0}}) {
    const std::size_t length = std::char_traits<char>::length(unit);
    if (word.size() <= length || word.compare(word.size() - length, length, unit) != 0) continue;
    const auto value = parse_number(word.substr(0, word.size() - length));
    if (value && *value >= 0 && *value <= 86400) return from_seconds(*value * scale);
    return std::nullopt;
  }
  return std::nullopt;
}

Story parse_story(const std::string& text, const std::string& name) {
  Story story{.name = name};
  std::istringstream in(text);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    Words words = split(line);
    if (words.empty()) continue;
    StoryStep step{.line = number, .text = line.substr(0, line.find('#'))};
    step.text.erase(step.text.find_last_not_of(" \t\r") + 1);
    step.text.erase(0, step.text.find_first_not_of(" \t"));
    const std::string where = name + ":" + std::to_string(number) + ": ";
    LineParser(step, where, std::move(words)).parse();
    if (story.steps.empty() && step.kind != StepKind::start)
      throw ConfigError(where + "a story begins with start");
    if (!story.steps.empty() && step.kind == StepKind::start)
      throw ConfigError(where + "a story starts once");
    story.steps.push_back(std::move(step));
  }
  if (story.steps.empty()) throw ConfigError(name + ": the story has no step");
  return story;
}

Story read_story(const std::filesystem::path& file) {
  return parse_story(read_text_file(file), file.string());
}

}  // namespace handsel
