#include "common/config/scenario_robot.hpp"

#include "common/config/resources.hpp"
#include "common/config/scenario.pb.h"

namespace handsel {

std::string scenario_robot(const std::string& scenario) {
  config::Scenario read;
  if (!scenario.empty()) load_text_proto(scenario_file(scenario), read);
  return read.robot().empty() ? "jido" : read.robot();
}

}  // namespace handsel
