// SPDX-License-Identifier: Apache-2.0
// The digits of people who hold objects, as obstacles of paths. They are not observed but assumed
// from hand, palm and object. Own method.
#pragma once

#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/holding_hand_average.hpp"

namespace handsel::path_planner {

class HeldDigits {
 public:
  /// `samples`: over which hands are averaged on the objects in them, >= 1; `clearance`: by which
  /// the digits are enlarged [m].
  HeldDigits(const ObjectLibrary& objects, int samples, double clearance);

  /// Adds where hands and objects are, both in the world frame.
  void add(const Scene& scene, const HumanState& people);
  /// Returns the digits around each object in a person's hand, world frame; none of people in
  /// `allowed`, with whom a handover is engaged, and none around an object in `allowed`.
  std::vector<OtherRobot> obstacles(const Scene& scene, const HumanState& people,
                                    const std::vector<std::string>& allowed) const;

 private:
  ObjectLibrary objects_;
  HoldingHandAverage holding_;
  double clearance_;
};

}  // namespace handsel::path_planner
