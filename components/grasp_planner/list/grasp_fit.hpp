// SPDX-License-Identifier: Apache-2.0
// Whether a list of grasps can be of a hand and an object.
#pragma once

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner {

/// Whether the grasps of a list are of this hand and object: as many joints, fingers and triangles
/// as they name, each number finite. The checksum of a stored file shows damage, not a list from
/// another source.
bool fits(const GraspList& list, const HandModel& hand, const ObjectModel& object);

}  // namespace handsel::grasp_planner
