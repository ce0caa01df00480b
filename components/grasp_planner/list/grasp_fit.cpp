// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/list/grasp_fit.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::grasp_planner {

bool fits(const GraspList& list, const HandModel& hand, const ObjectModel& object) {
  const Eigen::Index axes = hand.model().dof();
  const auto contact_fits = [&](const Contact& c) {
    return c.finger < hand.fingers().size() && c.triangle < object.mesh.triangles.size() &&
           c.position.allFinite() && c.normal.allFinite() && c.barycentric.allFinite() &&
           std::isfinite(c.friction) && std::isfinite(c.curvature);
  };
  return std::all_of(list.grasps.begin(), list.grasps.end(), [&](const ListedGrasp& listed) {
    const Grasp& g = listed.grasp;
    const auto& s = listed.scores;
    for (const Vector* joints : {&g.hand_joints, &g.pregrasp_joints, &g.hand_effort})
      if (joints->size() != axes || !joints->allFinite()) return false;
    for (const double value :
         {g.epsilon, g.quality, g.margin, s.stability, s.centre, s.force, s.curvature, listed.room})
      if (!std::isfinite(value)) return false;
    return g.T_object_hand.matrix().allFinite() &&
           std::all_of(g.contacts.begin(), g.contacts.end(), contact_fits);
  });
}

}  // namespace handsel::grasp_planner
