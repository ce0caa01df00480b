// SPDX-License-Identifier: Apache-2.0
// Frames of TF as they were received last. Pure.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/base/time.hpp"
#include "common/messages/ros2.hpp"

namespace handsel::ros2_lane {

class TfTree {
 public:
  /// A static frame does not grow old. At 4096 frames those not sent for ten seconds are forgotten;
  /// while there is no room, false.
  bool set(const ros2::Transform&, TimePoint arrival, bool is_static);

  struct Place {
    Pose T_root_frame{Pose::Identity()};  ///< from the frame to the root [m]
    Stamp stamp{};                        ///< of the frame itself; 0: static
    /// Of the oldest transform up to the root that is not static; max when all is.
    TimePoint arrival{};
  };
  /// Returns a frame's place, or nullopt when its parents do not lead to the root within 64 steps.
  std::optional<Place> find(const std::string& frame, const std::string& root) const;

 private:
  struct Frame {
    ros2::Transform transform;
    TimePoint arrival{};
    bool is_static{};
  };
  bool evict_oldest(TimePoint now);
  std::map<std::string, Frame> frames_;  // by child
  std::optional<TimePoint> swept_;
};

}  // namespace handsel::ros2_lane
