// SPDX-License-Identifier: Apache-2.0
// Pictures of two hands on one object, of handing over, and of regrasp sequences. Frame of all: the
// world.
#pragma once

#include "components/grasp_planner/pair/transfer.hpp"
#include "components/grasp_planner/regrasp/regrasp.hpp"
#include "deploy/handsel/pictures/grasp_picture.hpp"

namespace handsel {

/// All links of the robot. `q`: all axes.
void draw_robot(Canvas& canvas, const RobotModel& robot, const Vector& q, const Pose& T_world_base,
                Colour colour, double opacity = 1);
/// Draws the body without the arm that takes, and that arm as the wrist pose of `transfer`
/// requires, with the hand on the object.
void draw_taker(Canvas& canvas, const Person& person, const grasp_planner::TransferPose& transfer,
                const grasp_planner::HandGeometry& hand, const Grasp& grasp);

/// Both hands with their contacts from three sides.
Picture double_grasp_picture(const grasp_planner::Graspable& object,
                             const grasp_planner::HandGeometry& a, const Grasp& first,
                             const grasp_planner::HandGeometry& b, const Grasp& second, int size);

/// The robot as it is drawn.
struct DrawnRobot {
  const RobotModel& robot;  ///< Its model.
  const Vector& q;          ///< All axes [rad].
};
/// The receiver of the object, with the hand that will hold it.
struct DrawnReceiver {
  const Person& person;                     ///< World frame.
  const grasp_planner::HandGeometry& hand;  ///< Shape of the hand.
  const Grasp& grasp;                       ///< Of that hand on the object.
};
/// Robot and receiver at the handover location, and both hands close by; `size` [px] high.
Picture transfer_picture(const DrawnRobot& robot, const Scene& scene, const DrawnReceiver& receiver,
                         const grasp_planner::Graspable& object,
                         const grasp_planner::TransferPose& transfer, int size);

/// One picture a step, from the left to the right: the robot with the object in the hands that hold
/// it; below, the hands close by.
Picture regrasp_picture(const RobotModel& robot, const Scene& scene,
                        const grasp_planner::Graspable& object,
                        const grasp_planner::RegraspPlan& plan, int size);

}  // namespace handsel
