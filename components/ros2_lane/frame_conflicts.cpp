// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/frame_conflicts.hpp"

namespace handsel::ros2_lane {

bool FrameConflicts::contradicts(const ros2::Transform& transform, TimePoint arrival) {
  const auto own = parents_.find(transform.child);
  if (own == parents_.end() || own->second == transform.parent) return false;
  report_.set("TF tells frame " + transform.child + " below " + transform.parent +
                  " from outside, and robot " + robot_ + " has a link of that name below " +
                  own->second + ": the one from outside is left out, call it otherwise",
              arrival);
  return true;
}

}  // namespace handsel::ros2_lane
