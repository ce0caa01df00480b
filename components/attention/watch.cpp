// SPDX-License-Identifier: Apache-2.0
#include "components/attention/watch.hpp"

#include "common/model/human/body_index.hpp"
#include "components/attention/looks.hpp"

namespace handsel::attention {

double Watch::perceive(const World& world, TimePoint now) {
  gaze_.reset();
  input_ = sample(world, now);
  known_ = std::isfinite(input_);
  return known_ ? std::max(0.0, input_) : kInfinity;
}

double Watch::speed_factor() const {
  if (!known_ || !(settings_.slow_from > 0)) return 1.0;
  return settings_.slow_factor +
         (1.0 - settings_.slow_factor) * ramp(input_, settings_.slow_at, settings_.slow_from);
}

double Watch::sample(const World& w, TimePoint now) {
  if (!robot_known(w, body_)) return kInfinity;
  const ActiveTrajectory& active = *w.active;
  const Vector3 p_grasp = body_.grasp_point(active.position, active.T_world_base);
  const Person* person = person_of_interest(w, p_grasp, motor_.lost_after);
  const NearHand hand = person ? nearest_hand(*person, p_grasp) : NearHand{};
  if (person && settings_.gaze == GazeAt::head) gaze_ = person->joints[body::head].position;
  if (person && settings_.gaze == GazeAt::hand) gaze_ = hand.position;
  double to_object = kInfinity;
  if (w.scene && w.action) {
    for (const SceneObject& object : w.scene->objects) {
      if (object.id != w.action->object) continue;
      to_object = (object.T_world_object.translation() - p_grasp).norm();
      if (settings_.gaze == GazeAt::object) gaze_ = object.T_world_object.translation();
    }
  }
  const bool foreseen =
      w.forecast && w.forecast->trajectory != 0 && w.forecast->trajectory == active.trajectory;
  if (person || !seen_) seen_ = now;
  switch (settings_.input) {
    case Input::human_distance:
      return !w.people || w.people->people.empty()
                 ? kInfinity
                 : body_
                       .separation_at(active.position, active.T_world_base, *w.people,
                                      handover_exemption(w))
                       .distance;
    case Input::hand_distance:
      return hand.distance;
    case Input::object_distance:
      return to_object;
    case Input::clearance:
      return foreseen ? w.forecast->clearance : kInfinity;
    case Input::forecast_contact:
      return foreseen && w.forecast->collides ? w.forecast->time_to_collision : kInfinity;
    case Input::unseen_time:
      return to_seconds(now - *seen_);
  }
  return kInfinity;
}

}  // namespace handsel::attention
