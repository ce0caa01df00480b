// SPDX-License-Identifier: Apache-2.0
// Which components are alive, and which topics those write and read. Pure.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/messages/system.hpp"
#include "components/bridge/foxglove.hpp"

namespace handsel::bridge {

/// Graph of the system from the table of topics and from the health that components report.
class SystemGraph {
 public:
  /// Takes a report that arrived at `arrival`; those of components that write no health are left
  /// out.
  void on(const ComponentHealth& health, TimePoint arrival);
  /// Returns writers and readers of each topic among the components alive at `now`.
  /// `read_here`: by place in the table of topics, whether the bridge reads the topic.
  Graph graph(TimePoint now, const std::vector<bool>& read_here) const;

 private:
  std::map<std::string, TimePoint> last_health_;  ///< By component.
};

}  // namespace handsel::bridge
