// SPDX-License-Identifier: Apache-2.0
// An arm of the robot with the grasps of its hand.
#pragma once

#include <memory>

#include "common/model/manipulator.hpp"
#include "components/grasp_planner/regrasp/grasp_cache.hpp"

namespace handsel::grasp_planner {

/// An arm, the geometry of its hand and the grasp lists of that hand.
struct ArmGrasps {
  Manipulator arm;                                    ///< groups of arm and hand in the robot model
  std::shared_ptr<const HandGeometry> hand_geometry;  ///< geometry of the hand of this arm
  std::shared_ptr<GraspCache> cache;  ///< grasp lists of that hand, made when first asked for
  /// Which grasps of a person go with those; nullptr: no hand of a person is known.
  std::shared_ptr<TransferCache> transfers{};
  /// The same of the left hand of a person; `transfers` is of the right one.
  std::shared_ptr<TransferCache> left_transfers{};
};

}  // namespace handsel::grasp_planner
