// Who may move and when: the Go epochs (architecture: mode machine). Pure.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/supervisor.pb.h"
#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"

namespace handsel::supervisor {

/// A new epoch is granted when nothing but the missing permission holds the robot back; permission is withdrawn, once the running
/// trajectory has ended, when a required component is gone.
class Permission {
 public:
  explicit Permission(const config::SupervisorSettings& settings);

  void on(const ComponentHealth& health, TimePoint arrival);
  void on(const ExecutionStatus& status, TimePoint arrival);
  void pause(bool paused) { paused_ = paused; }
  void acknowledge() { acknowledge_ = true; }
  void set_override(double factor) { go_.override_factor = factor; }

  const Go& step(TimePoint now);
  /// Required components that are not there; empty when all are.
  const std::vector<std::string>& missing() const { return missing_; }

 private:
  void find_missing(TimePoint now);

  config::SupervisorSettings settings_;
  std::map<std::string, TimePoint> alive_;
  std::vector<std::string> missing_;
  bool status_known_{false}, paused_{false}, acknowledge_{false};
  ExecutionStatus status_;
  TimePoint clear_since_{};
  bool clear_{false};
  Go go_;
};

}  // namespace handsel::supervisor
