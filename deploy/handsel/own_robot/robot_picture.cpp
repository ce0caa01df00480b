// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/robot_picture.hpp"

#include "common/model/robot_capsules.hpp"
#include "deploy/handsel/own_robot/robot_parts.hpp"
#include "deploy/handsel/pictures/canvas.hpp"

namespace handsel {

Picture robot_picture(const RobotModel& robot, const Vector& q, const Vector3& tool_direction,
                      int size) {
  constexpr Colour kShape = {200, 200, 205}, kArm = {90, 130, 190}, kHand = {220, 150, 60},
                   kOther = {130, 140, 130}, kTool = {210, 40, 40};
  constexpr double kShapeOpacity = 0.35, kStick = 0.1, kStickRadius = 0.006;
  std::vector<Pose> T;
  robot.forward(q, T);
  const auto capsules = robot_capsules(robot);
  Eigen::AlignedBox3d box(Vector3(-0.1, -0.1, 0), Vector3(0.1, 0.1, 0.1));
  for (const LinkCapsule& c : capsules)
    for (const Vector3& end : {c.a, c.b}) {
      const Vector3 p = T[static_cast<std::size_t>(c.link)] * end;
      box.extend(Vector3(p.array() - c.radius));
      box.extend(Vector3(p.array() + c.radius));
    }
  const auto tool = static_cast<std::size_t>(robot.tool_link());
  const auto hand = descends_from(robot, robot.tool_link());
  const Group& arm = robot.require_group("arm");
  const auto first = robot
                         .joints()[static_cast<std::size_t>(
                             robot.axes()[static_cast<std::size_t>(arm.axes.front())].joint)]
                         .child;
  const auto moved = descends_from(robot, first);
  return from_sides(box, {Vector3(0, -1, 0.15), Vector3(1, 0, 0.15)}, size,
                    [&](Canvas& canvas, std::size_t) {
                      for (const LinkCapsule& c : capsules) {
                        const auto link = static_cast<std::size_t>(c.link);
                        const Colour colour = hand[link] ? kHand : moved[link] ? kArm : kOther;
                        const Vector3 a = T[link] * c.a, b = T[link] * c.b;
                        canvas.stick(a, b, c.radius, colour);
                        for (const Vector3& end : {a, b}) canvas.ball(end, c.radius, colour, 0.6);
                      }
                      for (std::size_t l = 0; l < T.size(); ++l)
                        for (const PlacedShape& s : robot.links()[l].collision)
                          canvas.shape(s.shape, T[l] * s.T_parent_shape, kShape, kShapeOpacity);
                      canvas.stick(T[tool].translation(), T[tool] * (kStick * tool_direction),
                                   kStickRadius, kTool);
                    });
}

}  // namespace handsel
