// SPDX-License-Identifier: Apache-2.0
// What a performance came to: for machines (JSON) and for people.
#pragma once

#include <map>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "deploy/handsel/system/performer.hpp"

namespace handsel {

/// Counters a component has gathered since its start, for differences over a performance.
struct Counters {
  std::uint64_t deadline_misses{}, rejected{};  ///< sums over all topics of the component
};
/// Returns the counters of each component that has sent its health.
std::map<std::string, Counters> counters(const Snapshot&);

struct ReportInputs {
  std::string scenario, robot;             ///< names, copied into the report
  std::uint64_t seed{};                    ///< of the simulation, copied into the report
  double ready{};                          ///< from start to ready [s]
  std::map<std::string, Counters> before;  ///< as the performance began
  GroundTruth ground_truth_before;         ///< newest as the performance began
  std::map<std::string, int> restarts;     ///< by process, those above 0
};

/// One object with the fields of `handsel run --report`.
nlohmann::json make_report(const ReportInputs&, const Performer&, const Observer&);
/// A few lines for people.
std::string summary(const nlohmann::json& report);

}  // namespace handsel
