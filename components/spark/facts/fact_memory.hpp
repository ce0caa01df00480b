// SPDX-License-Identifier: Apache-2.0
// Hysteresis of facts: a fact begins at one limit and ends at another, after a dwell time. Pure.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "common/base/time.hpp"
#include "common/messages/world.hpp"

namespace handsel::spark {

/// A possible fact.
struct Candidate {
  FactKind kind{};              ///< kind, subject and object identify a fact
  std::string subject, object;  ///< ids; the robot is kRobotName or empty, depending on the kind
  double value{};               ///< measured value, as in Fact
  bool begins{};                ///< whether the fact holds, even if it did not before
  bool stays{};                 ///< whether the fact continues to hold
  std::string evidence;         ///< measurement as one line of text
};

/// Returns a line of evidence, printf style.
std::string evidence(const char* format, ...) __attribute__((format(printf, 1, 2)));

class FactMemory {
 public:
  /// `dwell`: time for which a fact holds after its candidate neither begins nor stays, or is
  /// absent [s].
  explicit FactMemory(double dwell) : dwell_(dwell) {}

  /// Returns the facts of a sample, from all its candidates with distinct kind, subject and object;
  /// to be called once per sample.
  std::vector<Fact> update(const std::vector<Candidate>& candidates, TimePoint now);

 private:
  struct State {
    Fact fact;
    TimePoint since, confirmed;
  };
  double dwell_;
  std::map<std::tuple<FactKind, std::string, std::string>, State> states_;
};

}  // namespace handsel::spark
