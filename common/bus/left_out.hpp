// What quotas have left out, by cause, for ComponentHealth.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/messages/system.hpp"

namespace handsel {

class Intake;

/// Counts by name. Names beyond the bound of ComponentHealth.left_out are counted together as
/// "other".
class LeftOutCounts {
 public:
  /// Adds to the count of this cause; nothing for 0.
  void add(const std::string& what, std::uint64_t more);
  /// Returns all counts in order of their names, at most 24.
  std::vector<NamedCount> counts() const;

 private:
  std::map<std::string, std::uint64_t> counts_;
};

/// Appends what a subscription has left out of its samples, if anything and if there is room.
void add_left_out(const Intake& intake, std::vector<NamedCount>& counts);

}  // namespace handsel
