// SPDX-License-Identifier: Apache-2.0
// From TF to what sensors say: people by their joints' frames, objects by their own. Pure.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/config/settings/ros2_lane.hpp"
#include "common/messages/perception.hpp"
#include "components/ros2_lane/tf_tree.hpp"

namespace handsel::ros2_lane {

/// "r_wrist_7f" -> {"r_wrist", "7f"}: a joint of a body as ROS4HRI names its frames. `torso` of
/// ROS4HRI is between the shoulders: it is reported as `neck` here.
struct BodyFrame {
  std::string joint, body;  ///< of a body or a knuckle; id of the body
};
/// Splits the name of a frame; nullopt when it does not begin with such a joint and "_",
/// or has no body.
std::optional<BodyFrame> body_frame(const std::string& frame);

/// Bodies are those with frames lately; where a list of tracked ids has come, those on it.
class PeopleObserver {
 public:
  explicit PeopleObserver(const settings::Ros2LaneSettings& settings) : settings_(settings) {}

  /// Notes that a joint of a body has a frame; others, and bodies beyond 256, are left out.
  void on(const ros2::Transform&);
  /// Takes the list of tracked bodies, which counts for 2 s.
  void on(const ros2::Ids&, TimePoint arrival);
  /// Returns the bodies seen lately, world frame: nullopt while nothing new came, or when presence
  /// is not known. `knuckles`: false leaves them out.
  std::optional<HumanObservation> observe(const TfTree& tree, TimePoint now, bool knuckles = true);

 private:
  settings::Ros2LaneSettings settings_;
  std::map<std::string, std::set<std::string>> bodies_;  // id -> joints that have a frame
  std::optional<std::set<std::string>> tracked_;
  TimePoint tracked_at_{};
  Stamp reported_{0};
};

class ObjectsObserver {
 public:
  explicit ObjectsObserver(const settings::Ros2LaneSettings& settings) : settings_(settings) {}
  /// Returns the objects of the settings whose frame came within people_age, in the world frame;
  /// nullopt when there are none.
  std::optional<ObjectObservation> observe(const TfTree& tree, TimePoint now) const;

 private:
  settings::Ros2LaneSettings settings_;
};

}  // namespace handsel::ros2_lane
