// SPDX-License-Identifier: Apache-2.0
// The recorded handover of the reference data.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "common/geometry/pose.hpp"
#include "tests/support/reference_data.hpp"

namespace handsel::test {

inline std::vector<std::vector<double>> rows(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<std::vector<double>> out;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::string cell;
    out.emplace_back();
    while (std::getline(cells, cell, ',')) out.back().push_back(std::stod(cell));
  }
  return out;
}

inline Vector3 place(const std::vector<double>& row) { return {row[0], row[1], row[2]}; }

/// Two people and a baton between them, 120 Hz; the wrenches of its two grips.
struct RecordedHandover {
  explicit RecordedHandover(const std::filesystem::path& folder) {
    const std::pair<const char*, const char*> parts[] = {
        {"head", "head"},        {"neck", "neck"},     {"chest", "torso"},  {"hip", "waist"},
        {"LUArm", "l_shoulder"}, {"LFArm", "l_elbow"}, {"LHand", "l_hand"}, {"RUArm", "r_shoulder"},
        {"RFArm", "r_elbow"},    {"RHand", "r_hand"}};
    for (const char* who : {"giver", "taker"})
      for (const auto& [part, joint] : parts)
        bodies[who].emplace_back(
            joint, rows(folder / (std::string(who) + "_" + part + "_pose_saved.csv")));
    baton = rows(folder / "baton_pose_saved.csv");
    giver_wrench = rows(folder / "Wrench_giver_saved.csv");
    taker_wrench = rows(folder / "Wrench_taker_saved.csv");
  }
  std::map<std::string, std::vector<std::pair<std::string, std::vector<std::vector<double>>>>>
      bodies;
  std::vector<std::vector<double>> baton, giver_wrench, taker_wrench;
};

/// nullopt without HANDSEL_DATA. Throws as reference_data().
inline std::optional<RecordedHandover> recorded_handover() {
  const auto folder = reference_data("motion/kth_handover/handover_sample");
  return folder ? std::optional<RecordedHandover>(*folder) : std::nullopt;
}

}  // namespace handsel::test
