// SPDX-License-Identifier: Apache-2.0
// Answers which grasps of an object serve: checks of the request, then the reply from the choice.
#pragma once

#include <functional>
#include <string>

#include "common/base/time.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "components/grasp_planner/arm_grasps.hpp"
#include "components/grasp_planner/choice/grasp_choice.hpp"

namespace handsel::grasp_planner {

/// Returns the object of the scene with this id; nullptr: there is none.
const SceneObject* object_in(const Scene& scene, const std::string& id);

/// Returns the place of the arm that the request asks for, the first where it names none;
/// arms.size(): the robot has no such arm.
std::size_t arm_of(const GraspRequest& request, const std::vector<ArmGrasps>& arms);

/// Returns why no grasps can be searched for the request, one sentence; empty: they can. `model`:
/// of the object, nullptr when there is none.
std::string objection(const GraspRequest& request, const Scene& scene, const RobotModel& robot,
                      const std::vector<ArmGrasps>& arms, const ObjectModel* model);

/// Writes grasps, refusals and reason of a choice to the reply. `list`: the choice was made from.
void write(const Choice& choice, const GraspList& list, GraspReply& reply);

/// Adds to each grasp of the reply the grasps of the person that find room beside it. `list`: of
/// the robot's hand; `pairs`: of this list and the hand of the person, which is
/// that of `side`.
void add_partners(const GraspList& list, const TransferTable& pairs, Side side, GraspReply& reply);

/// Returns the modelled time of the work on one core, from its counts.
Duration choice_time(const Choice& choice);

}  // namespace handsel::grasp_planner
