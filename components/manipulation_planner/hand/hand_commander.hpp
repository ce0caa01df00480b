// SPDX-License-Identifier: Apache-2.0
// Commands to the hand in use, and how they end.
#pragma once

#include <functional>

#include "components/manipulation_planner/motion/controller_link.hpp"

namespace handsel::manipulation_planner {

/// How a motion of the hand ended.
struct HandResult {
  Outcome outcome;    ///< whether the command was executed
  HandState state{};  ///< of the hand at the end; only of a good outcome
};

class HandCommander {
 public:
  /// `action`: its object is what the hand grasps. The references must outlive what is made.
  HandCommander(ActiveArm& arm, ControllerLink& link, const Snapshot& now, Waiting& waiting,
                const ActionStatus& action, const settings::ManipulationPlannerSettings& settings)
      : arm_(arm),
        link_(link),
        now_(now),
        waiting_(waiting),
        action_(action),
        settings_(settings) {}

  /// Sends a command until the controller has acknowledged it. `position`: axes of the hand
  /// [rad, m]; `effort`: of them, null: none; `mass_ratio`: part of the object's mass that this
  /// hand bears, below 1 together with the other hands. The references must outlive the routine.
  Routine<Outcome> send(HandAction action, const Vector& position, const Vector* effort = nullptr,
                        double mass_ratio = 1.0);
  /// Sends a command as send() does and waits for its end, `timeout` [s] at most; sends it again
  /// after a stop that interrupted the hand.
  Routine<HandResult> run(HandAction action, const Vector& position, double timeout,
                          const Vector* effort = nullptr, double mass_ratio = 1.0);
  /// Waits for a pull that opens the hand, `timeout` [s] at most, until `is_over` or until a stop
  /// interrupts the hand while it opens: the state is `refused` then. `mass_ratio`: as of send().
  Routine<HandResult> release_on_pull(const Vector& position, double timeout,
                                      const std::function<bool()>& is_over,
                                      double mass_ratio = 1.0);
  /// Waits until the fingers have ended a motion that was sent.
  Routine<Outcome> await_open();

 private:
  ActiveArm& arm_;
  ControllerLink& link_;
  const Snapshot& now_;
  Waiting& waiting_;
  const ActionStatus& action_;
  const settings::ManipulationPlannerSettings& settings_;
};

}  // namespace handsel::manipulation_planner
