// SPDX-License-Identifier: Apache-2.0
#include "common/model/manipulator.hpp"

#include <algorithm>

#include "common/config/resources.hpp"
#include "common/config/schema/robot.pb.h"
#include "common/model/description/robot_model_builder.hpp"
#include "common/model/description/robot_text.hpp"

namespace handsel {
namespace {

/// Returns whether `link` is `of`, or moves with it.
bool hangs_on(const RobotModel& robot, int link, int of) {
  for (; link >= 0 && link != of;) {
    const int joint = robot.links()[static_cast<std::size_t>(link)].parent_joint;
    link = joint < 0 ? -1 : robot.joints()[static_cast<std::size_t>(joint)].parent;
  }
  return link == of;
}

/// Returns the nearest group whose tip carries all of `fingers`; nullptr if there is none.
const Group* carrier(const RobotModel& robot, const Group& fingers) {
  const Group* nearest = nullptr;
  for (const Group& arm : robot.groups()) {
    if (arm.tip < 0 || arm.axes.empty() ||
        (nearest != nullptr && !hangs_on(robot, arm.tip, nearest->tip)))
      continue;
    const bool carries = std::all_of(fingers.axes.begin(), fingers.axes.end(), [&](int axis) {
      const Joint& joint = robot.joints()[static_cast<std::size_t>(
          robot.axes()[static_cast<std::size_t>(axis)].joint)];
      return hangs_on(robot, joint.parent, arm.tip);
    });
    if (carries) nearest = &arm;
  }
  return nearest;
}

}  // namespace

std::vector<Manipulator> hands_of(const RobotModel& robot) {
  std::vector<Manipulator> out;
  if (robot.tool_link() >= 0 || robot.group("hand") != nullptr)
    out.push_back(
        {"arm", robot.group("arm"), robot.group("hand"), robot.hand(), robot.tool_link()});
  for (const Group& fingers : robot.groups()) {
    if (fingers.tip >= 0 || fingers.axes.empty() || fingers.name == "hand") continue;
    const Group* arm = carrier(robot, fingers);
    if (arm == nullptr || arm->tip == robot.tool_link()) continue;
    out.push_back({arm->name, arm, &fingers, "", arm->tip});
  }
  return out;
}

int hand_index(const std::vector<Manipulator>& hands, const std::string& fingers) {
  if (fingers.empty()) return hands.empty() ? -1 : 0;
  for (std::size_t i = 0; i < hands.size(); ++i)
    if (hands[i].fingers != nullptr && hands[i].fingers->name == fingers)
      return static_cast<int>(i);
  return -1;
}

std::vector<Manipulator> manipulators(const std::filesystem::path& description,
                                      const RobotModel& robot) {
  const config::RobotDescription text = read_robot_text(description);
  std::vector<Manipulator> out;
  const auto add = [&](const std::string& field, const std::string& arm, const std::string& fingers,
                       const std::string& hand) {
    Manipulator m;
    m.name = arm;
    m.arm = robot.group(arm);
    m.fingers = robot.group(fingers);
    m.hand = described_name(description, hand);
    const auto fault = [&](const std::string& what) {
      throw ConfigError(locate(description, "\"" + arm + "\"") + ": " + field + ": " + what);
    };
    if (m.arm == nullptr) fault("there is no group \"" + arm + "\"");
    if (m.fingers == nullptr) fault("there is no group \"" + fingers + "\"");
    if (m.hand.empty()) fault("arm \"" + arm + "\" names no hand");
    m.palm = m.arm->tip;
    if (m.palm < 0) fault("group \"" + arm + "\" has no tip_link, the palm of its hand");
    out.push_back(m);
  };
  if (robot.group("arm") != nullptr && !robot.hand().empty())
    add("arm", "arm", "hand", robot.hand());
  for (const config::OtherArm& other : text.other_arms())
    add("other_arms", other.arm(), other.hand_group(), other.hand());
  return out;
}

}  // namespace handsel
