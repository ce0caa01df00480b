// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/choice/hand_at_object.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/model/human/human_body.hpp"
#include "components/grasp_planner/choice/visibility.hpp"

namespace handsel::grasp_planner {

namespace {

void add_capsule(HandShape::PlacedHand& body, const HandPart& part) {
  HandShape::Placed p;
  p.capsule = true;
  p.a = part.a;
  p.b = part.b;
  p.radius = part.radius;
  const Vector3 along = p.b - p.a;
  p.middle = 0.5 * (p.a + p.b);
  p.bound = 0.5 * along.norm() + p.radius;
  p.T_frame_shape.linear() =
      Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), along).toRotationMatrix();
  p.T_frame_shape.translation() = p.middle;
  p.shape = CollisionShape::make(Capsule{p.radius, along.norm()});
  p.core = convex_core(p.shape->shape(), p.T_frame_shape);
  body.box.extend(Vector3(p.middle.array() - p.bound));
  body.box.extend(Vector3(p.middle.array() + p.bound));
  body.solids.push_back(std::move(p));
}

}  // namespace

HandShape::PlacedHand body_at_object(const Person& person, const Pose& T_world_object,
                                     const std::vector<HandPart>& digits) {
  HandShape::PlacedHand out;
  const Pose T_object_world = T_world_object.inverse();
  for (const BodyCapsule& part : body_capsules(person))
    add_capsule(out, {T_object_world * part.a, T_object_world * part.b, part.radius});
  for (const HandPart& part : digits) add_capsule(out, part);
  return out;
}

HolderBody::HolderBody(const Person& person, const Pose& T_world_object,
                       std::vector<HandPart> digits)
    : person_(person), T_world_object_(T_world_object), digits_(std::move(digits)) {
  set_digit_clearance(0);
}

void HolderBody::set_digit_clearance(double clearance) {
  std::vector<HandPart> larger = digits_;
  for (HandPart& part : larger) part.radius += clearance;
  placed_ = body_at_object(person_, T_world_object_, larger);
}

HandAtObject::HandAtObject(const HandGeometry& hand, const Graspable& object, double support_gap)
    : hand_(hand), object_(object), support_gap_(support_gap) {}

bool HandAtObject::below_support(const std::vector<SceneBox>& boxes, const Pose& T_world_object,
                                 const Grasp& g) {
  const Pose T_world_hand = T_world_object * g.T_object_hand;
  hand_.forward(g.hand_joints, T_closed_);
  hand_.forward(g.pregrasp_joints, T_open_);
  for (const auto* T : {&T_closed_, &T_open_}) {
    for (const HandShape::Low& low : hand_.shape.lows(*T, T_world_hand)) {
      for (const SceneBox& box : boxes) {
        if (!box.supports) continue;
        const Vector3 local = box.T_world_box.inverse() * low.middle;
        const double top = (box.T_world_box * Vector3(0, 0, 0.5 * box.size.z())).z();
        const bool over =
            std::abs(local.x()) < 0.5 * box.size.x() && std::abs(local.y()) < 0.5 * box.size.y();
        if (over && T_world_object.translation().z() > top - 0.02 &&
            low.height < top + support_gap_)
          return true;
      }
    }
  }
  return false;
}

bool HandAtObject::stands_in(const Grasp& g) const {
  std::vector<std::vector<Pose>> T_fingers;
  hand_.forward(g.pregrasp_joints, T_fingers);
  const std::vector<HandShape::Low> lows = hand_.shape.lows(T_fingers, g.T_object_hand);
  return std::none_of(lows.begin(), lows.end(), [&](const HandShape::Low& low) {
    return low.height < object_.box().min().z() + support_gap_;
  });
}

bool HandAtObject::touches(const HandShape::PlacedHand& body, const Grasp& g,
                           std::uint64_t& tests) {
  // Closed and open first: these collide most often.
  for (const double closure : {1.0, 0.0, 0.5, 0.25, 0.75}) {
    hand_.forward(g.pregrasp_joints + closure * (g.hand_joints - g.pregrasp_joints), T_open_);
    ++tests;
    if (HandShape::hands_touch(hand_.shape.placed(T_open_, g.T_object_hand), body, 0.0))
      return true;
  }
  return false;
}

double HandAtObject::visible(const Grasp& g, const Vector3& p_object_eye) {
  hand_.forward(g.hand_joints, T_closed_);
  return visible_fraction(object_, hand_.shape.placed(T_closed_, g.T_object_hand), p_object_eye);
}

}  // namespace handsel::grasp_planner
