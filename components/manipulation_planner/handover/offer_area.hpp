// SPDX-License-Identifier: Apache-2.0
// The area in which a person offers objects: how far the arm is from this area, and configurations
// that leave it clear. Own method. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/config/settings/manipulation_planner.hpp"
#include "components/manipulation_planner/active_arm.hpp"
#include "components/manipulation_planner/motion/retreat_planner.hpp"

namespace handsel::manipulation_planner {

class OfferArea {
 public:
  /// The references must outlive what is made.
  OfferArea(const settings::ManipulationPlannerSettings& settings, const ActiveArm& arm,
            const RetreatPlanner& retreat, const Snapshot& now)
      : settings_(settings), arm_(arm), retreat_(retreat), now_(now) {}

  /// Returns by how much hand and arm, in a configuration of all axes, are farther than they must
  /// be from where the person would comfortably offer something, and from what the person holds
  /// [m].
  double clearance(const Person& person, const Vector& q) const;
  /// Returns whether a configuration leaves the person too little space for an offer.
  bool is_occupied(const Person& person, const Vector& q) const;
  /// Returns whether the arm now leaves this person too little space; false: the person is not
  /// seen. Empty id: the nearest person.
  bool is_occupied(const std::string& person) const;
  /// Returns configurations of the arm: at rest, or moved from there by as little as clears the
  /// area before the person, else as far as possible; nearest to rest first.
  std::vector<Vector> clear_configurations(const Person& person) const;

 private:
  const settings::ManipulationPlannerSettings& settings_;
  const ActiveArm& arm_;
  const RetreatPlanner& retreat_;
  const Snapshot& now_;
};

}  // namespace handsel::manipulation_planner
