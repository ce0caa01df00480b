#include "components/trajectory_controller/path_runner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/trajectory/stop.hpp"
#include "components/trajectory_controller/setpoint_check.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kShareOfJerk = 0.995, kShareOfAcceleration = 0.999;  // room for the linearisation below
constexpr double kLargestRate = 10.0, kLargestSecond = 200.0;         // of alpha' and alpha'' where the path hardly moves

}  // namespace

void PathRunner::start(const Trajectory& trajectory, const KinematicLimits& limits) {
  trajectory_ = trajectory;
  limits_ = limits;
  duration_ = trajectory.duration();
  time_ = factor_ = rate_ = 0.0;
  finished_ = duration_ <= 0.0;
  state_ = next_ = path_ = trajectory.at(0.0);
}

void PathRunner::sample(double time, double factor, double rate) noexcept {
  trajectory_.sample(time, path_);
  next_.position = path_.position;
  next_.velocity = factor * path_.velocity;
  next_.acceleration = factor * factor * path_.acceleration + rate * path_.velocity;
}

bool PathRunner::step(double wanted) noexcept {
  if (finished_) return true;
  wanted = std::clamp(wanted, -1.0, 1.0);
  if (time_ <= 0.0) {
    // At rest at the beginning any factor will do: the path has no velocity and no acceleration there.
    factor_ = wanted = std::max(wanted, 0.0);
    rate_ = 0.0;
  }
  const double dt = dt_;
  const double time_predicted = time_ + dt * (factor_ + 0.5 * dt * rate_), factor_predicted = factor_ + dt * rate_;
  trajectory_.sample(time_predicted, path_);

  double low = -std::numeric_limits<double>::infinity(), high = -low;
  double largest_second = kLargestSecond, largest_rate = kLargestRate;
  for (Eigen::Index i = 0; i < path_.position.size(); ++i) {
    const double V = limits_.velocity[i], A = kShareOfAcceleration * limits_.acceleration[i], J = kShareOfJerk * limits_.jerk[i];
    const double gain = dt * path_.velocity[i];
    if (std::abs(gain) < 1e-12) continue;
    largest_second = std::min(largest_second, J / std::abs(path_.velocity[i]));
    largest_rate = std::min(largest_rate, A / std::abs(path_.velocity[i]));
    const double base = factor_predicted * factor_predicted * path_.acceleration[i] + rate_ * path_.velocity[i];
    const double v = factor_predicted * path_.velocity[i];
    const double room = std::sqrt(2.0 * J * std::max(0.0, V - std::abs(v))) - J * dt;
    double least = std::max(-A, state_.acceleration[i] - J * dt), most = std::min(A, state_.acceleration[i] + J * dt);
    if (v > 0.0) most = std::min(most, room);
    if (v < 0.0) least = std::max(least, -room);
    const double first = (least - base) / gain, second = (most - base) / gain;
    low = std::max(low, std::min(first, second));
    high = std::min(high, std::max(first, second));
  }

  AxisProfile law;
  critical_movement(factor_, rate_, wanted, 0.0, largest_rate, largest_second, law);
  AxisState alpha{0.0, factor_, rate_};  // position: path time gone by
  double left = dt;
  for (int k = 0; k < law.count && left > 0.0; ++k) {
    const Segment& s = law.segments[static_cast<std::size_t>(k)];
    const double t = std::min(left, s.duration);
    alpha = advanced(alpha, t, s.jerk);
    left -= t;
  }
  if (left > 0.0) alpha = {alpha.position + left * wanted, wanted, 0.0};
  const double second = (alpha.acceleration - rate_) / dt;
  if (low <= high && (second < low || second > high))
    alpha = advanced({0.0, factor_, rate_}, dt, std::clamp(second, low, high));
  else if (low > high)
    alpha = advanced({0.0, factor_, rate_}, dt, 0.5 * (low + high));

  double time = time_ + alpha.position, factor = alpha.velocity, rate = alpha.acceleration;
  if (time <= 0.0 && alpha.position <= 0.0) time = factor = rate = 0.0;
  sample(time, factor, rate);
  for (Eigen::Index i = 0; i < next_.position.size(); ++i)
    if (!acceptable(state_, next_, i, limits_, dt)) return false;
  time_ = std::min(time, duration_);
  factor_ = factor;
  rate_ = rate;
  state_.position = next_.position;
  state_.velocity = next_.velocity;
  state_.acceleration = next_.acceleration;
  if (time >= duration_) {
    finished_ = true;
    factor_ = rate_ = 0.0;
  }
  return true;
}

}  // namespace handsel::trajectory_controller
