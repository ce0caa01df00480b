// SPDX-License-Identifier: Apache-2.0
// The hands by which a person may take what is offered, and the one that is
// ready for it.
#pragma once

#include <optional>

#include "common/config/settings/manipulation_planner.hpp"
#include "common/messages/world.hpp"

namespace handsel::manipulation_planner {

/// What is known of the hands of a receiver.
struct ReceiverHands {
  bool left_free{true}, right_free{true};  ///< false: the hand holds something
  std::optional<Side> ready;               ///< hand extended to take something; nullopt: neither
  bool operator==(const ReceiverHands&) const = default;

  /// Returns whether the hand of that side is free to take something.
  bool is_free(Side side) const { return side == Side::left ? left_free : right_free; }
};

/// Returns the hands of a person who faces a robot at `p_world_robot`. A hand near what the person
/// holds is not free (`busy_range`). A free hand is ready when it is extended toward the robot,
/// farther than the other (`ready_extension`, `ready_lead`). `before`: what was found last; the
/// hand ready then counts until it is not free or the other is ready. Null: nothing was found.
ReceiverHands hands_of(const Person& person, const Scene& scene, const Vector3& p_world_robot,
                       const settings::ManipulationPlannerSettings& settings,
                       const ReceiverHands* before = nullptr);

/// Returns what is added to the strain of a grasp by the hand of that side; nullopt: that hand is
/// not free. `settings`: `other_hand` and `left_hand`; where the person has a profile, the hand
/// named there takes the place of the right one.
std::optional<double> hand_cost(const ReceiverHands& hands, Side side, const std::string& person,
                                const settings::ManipulationPlannerSettings& settings);

}  // namespace handsel::manipulation_planner
