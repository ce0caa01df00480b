// SPDX-License-Identifier: Apache-2.0
#include "sim/people/moving_offer.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::sim {

namespace {

constexpr int kMaxDraws = 2000;  // max draws of a point or a rotation until one is within reach
constexpr int kCurveChecks = 8;  // intervals of a curve whose ends are checked for reach

double angle_of(const Eigen::Quaterniond& turn) {
  return 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

}  // namespace

bool ArmReach::contains(const Vector3& p_world) const {
  const Vector3 from_shoulder = p_world - p_shoulder;
  const double distance = from_shoulder.norm();
  return distance >= min_distance && distance <= max_distance &&
         from_shoulder.dot(forward) >= min_before && (p_world - p_avoided).norm() >= avoided_radius;
}

MovingOffer::MovingOffer(const MovingOfferSettings& settings, const ArmReach& reach,
                         const Vector3& otherwise)
    : settings_(settings), reach_(reach), random_(settings.seed) {
  p_ = draw(settings.start_low, settings.start_high, otherwise);
  for (int i = 0; i < kMaxDraws; ++i) {
    std::normal_distribution<double> normal;
    const Eigen::Quaterniond any(normal(random_), normal(random_), normal(random_),
                                 normal(random_));
    if (angle_of(any.normalized()) > settings.max_turn) continue;
    turn_ = any.normalized();
    break;
  }
  begin_curve();
}

double MovingOffer::draw_uniform(double low, double high) {
  return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random_);
}

Vector3 MovingOffer::draw(const Vector3& low, const Vector3& high, const Vector3& otherwise) {
  for (int i = 0; i < kMaxDraws; ++i) {
    const double x = draw_uniform(low.x(), high.x()), y = draw_uniform(low.y(), high.y());
    Vector3 p(x, y, draw_uniform(low.z(), high.z()));
    if (reach_.contains(p)) return p;
  }
  return otherwise;
}

Vector3 MovingOffer::random_direction() {
  std::normal_distribution<double> normal;
  const double x = normal(random_), y = normal(random_);
  return Vector3(x, y, normal(random_)).stableNormalized();
}

/// Returns the point at parameter u of a Bézier curve of second order.
Vector3 MovingOffer::curve_point(double u) const {
  return (1 - u) * (1 - u) * from_ + 2 * u * (1 - u) * control_point_ + u * u * to_;
}

void MovingOffer::begin_curve() {
  from_ = p_;
  along_ = 0;
  const auto is_in_reach = [this] {
    for (int k = 1; k < kCurveChecks; ++k)
      if (!reach_.contains(curve_point(static_cast<double>(k) / kCurveChecks))) return false;
    return true;
  };
  for (int i = 0; i < kMaxDraws; ++i) {
    to_ = draw(settings_.next_low, settings_.next_high, from_);
    const Vector3 direction = random_direction();
    std::normal_distribution<double> normal(0, settings_.spread);
    control_point_ = (from_ + to_) / 2 + (settings_.spread > 0 ? normal(random_) : 0.0) * direction;
    if (is_in_reach()) break;
    control_point_ = (from_ + to_) / 2;
  }
  speed_ = draw_uniform(settings_.min_speed, settings_.max_speed);
  turn_speed_ = draw_uniform(settings_.min_turn_speed, settings_.max_turn_speed);
  axis_ = random_direction();
}

void MovingOffer::advance(double length) {
  const Vector3 slope =
      2 * (1 - along_) * (control_point_ - from_) + 2 * along_ * (to_ - control_point_);
  along_ += slope.norm() > 1e-6 ? length / slope.norm() : 1.0;
  p_ = curve_point(std::min(along_, 1.0));
  if (along_ >= 1) begin_curve();
}

/// Turns the hand by `angle`. Reverses the rotation at the limit of the wrist; if the reversed
/// rotation does not reduce the angle either, turns directly toward the neutral configuration.
void MovingOffer::turn_by(double angle) {
  const auto turned = [&](double by) {
    return (turn_ * Eigen::Quaterniond(Eigen::AngleAxisd(by, axis_))).normalized();
  };
  const double previous = angle_of(turn_);
  const auto is_beyond = [&](double by) {
    const double after = angle_of(turned(by));
    return after > settings_.max_turn && after > previous;
  };
  if (is_beyond(angle)) {
    axis_ = -axis_;
    if (is_beyond(angle)) {
      const double sign = turn_.w() < 0 ? 1.0 : -1.0;
      axis_ = sign * turn_.vec().stableNormalized();
    }
  }
  turn_ = turned(angle);
}

void MovingOffer::step(double dt, bool waits) {
  if (waits || is_over()) return;
  moved_for_ += dt;
  advance(speed_ * dt);
  turn_by(turn_speed_ * dt);
}

}  // namespace handsel::sim
