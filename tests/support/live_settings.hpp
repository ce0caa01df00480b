// The settings as shipped, but for how often a running path is looked at.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/config/resources.hpp"

namespace handsel::test {

inline std::filesystem::path live_settings(const std::string& folder, const std::string& period) {
  const std::filesystem::path settings = std::filesystem::path(folder) / ("config" + std::to_string(getpid()) + "_" + period);
  if (std::filesystem::exists(settings)) return settings;
  std::filesystem::copy(resource("config"), settings, std::filesystem::copy_options::recursive);
  std::ofstream(settings / "manipulation_planner.txtpb", std::ios::app) << "live_period: " << period << "\n";
  return settings;
}

}  // namespace handsel::test
