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
  /// Stores or replaces a frame. For a new one beyond 4096 forgets those not sent for 10 s, at most
  /// once a second and never static ones; returns false if there is still no room.
  bool set(const ros2::Transform&, TimePoint arrival, bool is_static);

  struct Place {
    Pose T_root_frame{Pose::Identity()};  ///< from the frame to the root [m]
    Stamp stamp{};                        ///< of the frame itself; 0: static
    /// Of the oldest transform up to the root that is not static; max when all is.
    TimePoint arrival{};
  };
  /// Returns a frame's place of any age, identity for the root itself; nullopt when its parents do
  /// not lead to the root in fewer than 64 steps.
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
