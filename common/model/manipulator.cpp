#include "common/model/manipulator.hpp"

#include "common/config/resources.hpp"
#include "common/config/robot.pb.h"
#include "common/model/robot_model_builder.hpp"

namespace handsel {

std::vector<Manipulator> manipulators(const std::filesystem::path& description, const RobotModel& robot) {
  config::RobotDescription text;
  load_text_proto(description, text);
  std::vector<Manipulator> out;
  const auto add = [&](const std::string& field, const std::string& arm, const std::string& fingers, const std::string& hand) {
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
  if (robot.group("arm") != nullptr && !robot.hand().empty()) add("arm", "arm", "hand", robot.hand());
  for (const config::OtherArm& other : text.other_arms()) add("other_arms", other.arm(), other.hand_group(), other.hand());
  return out;
}

}  // namespace handsel
