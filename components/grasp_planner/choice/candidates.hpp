// SPDX-License-Identifier: Apache-2.0
// Grasp candidates of the object of the last request, kept up to date for a while. Pure.
#pragma once

#include <vector>

#include "common/base/time.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"

namespace handsel::grasp_planner {

/// Decides when candidates have to be chosen again because the object was moved.
class Candidates {
 public:
  /// `lifetime`: after a request for which candidates are kept up [s]; `moved`: an object moved by
  /// more needs new ones [m].
  Candidates(double lifetime, double moved) : lifetime_(lifetime), moved_(moved) {}

  /// A choice for the object at this pose has begun.
  void on_choice(const Pose& T_world_object) { T_world_object_ = T_world_object; }
  /// A choice has ended.
  void on_grasps(const std::string& object, const std::vector<Grasp>& grasps) {
    choosing_ = false;
    message_.object = object;
    message_.grasps = grasps;
  }
  /// A request was answered: its object is the one of the candidates.
  void on_answer(const GraspRequest& request, TimePoint now) {
    request_ = request;
    answered_at_ = now;
    active_ = true;
  }
  /// Returns whether candidates are kept up now; ends that after the lifetime.
  bool active(TimePoint now) {
    if (active_ && to_seconds(now - answered_at_) > lifetime_) active_ = false;
    return active_;
  }
  /// Returns whether a new choice has to begin for the object at this pose, and counts it as begun.
  bool renew(const Pose& T_world_object) {
    const double moved = (T_world_object.translation() - T_world_object_.translation()).norm();
    if (!(moved > moved_) || choosing_) return false;
    choosing_ = true;
    return true;
  }
  /// The request that was answered last.
  const GraspRequest& request() const { return request_; }
  /// Candidates of the last choice.
  const GraspCandidates& message() const { return message_; }

 private:
  double lifetime_, moved_;
  GraspRequest request_;
  TimePoint answered_at_{};
  bool active_{}, choosing_{};
  Pose T_world_object_{Pose::Identity()};  // at the last choice
  GraspCandidates message_;
};

}  // namespace handsel::grasp_planner
