#include "components/grasp_planner/choice/hand_at_object.hpp"

#include <algorithm>
#include <cmath>

#include "components/grasp_planner/choice/visibility.hpp"

namespace handsel::grasp_planner {

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

double HandAtObject::visible(const Grasp& g, const Vector3& p_object_eye) {
  hand_.forward(g.hand_joints, T_closed_);
  return visible_fraction(object_, hand_.shape.placed(T_closed_, g.T_object_hand), p_object_eye);
}

}  // namespace handsel::grasp_planner
