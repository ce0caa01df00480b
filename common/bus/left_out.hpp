// SPDX-License-Identifier: Apache-2.0
// What quotas have left out, by cause, for ComponentHealth.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/messages/system.hpp"

namespace handsel {

class Intake;

/// Counts by cause since construction. 23 causes have counts of their own, later ones are counted
/// together as "other".
class LeftOutCounts {
 public:
  /// Adds to the count of this cause; nothing for 0.
  void add(const std::string& what, std::uint64_t more);
  /// Returns all counts in order of their names, at most 24.
  std::vector<NamedCount> counts() const;

 private:
  std::map<std::string, std::uint64_t> counts_;
};

/// Appends the number of malformed list elements removed from the valid samples of a subscription;
/// nothing for 0 or when `counts` already has the 32 entries of ComponentHealth.left_out.
void add_left_out(const Intake& intake, std::vector<NamedCount>& counts);

}  // namespace handsel
