// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/pictures/pair_picture.hpp"

#include "common/model/human/human_body.hpp"

namespace handsel {
namespace {

using namespace grasp_planner;

constexpr Colour kPairObject = {224, 176, 64}, kRobot = {150, 158, 170}, kFirst = {120, 140, 175},
                 kSecond = {205, 150, 125}, kSkin = {226, 178, 150}, kBody = {170, 182, 205},
                 kFurniture = {216, 206, 190};

void draw_placed(Canvas& canvas, const Graspable& object, const Pose& T_world_object) {
  canvas.shape(std::make_shared<const TriangleMesh>(object.mesh()), T_world_object, kPairObject);
}

void draw_furniture(Canvas& canvas, const Scene& scene) {
  for (const SceneBox& box : scene.boxes) canvas.shape(Box{box.size}, box.T_world_box, kFurniture);
}

Eigen::AlignedBox3d around(const Vector3& middle, double half) {
  return {Vector3(middle.array() - half), Vector3(middle.array() + half)};
}

/// Copies a picture into another at x0, y0 [px].
void paste(Picture& onto, const Picture& one, int x0, int y0) {
  for (int y = 0; y < one.height(); ++y) {
    for (int x = 0; x < one.width(); ++x) onto.dot(x0 + x, y0 + y, one.at(x, y));
  }
}

}  // namespace

void draw_robot(Canvas& canvas, const RobotModel& robot, const Vector& q, const Pose& T_world_base,
                Colour colour, double opacity) {
  std::vector<Pose> T_root_link;
  robot.forward(q, T_root_link);
  for (std::size_t l = 0; l < T_root_link.size(); ++l) {
    for (const PlacedShape& s : robot.links()[l].collision)
      canvas.shape(s.shape, T_world_base * T_root_link[l] * s.T_parent_shape, colour, opacity);
  }
}

void draw_taker(Canvas& canvas, const Person& person, const TransferPose& transfer,
                const HandGeometry& hand, const Grasp& grasp) {
  for (const BodyCapsule& c : body_capsules(person)) {
    if (c.part == BodyPart::upper_arm_right || c.part == BodyPart::forearm_right ||
        c.part == BodyPart::hand_right)
      continue;
    canvas.stick(c.a, c.b, c.radius, c.part == BodyPart::head ? kSkin : kBody);
    for (const Vector3& end : {c.a, c.b})
      canvas.ball(end, c.radius, c.part == BodyPart::head ? kSkin : kBody);
  }
  const Vector3 shoulder =
      person.joints[static_cast<std::size_t>(body_joint_index("r_shoulder"))].position;
  const Pose T_world_wrist = transfer.T_world_object * grasp.T_object_hand;
  canvas.stick(shoulder, transfer.wrist.elbow, 0.045, kBody);
  canvas.ball(transfer.wrist.elbow, 0.045, kBody);
  canvas.stick(transfer.wrist.elbow, T_world_wrist.translation(), 0.032, kSkin);
  draw_hand(canvas, hand, grasp.hand_joints, T_world_wrist, kSkin);
}

Picture double_grasp_picture(const Graspable& object, const HandGeometry& a, const Grasp& first,
                             const HandGeometry& b, const Grasp& second, int size) {
  const Eigen::AlignedBox3d box = around(object.box().center(), 0.22);
  return from_sides(box, {Vector3(1, -1.6, 0.9), Vector3(1.6, 1, 0.5), Vector3(-0.3, -0.2, 2)},
                    size, [&](Canvas& canvas, std::size_t) {
                      draw_object(canvas, object);
                      draw_hand(canvas, a, first.hand_joints, first.T_object_hand, kFirst);
                      draw_hand(canvas, b, second.hand_joints, second.T_object_hand, kSecond);
                      draw_contacts(canvas, first);
                      draw_contacts(canvas, second);
                    });
}

Picture transfer_picture(const DrawnRobot& robot, const Scene& scene, const DrawnReceiver& receiver,
                         const Graspable& object, const TransferPose& transfer, int size) {
  const Vector3 middle = transfer.T_world_object * object.box().center();
  const Vector3 chest =
      receiver.person.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  const Vector3 toward_robot = (scene.T_world_base.translation() - chest)
                                   .cwiseProduct(Vector3(1, 1, 0))
                                   .normalized(),
                aside = toward_robot.cross(Vector3::UnitZ());
  const auto draw = [&](Canvas& canvas, std::size_t) {
    draw_furniture(canvas, scene);
    draw_robot(canvas, robot.robot, robot.q, scene.T_world_base, kRobot);
    draw_taker(canvas, receiver.person, transfer, receiver.hand, receiver.grasp);
    draw_placed(canvas, object, transfer.T_world_object);
  };
  Picture out(3 * size, size, {255, 255, 255});
  Eigen::AlignedBox3d whole =
      around(0.5 * (scene.T_world_base.translation() + chest).cwiseProduct(Vector3(1, 1, 0)) +
                 Vector3(0, 0, 0.9),
             1.0);
  paste(out, from_sides(whole, {Vector3(aside + 0.35 * Vector3::UnitZ())}, size, draw), 0, 0);
  paste(out,
        from_sides(around(middle, 0.3),
                   {Vector3(aside + 0.4 * Vector3::UnitZ()),
                    Vector3(-0.5 * aside + 1.2 * Vector3::UnitZ())},
                   size, draw),
        size, 0);
  return out;
}

Picture regrasp_picture(const RobotModel& robot, const Scene& scene, const Graspable& object,
                        const RegraspPlan& plan, int size) {
  const int count = static_cast<int>(plan.steps.size());
  Picture out(std::max(1, count) * size, 2 * size, {255, 255, 255});
  for (int n = 0; n < count; ++n) {
    const grasp_planner::RegraspStep& step = plan.steps[static_cast<std::size_t>(n)];
    const auto draw = [&](Canvas& canvas, std::size_t) {
      draw_furniture(canvas, scene);
      draw_robot(canvas, robot, step.q, scene.T_world_base, kRobot);
      draw_placed(canvas, object, step.T_world_object);
    };
    const Vector3 forward = scene.T_world_base.linear().col(0);
    const Eigen::AlignedBox3d whole =
        around(scene.T_world_base.translation() + 0.3 * forward + Vector3(0, 0, 0.95), 0.95);
    const Eigen::AlignedBox3d near = around(step.T_world_object * object.box().center(), 0.28);
    const Vector3 from = 1.6 * forward + Vector3(0, 0, 0.8);
    paste(out, from_sides(whole, {from}, size, draw), n * size, 0);
    paste(out, from_sides(near, {from}, size, draw), n * size, size);
  }
  return out;
}

}  // namespace handsel
