// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/stop_space.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/stop.hpp"

namespace handsel::trajectory_controller {

StopSpace::StopSpace(const ViewSettings& settings, const StopProof& proof, const RobotModel& robot)
    : settings_(settings),
      proof_(proof),
      limits_(robot.stop_limits()),
      space_(settings.max_view_age),
      chain_(proof.chain()),
      all_frames_(chain_.frames().size(), 1),
      motions_(chain_.frames().size()),
      boxes_(chain_.capsules().size()),
      travel_(chain_.capsules().size()),
      by_axis_(static_cast<std::size_t>(robot.dof())),
      rest_(Vector::Zero(robot.dof())),
      position_(rest_),
      stop_(rest_) {}

/// Returns whether every capsule, enlarged by `margin` [m] and its max travel, is observed.
bool StopSpace::inside(const Vector& position, double margin, const Pose& T_world_base,
                       double since) noexcept {
  chain_.enclose_hands(position);
  chain_.move(position, rest_, all_frames_, motions_);
  Box whole{Vector3::Constant(1e9), Vector3::Constant(-1e9)};
  for (std::size_t c = 0; c < boxes_.size(); ++c) {
    const ChainCapsule& capsule = chain_.capsules()[c];
    const FrameMotion& frame = motions_[static_cast<std::size_t>(capsule.frame)];
    const Vector3 a = T_world_base * (frame.p + frame.R * capsule.a),
                  b = T_world_base * (frame.p + frame.R * capsule.b);
    const Vector3 grown = Vector3::Constant(capsule.radius + margin + travel_[c]);
    Box& box = boxes_[c];
    box = {a.cwiseMin(b) - grown, a.cwiseMax(b) + grown};
    for (double* z : {&box.low.z(), &box.high.z()})
      *z = std::clamp(*z, settings_.floor, settings_.ceiling);
    whole = {whole.low.cwiseMin(box.low), whole.high.cwiseMax(box.high)};
  }
  if (space_.one_contains(whole, since)) return true;
  for (std::size_t c = 0; c < boxes_.size(); ++c) {
    if (space_.contains(boxes_[c], since)) continue;
    link_ = chain_.capsules()[c].link;
    return false;
  }
  return true;
}

bool StopSpace::observes_stops(const Vector& position, const Pose& T_world_base,
                               double since) noexcept {
  if (!settings_.require_view) return true;
  for (std::size_t c = 0; c < travel_.size(); ++c) travel_[c] = proof_.max_travel(c);
  if (inside(position, settings_.margin, T_world_base, since)) return true;
  position_ = position;
  return proof_.moving() && space_.any(since) && inside_during(false, T_world_base, since) &&
         inside_during(true, T_world_base, since);
}

/// Returns whether the whole stop is observed. A capsule stays within its max travel of half an
/// interval from its position at one of the sampled instants.
bool StopSpace::inside_during(bool robot_side, const Pose& T_world_base, double since) noexcept {
  const double interval = proof_.stop(robot_side).duration() / kIntervals;
  for (std::size_t c = 0; c < travel_.size(); ++c)
    travel_[c] = proof_.max_speed(c) * interval / 2.0;
  for (int k = 0; k <= kIntervals; ++k) {
    proof_.stop(robot_side).position_at(k * interval, position_);
    if (!inside(position_, settings_.margin, T_world_base, since)) return false;
  }
  return true;
}

double StopSpace::factor(const Vector& position, const Vector& velocity, const Pose& T_world_base,
                         double since) noexcept {
  if (!settings_.require_view) return 1.0;
  for (const double factor : {1.0, settings_.boundary_factor}) {
    for (Eigen::Index i = 0; i < velocity.size(); ++i) {
      const double v = factor * velocity[i];
      const double braking_distance =
          v == 0.0 ? 0.0 : measure_stop(v, 0.0, limits_.acceleration[i], limits_.jerk[i]).distance;
      stop_[i] = braking_distance + v * proof_.settings().robot_side_delay;
    }
    if (inside_from(position, T_world_base, since)) return factor;
  }
  return 0.0;
}

/// Returns whether the links are observed from a position to the end of the stop, stop_ away.
bool StopSpace::inside_from(const Vector& position, const Pose& T_world_base,
                            double since) noexcept {
  const double margin = settings_.margin + settings_.ahead_margin;
  for (std::size_t i = 0; i < by_axis_.size(); ++i)
    by_axis_[i] = std::abs(stop_[static_cast<Eigen::Index>(i)]);
  for (std::size_t c = 0; c < travel_.size(); ++c)
    travel_[c] = chain_.capsules()[c].bound(by_axis_);
  if (inside(position, margin, T_world_base, since)) return true;
  for (double& travel : travel_) travel /= 2.0 * kIntervals;
  for (int k = 0; k <= kIntervals; ++k) {
    position_ = position + (static_cast<double>(k) / kIntervals) * stop_;
    if (!inside(position_, margin, T_world_base, since)) return false;
  }
  return true;
}

std::string why_blind(const HumanState& people, const std::string& link) {
  if (people.views.empty()) return "no source of people has been seen";
  std::string out;
  bool live = false;
  for (const SourceView& view : people.views) {
    live = live || view.live;
    out += (out.empty() ? "source " : ", source ") + view.source + " " +
           (view.live ? "does not look there" : view.reason);
  }
  return live ? "no live source observes where " + (link.empty() ? "the arm" : link) +
                    " can be: " + out
              : out;
}

}  // namespace handsel::trajectory_controller
