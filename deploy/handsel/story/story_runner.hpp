// SPDX-License-Identifier: Apache-2.0
// Runs a story over real processes: does what its lines say, watches over DDS, and says which line
// did not come true.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "deploy/handsel/story/story.hpp"
#include "deploy/handsel/system/system.hpp"

namespace handsel {

struct StoryOptions {
  int domain{0};          ///< DDS domain, 0..230
  std::uint64_t seed{0};  ///< 0: as the story says
};

class StoryRunner {
 public:
  StoryRunner(Story story, const StoryOptions& options);
  ~StoryRunner();

  /// Prints each line with the time it took to stderr. False when a line did not come true: the
  /// timeline, the seed and where the logs are are printed. Throws ConfigError / MissingError for
  /// what cannot be started or named.
  bool run();

 private:
  /// An expectation watched since the last doing.
  struct Watch {
    const StoryStep* step{};
    bool held{false};
    TimePoint first{};
  };

  void perform(std::size_t index);  ///< throws Unfulfilled
  void start(const StoryStep& step);
  void send_task(const StoryStep& step);
  void remind();
  void send_control(const StoryStep& step);
  void send_sim(const StoryStep& step);
  void signal_process(const std::string& process, int signal);
  void await(const StoryStep& step);
  /// What was seen against a condition; may be empty.
  std::string evidence(const Condition& condition) const;
  void refute(const StoryStep& step);
  void stop();
  void begin_watching(std::size_t index);
  void on_snapshot(const Snapshot& snapshot, TimePoint now);
  bool holds(const Condition& condition, const Snapshot& snapshot, TimePoint now) const;
  bool task_is(const std::string& word, const Snapshot& snapshot) const;
  void listen_until(TimePoint until);
  void wake_due();
  TimePoint now() const;
  void print_timeline() const;

  Story story_;
  StoryOptions options_;
  std::uint64_t seed_{1};
  std::unique_ptr<System> system_;
  std::unique_ptr<Publisher<SimControl>> sim_;
  std::vector<Watch> watches_;
  TimePoint origin_{}, task_time_{}, story_begin_{};
  std::uint64_t task_id_{0};
  TaskGoal goal_;  // of the last task
  TimePoint goal_sent_{};
  std::map<std::string, std::uint64_t> killed_;  ///< incarnation a killed process had
  // silenced processes by the time of their SIGCONT
  std::multimap<TimePoint, std::string> to_wake_;
};

}  // namespace handsel
