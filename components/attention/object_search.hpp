// SPDX-License-Identifier: Apache-2.0
// Where to search for the lost object of an action with the gaze: its last place, hands of people,
// tops of surfaces. Own method. Pure.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "components/attention/schema.hpp"

namespace handsel::attention {

/// Returns whether the object of the running action is unseen: not in the scene, or for longer than
/// `lost_after` [s]. False without a running action, without a scene, and for what the robot holds.
bool is_object_lost(const World& world, double lost_after);

/// A sequence of gaze targets. Each place has a probability, which falls with the distance from
/// where the object was last seen and each time that the place was observed in vain.
class ObjectSearch {
 public:
  explicit ObjectSearch(const MotorSettings& motor) : motor_(motor) {}

  /// Returns the point to observe now, world [m]; nullopt: no object is lost, or there is no place
  /// to search. To be called whenever the search evaluates; `p_eye`: position of the head, world.
  std::optional<Vector3> target(const World& world, const Vector3& p_eye, TimePoint now);

 private:
  struct Place {
    std::string name;                  ///< distinguishes places
    Vector3 p_world{Vector3::Zero()};  ///< [m]
    double weight{};                   ///< prior
  };
  std::vector<Place> places(const World& world) const;
  void note_seen(const World& world);

  MotorSettings motor_;
  std::string object_;                // of the action
  std::optional<Vector3> p_last_;     // where it was last seen, world [m]
  std::map<std::string, int> tries_;  // observations in vain by name of the place
  std::string present_;               // observed now
  TimePoint since_{};                 // begin of that observation
};

}  // namespace handsel::attention
