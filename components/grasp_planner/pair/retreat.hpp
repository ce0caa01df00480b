// How an opened hand backs off from an object, or comes to it along the same path in reverse. Own
// method.
#pragma once

#include <cstdint>
#include <vector>

#include "components/grasp_planner/hand/hand_kit.hpp"
#include "components/grasp_planner/object/graspable.hpp"

namespace handsel::grasp_planner {

inline constexpr double kSweepStep = 0.008;  ///< distance of two tests along a straight path [m]

/// Unit vectors in the hand frame: straight away from where contacts happen, then a cone of
/// directions around it.
std::vector<Vector3> retreat_ways(const HandModel& hand);

/// Whether the opened hand (`T_hand_step`) can go `length` [m] along `way` (hand frame, unit) and
/// stay `clearance` [m] off the object. The place it starts from is not checked. `tests`: those
/// made are added.
bool retreat_free(const HandKit& kit, const std::vector<std::vector<Pose>>& T_hand_step, const Graspable& object, const Pose& T_object_hand,
                  const Vector3& way, double length, double clearance, std::uint64_t* tests = nullptr);

}  // namespace handsel::grasp_planner
