// What holds begins at one limit and ends at another, and what has only just ended still holds for
// a moment. Pure.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "common/base/time.hpp"
#include "common/messages/world.hpp"

namespace handsel::spark {

/// Something that may be a fact.
struct Candidate {
  FactKind kind{};              ///< kind, subject and object together are its identity
  std::string subject, object;  ///< ids; of the robot kRobotName or empty, as the kind has it
  double value{};               ///< measure of the kind, as in Fact
  bool begins{};                ///< is a fact, also when it was none before
  bool stays{};                 ///< remains one when it was
  std::string evidence;         ///< what was measured, one line for people
};

/// A line of evidence, printf style.
std::string evidence(const char* format, ...) __attribute__((format(printf, 1, 2)));

class FactMemory {
 public:
  /// A fact whose candidate neither begins nor stays, or is not there, holds for `dwell` [s] more.
  explicit FactMemory(double dwell) : dwell_(dwell) {}

  /// To be called once per sample with all candidates of that sample, each kind, subject and object
  /// at most once.
  std::vector<Fact> settle(const std::vector<Candidate>& candidates, TimePoint now);

 private:
  struct State {
    Fact fact;
    TimePoint since, confirmed;
  };
  double dwell_;
  std::map<std::tuple<FactKind, std::string, std::string>, State> states_;
};

}  // namespace handsel::spark
