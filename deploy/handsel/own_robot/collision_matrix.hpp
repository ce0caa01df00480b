// SPDX-License-Identifier: Apache-2.0
// Samples which links of a robot can touch each other. Own method, after the setup assistant of
// MoveIt: pairs that always or never touch need no test.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel {

enum class PairKind { sometimes, never, always };

/// Returns "Sometimes", "Never" or "Always", as an SRDF gives its reasons.
const char* name_of(PairKind kind);

/// Two links that the model tests against each other.
struct LinkPair {
  int a{}, b{};                        ///< indices into RobotModel::links(), a < b
  PairKind kind{PairKind::sometimes};  ///< in the configurations sampled
  double touched{};                    ///< fraction of the first configurations that touch
};

struct MatrixSettings {
  int configurations{100'000};  ///< for pairs that have not touched
  int first{1000};              ///< configurations in which all pairs are tested
  double always{0.95};          ///< a larger fraction of touching configurations counts as always
  std::uint64_t seed{1};        ///< of the random configurations
};

/// Tests the pairs that the model does not disable, in configurations drawn evenly within the
/// limits. `progress` gets the fraction done, 0 to 1; it may return false to end the sampling: the
/// pairs that have not touched then count as never.
std::vector<LinkPair> sample_pairs(const RobotModel& robot, const MatrixSettings& settings,
                                   const std::function<bool(double)>& progress);

/// Returns the pairs of links whose capsules overlap in a configuration, disabled pairs left out.
std::vector<std::pair<int, int>> overlapping_hulls(const RobotModel& robot, const Vector& q);

}  // namespace handsel
