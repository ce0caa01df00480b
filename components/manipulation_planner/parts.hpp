// SPDX-License-Identifier: Apache-2.0
// The parts of the manipulation planner, with which actions are written.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "components/manipulation_planner/active_arm.hpp"
#include "components/manipulation_planner/clients.hpp"
#include "components/manipulation_planner/hand/hand_commander.hpp"
#include "components/manipulation_planner/hand/held_object.hpp"
#include "components/manipulation_planner/handover/offer_area.hpp"
#include "components/manipulation_planner/handover/offer_detector.hpp"
#include "components/manipulation_planner/handover/target_shift.hpp"
#include "components/manipulation_planner/motion/controller_link.hpp"
#include "components/manipulation_planner/motion/motion_monitor.hpp"
#include "components/manipulation_planner/motion/online_replanner.hpp"
#include "components/manipulation_planner/motion/retreat_planner.hpp"
#include "components/manipulation_planner/placing/destinations.hpp"
#include "components/manipulation_planner/worker.hpp"

namespace handsel::manipulation_planner {

struct Parts {
  /// `client` makes request ids unique over restarts; trajectory and hand command ids start above
  /// it.
  Parts(const settings::ManipulationPlannerSettings& settings,
        std::shared_ptr<const RobotModel> robot, ObjectLibrary objects, std::uint64_t client,
        const CostSettings& cost);

  /// Lists an alternative that was rejected during the action. `reason`: one sentence.
  void refuse(const std::string& what, const std::string& reason);

  settings::ManipulationPlannerSettings settings;  ///< as shipped
  CostSettings cost;                               ///< weights of people's costs
  Snapshot now;                                    ///< newest messages
  ActionStatus action;                             ///< the action that runs or ran last
  Waiting waiting;                                 ///< what the action waits for
  Outbox outbox;                                   ///< what is to be sent
  Clients clients;                                 ///< requests to the other planners
  Worker worker;                                   ///< long computations
  ActiveArm arm;                                   ///< the arm in use
  HeldObject held;                                 ///< what its hand holds
  ReceiverHands receiver_hands;                    ///< of the person to give to, as last seen
  ControllerLink link;                             ///< commands to the controller
  HandCommander hand;                              ///< commands to its hand
  RetreatPlanner retreat;                          ///< away from people
  OfferDetector offers;                            ///< what people offer
  OfferArea area;                                  ///< where people offer
  TargetShift shift;                               ///< of the exchange point, as advised
  MotionMonitor monitor;                           ///< what ends a motion early
  OnlineReplanner replanner;                       ///< better paths for the running motion
  Destinations destinations;                       ///< where what is grasped can be put down
};

}  // namespace handsel::manipulation_planner
