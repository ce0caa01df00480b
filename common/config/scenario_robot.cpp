#include "common/config/scenario_robot.hpp"

#include "common/config/described.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/scenario.pb.h"

namespace handsel {

std::string scenario_robot(const std::string& scenario) {
  if (scenario.empty()) return "jido";
  config::Scenario read;
  const std::filesystem::path file = scenario_file(scenario);
  load_text_proto(file, read);
  return read.robot().empty() ? "jido" : described_name(file, read.robot());
}

}  // namespace handsel
