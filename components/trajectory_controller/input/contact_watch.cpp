// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/input/contact_watch.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::trajectory_controller {

ContactWatch::ContactWatch(const ContactSettings& settings, std::vector<int> axes)
    : settings_(settings),
      axes_(std::move(axes)),
      usual_(axes_.size(), 0.0),
      before_(usual_),
      pushes_(usual_) {}

void ContactWatch::forget() noexcept {
  std::fill(pushes_.begin(), pushes_.end(), 0.0);
  pushed_for_ = pressed_for_ = 0.0;
  seen_ = false;
  contact_ = Contact::none;
}

Contact ContactWatch::update(const Eigen::VectorXd& external_torque, double dt, bool resting,
                             bool in_handover) noexcept {
  const double weight = dt / (settings_.usual_time + dt);
  double max_excess = 0.0;
  bool pushed = false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (axes_[i] >= external_torque.size() || !std::isfinite(external_torque[axes_[i]])) {
      forget();
      return contact_;
    }
    const double now = external_torque[axes_[i]];
    if (!seen_) usual_[i] = before_[i] = std::clamp(now, -settings_.max_usual, settings_.max_usual);
    // A slowly growing press has also changed the torque before it.
    if (contact_ == Contact::clamped) before_[i] = usual_[i];
    const double push = now - before_[i], beyond = std::abs(now - usual_[i]);
    const bool beyond_yield = std::abs(push) > settings_.yield_torque;
    pushes_[i] = resting && beyond_yield ? push : 0.0;
    pushed = pushed || beyond_yield;
    if (beyond > max_excess) {
      max_excess = beyond;
      axis_ = axes_[i];
    }
    if (beyond <= settings_.follow_torque)
      usual_[i] = std::clamp(usual_[i] + (now - usual_[i]) * weight, -settings_.max_usual,
                             settings_.max_usual);
  }
  seen_ = true;
  torque_ = max_excess;
  pressed_for_ = max_excess > (in_handover ? settings_.handover_torque : settings_.torque)
                     ? pressed_for_ + dt
                     : 0.0;
  contact_ = pressed_for_ > settings_.clamp_time ? Contact::clamped
             : pressed_for_ > settings_.time     ? Contact::contact
                                                 : Contact::none;
  pushed_for_ = pushed ? pushed_for_ + dt : 0.0;
  const bool load = pushed_for_ > settings_.yield_time && max_excess <= settings_.torque;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double now = external_torque[axes_[i]];
    if (load) before_[i] = now, pushes_[i] = 0.0;
    if (!pushed) before_[i] += (now - before_[i]) * weight;
  }
  return contact_;
}

}  // namespace handsel::trajectory_controller
