// SPDX-License-Identifier: Apache-2.0
// Converts between planned axes and all axes of the robot.
#pragma once

#include "components/path_planner/problem.hpp"

namespace handsel::path_planner {

/// Converts configurations between the planned axes and all axes; all others have the start's
/// values.
class PlannedAxes {
 public:
  /// `problem` must outlive this.
  explicit PlannedAxes(const Problem& problem) : axes_(problem.axes), all_(problem.start) {}

  /// Returns the number of planned axes.
  int size() const { return static_cast<int>(axes_.size()); }
  /// Returns the planned axes of a configuration of all axes.
  Vector part(const Vector& all) const {
    Vector q(size());
    for (int i = 0; i < size(); ++i) q[i] = all[axes_[i]];
    return q;
  }
  /// Returns all axes with the planned axes at `q`; valid until the next call.
  const Vector& whole(const Vector& q) const {
    for (int i = 0; i < size(); ++i) all_[axes_[i]] = q[i];
    return all_;
  }

 private:
  const std::vector<int>& axes_;
  mutable Vector all_;
};

}  // namespace handsel::path_planner
