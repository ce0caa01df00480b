// SPDX-License-Identifier: Apache-2.0
#include "common/topics/topics.hpp"

#include <algorithm>
#include <iterator>

namespace handsel {

const char* name(Profile profile) {
  static constexpr const char* kNames[] = {"sensor", "state",    "command", "latch", "goal",
                                           "advice", "setpoint", "request", "reply", "health"};
  return kNames[static_cast<std::size_t>(profile)];
}

const TopicRow* find_topic(std::string_view wanted) {
  constexpr std::string_view kPrefix = "handsel/";
  for (const TopicRow& row : kTopics) {
    const std::string_view topic = row.topic;
    if (wanted == row.type || wanted == topic || wanted == topic.substr(kPrefix.size()))
      return &row;
  }
  return nullptr;
}

bool has_one_writer(const TopicRow& row) {
  constexpr std::string_view kSafety[] = {
      "handsel/joint_command", "handsel/go",           "handsel/safety_state",
      "handsel/trajectory",    "handsel/hand_command", "handsel/human_state",
      "handsel/robot_state",   "handsel/scene",        "handsel/action_status"};
  return std::find(std::begin(kSafety), std::end(kSafety), row.topic) != std::end(kSafety);
}

bool is_of_all_systems(const TopicRow& row) { return &row == &TopicOf<RobotReport>::row; }

bool named_in(const char* list, std::string_view component) {
  std::string_view rest = list;
  while (!rest.empty()) {
    const std::size_t space = rest.find(' ');
    if (rest.substr(0, space) == component) return true;
    rest = space == std::string_view::npos ? std::string_view() : rest.substr(space + 1);
  }
  return false;
}

}  // namespace handsel
