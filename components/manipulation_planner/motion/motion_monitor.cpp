// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/motion/motion_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::manipulation_planner {
namespace {

constexpr std::uint32_t kBlocked = bit(Cause::forecast_collision);
constexpr std::uint32_t kTooNear = bit(Cause::separation) | bit(Cause::attention_slow);

}  // namespace

void MotionMonitor::update() {
  const auto& status = now_.execution();
  const ActiveTrajectory& active = now_.active();
  is_person_too_near_ = status && (status->causes & kTooNear) != 0 && active.trajectory != 0 &&
                        std::abs(active.speed_factor) < settings_.creeping_factor;
  // An arm at rest has no collision ahead: it starts, and is held back again.
  if (status && (status->causes & kBlocked) != 0) held_back_at_ = now_.time();
  const bool is_held_back = to_seconds(now_.time() - held_back_at_) <= settings_.blocked_pause;
  if (!is_person_too_near_ && !is_held_back) free_at_ = now_.time();
  blocked_for_ = to_seconds(now_.time() - free_at_);
}

void MotionMonitor::restart() {
  free_at_ = now_.time();
  held_back_at_ = {};
}

bool MotionMonitor::has_target_moved(const MotionSpec& motion) const {
  if (!motion.object) return false;
  const ObjectTarget& target = *motion.object;
  const auto p_tool = [this] { return arm_.T_world_tool().translation(); };
  if (target.grasp && offers_.is_giver_approaching(p_tool())) return true;
  const SceneObject* object = now_.object(target.object);
  if (object == nullptr) return true;
  const Vector3 p_object = object->T_world_object.translation();
  const double shifted = (p_object - target.p_world).norm();
  if (!target.grasp) return shifted > target.max_shift;
  const double ahead = (p_object - p_tool()).norm() - settings_.hand_length;
  const double max_shift =
      std::min(std::max(settings_.approach_slack_ratio * ahead, settings_.min_approach_slack),
               target.max_shift);
  return shifted > max_shift || !offers_.is_still_offered();
}

bool MotionMonitor::is_area_cleared(const MotionSpec& motion) const {
  const std::string& person = motion.clears_area_for;
  if (person.empty()) return false;
  const Vector3 p_hand = arm_.T_world_tool().translation();
  return offers_.find(offers_.asked_object(), person, p_hand) &&
         (motion.accepts_any_offer || !area_.is_occupied(person));
}

bool MotionMonitor::is_late(const MotionSpec& motion, TimePoint began) const {
  return to_seconds(now_.time() - began) > motion.timeout;
}

double MotionMonitor::displacement(const MotionSpec& motion) const {
  if (!motion.T_world_root) return 0.0;
  const Vector3 p_root = now_.T_world_base().inverse() * T_world_platform(now_).translation();
  return (now_.T_world_base() * p_root - *motion.T_world_root * p_root).norm();
}

bool MotionMonitor::must_end(const MotionSpec& motion, TimePoint began) const {
  return is_late(motion, began) || blocked_for_ > settings_.blocked_timeout ||
         has_target_moved(motion) || held_.is_taken_by(motion.yields_to) ||
         is_area_cleared(motion) || displacement(motion) > settings_.max_displacement;
}

Outcome MotionMonitor::why_ended(const MotionSpec& motion, TimePoint began) const {
  Outcome why;
  if (held_.is_taken_by(motion.yields_to)) {
    why = Outcome::failure(motion.yields_to + " takes hold of " + held_.id());
    why.end = MotionEnd::taken;
  } else if (has_target_moved(motion)) {
    const bool is_approached =
        motion.object->grasp && offers_.is_giver_approaching(arm_.T_world_tool().translation());
    why = Outcome::failure(motion.object->object + " was moved away");
    why.end = is_approached ? MotionEnd::giver_approached : MotionEnd::target_moved;
  } else if (displacement(motion) > settings_.max_displacement) {
    constexpr double kCentimetres = 100;
    why = Outcome::failure("the wheels slipped or the localisation jumped: the platform is " +
                           std::to_string(std::lround(kCentimetres * displacement(motion))) +
                           " cm from where its wheels have measured it");
    why.end = MotionEnd::displaced;
  } else {
    why = Outcome::failure("the path is blocked: " + now_.execution()->reason);
    if (is_late(motion, began))
      why.end = MotionEnd::late;
    else if (is_person_too_near_)
      why.end = MotionEnd::person_too_near;
  }
  return why;
}

std::optional<Vector3> MotionMonitor::follow_object(MotionSpec& motion,
                                                    const std::optional<Vector3>& p_ahead) const {
  const SceneObject* object = now_.object(motion.object->object);
  if (object == nullptr) return std::nullopt;
  Pose T_world_object = object->T_world_object;
  if (p_ahead) T_world_object.translation() = *p_ahead;
  const Vector3 p_object = T_world_object.translation();
  if ((p_object - motion.object->p_world).norm() < settings_.min_followed) return std::nullopt;
  const std::optional<Grasp> grasp = arm_.grasp_at(T_world_object, *motion.object->grasp);
  if (!grasp) return std::nullopt;
  motion.goals = {grasp->approach_joints};
  return p_object;
}

}  // namespace handsel::manipulation_planner
