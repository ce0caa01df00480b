// SPDX-License-Identifier: Apache-2.0
// One grasp frame: finger by finger, thumb first, contacts that the finger can reach, push into and
// open from (chapter section 3.2.6).
#pragma once

#include <vector>

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner {

/// A contact that one finger can make.
struct FingerContact {
  SurfacePoint place;             ///< contact point on the object
  Vector q;                       ///< all hand axes; only this finger's matter
  Vector q_open;                  ///< the same finger backed off from the surface
  std::vector<Pose> T_hand_step;  ///< at q
  double force{};  ///< |cosine| of the normal and the main axis of the force ellipsoid
};

class FrameSearch {
 public:
  FrameSearch(const HandGeometry& hand_geometry, const FingerWorkspaces& workspaces,
              const Graspable& object, const GraspListSettings& settings);

  /// Points of the object a finger's workspace covers with the hand at this pose: those well inside
  /// first.
  void candidates(int finger, const Pose& T_object_hand, std::vector<std::uint32_t>& points);
  /// Checks candidates until enough clearly different contacts are found. `counters`: work done is
  /// added.
  std::vector<FingerContact> contacts(int finger, const Pose& T_object_hand,
                                      const std::vector<std::uint32_t>& points,
                                      GraspList& counters);

 private:
  /// A finger of one or two axes has no point to choose: it closes, at several places of its inner
  /// axis, until it touches.
  std::vector<FingerContact> close(int finger, const Pose& T_object_hand, GraspList& counters);
  bool touches_at(int finger, const Pose& T_object_hand, Vector q, FingerContact& out) const;
  /// Touch, palm and the path back off with the finger at out.q on the place; sets q_open, steps
  /// and force.
  bool holds(int finger, const Pose& T_object_hand, const SurfacePoint& place, GraspList& counters,
             FingerContact& out);
  bool check(int finger, const Pose& T_object_hand, std::uint32_t point, GraspList& counters,
             FingerContact& out);

  const HandGeometry& hand_geometry_;
  const FingerWorkspaces& workspaces_;
  const Graspable& object_;
  const GraspListSettings& settings_;
  std::vector<std::uint32_t> seen_;  // per point: the query that met it last
  std::uint32_t query_{};
  std::vector<std::uint32_t> hits_;
  std::vector<Pose> T_;
  mutable std::vector<Pose> T_closing_;
};

}  // namespace handsel::grasp_planner
