#include "components/trajectory_controller/contact_watch.hpp"

#include <cmath>

namespace handsel::trajectory_controller {

ContactWatch::ContactWatch(const ContactSettings& settings, std::vector<int> axes)
    : settings_(settings), axes_(std::move(axes)), usual_(axes_.size(), 0.0), before_(usual_), pushes_(usual_) {}

bool ContactWatch::update(const Eigen::VectorXd& external_torque, double dt, bool resting) noexcept {
  double most = 0.0;
  bool pushed = false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (axes_[i] >= external_torque.size() || !std::isfinite(external_torque[axes_[i]])) {
      std::fill(pushes_.begin(), pushes_.end(), 0.0);
      pushed_for_ = pressed_for_ = 0.0;
      seen_ = false;
      return false;
    }
    const double now = external_torque[axes_[i]];
    if (!seen_) usual_[i] = before_[i] = now;
    const double push = now - before_[i];
    const bool beyond_yield = std::abs(push) > settings_.yield_torque;
    pushes_[i] = resting && beyond_yield ? push : 0.0;
    pushed = pushed || beyond_yield;
    const double beyond = std::abs(now - usual_[i]);
    if (beyond > most) {
      most = beyond;
      axis_ = axes_[i];
    }
    usual_[i] += (now - usual_[i]) * (dt / (settings_.usual_time + dt));
  }
  pushed_for_ = pushed ? pushed_for_ + dt : 0.0;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (pushed_for_ > settings_.yield_time) before_[i] = usual_[i], pushes_[i] = 0.0;
    if (!pushed) before_[i] += (external_torque[axes_[i]] - before_[i]) * (dt / (settings_.usual_time + dt));
  }
  seen_ = true;
  torque_ = most;
  pressed_for_ = most > settings_.torque ? pressed_for_ + dt : 0.0;
  return pressed_for_ > settings_.time;
}

}  // namespace handsel::trajectory_controller
