// SPDX-License-Identifier: Apache-2.0
// Checks, while a motion runs, what may end it before its goal. Pure.
#pragma once

#include <optional>

#include "common/config/settings/manipulation_planner.hpp"
#include "components/manipulation_planner/hand/held_object.hpp"
#include "components/manipulation_planner/handover/offer_area.hpp"
#include "components/manipulation_planner/handover/offer_detector.hpp"
#include "components/manipulation_planner/motion/motion_spec.hpp"

namespace handsel::manipulation_planner {

class MotionMonitor {
 public:
  /// The references must outlive what is made.
  MotionMonitor(const ActiveArm& arm, const HeldObject& held, const OfferDetector& offers,
                const OfferArea& area, const Snapshot& now,
                const settings::ManipulationPlannerSettings& settings)
      : arm_(arm), held_(held), offers_(offers), area_(area), now_(now), settings_(settings) {}

  /// Observes, each step, what holds the arm back.
  void update();
  /// Begins a motion: nothing has held the arm back so far.
  void restart();
  /// Returns whether people are so near that the arm only creeps.
  bool is_person_too_near() const { return is_person_too_near_; }

  /// Returns whether the object that the motion depends on was moved too far, or is not offered any
  /// more.
  bool has_target_moved(const MotionSpec& motion) const;
  /// Returns whether the person for whom the motion clears the offer area makes an offer.
  bool is_area_cleared(const MotionSpec& motion) const;
  /// Returns how far the platform is found from where it was measured when its goals were chosen
  /// [m]; 0: the motion does not depend on that.
  double displacement(const MotionSpec& motion) const;
  /// Returns whether a motion that began at `began` must end now.
  bool must_end(const MotionSpec& motion, TimePoint began) const;
  /// Makes the failure of a motion that must_end() has ended.
  Outcome why_ended(const MotionSpec& motion, TimePoint began) const;

  /// Changes the goals of a motion that follows a moved object; `p_ahead`: where the object is
  /// expected, world [m], nullopt: where it is seen. Returns that place; nullopt: it was not moved,
  /// or the arm does not reach it.
  std::optional<Vector3> follow_object(MotionSpec& motion,
                                       const std::optional<Vector3>& p_ahead) const;

 private:
  bool is_late(const MotionSpec& motion, TimePoint began) const;

  const ActiveArm& arm_;
  const HeldObject& held_;
  const OfferDetector& offers_;
  const OfferArea& area_;
  const Snapshot& now_;
  const settings::ManipulationPlannerSettings& settings_;
  TimePoint free_at_{}, held_back_at_{};
  double blocked_for_{0};
  bool is_person_too_near_{false};
};

}  // namespace handsel::manipulation_planner
