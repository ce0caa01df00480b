#include "sim/people/moving_offer.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::sim {

namespace {

constexpr int kMaxDraws = 2000;  // of a point or a turn, until the arm can be there
constexpr int kCurveChecks = 8;  // of a curve, whether it is in reach

double angle_of(const Eigen::Quaterniond& turn) {
  return 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

}  // namespace

bool ArmReach::contains(const Vector3& p_world) const {
  const Vector3 from_shoulder = p_world - p_shoulder;
  const double distance = from_shoulder.norm();
  return distance >= min_distance && distance <= max_distance &&
         from_shoulder.dot(forward) >= before && (p_world - p_avoided).norm() >= avoided;
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
  begin_piece();
}

double MovingOffer::within(double low, double high) {
  return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random_);
}

Vector3 MovingOffer::draw(const Vector3& low, const Vector3& high, const Vector3& otherwise) {
  for (int i = 0; i < kMaxDraws; ++i) {
    const double x = within(low.x(), high.x()), y = within(low.y(), high.y());
    const Vector3 p(x, y, within(low.z(), high.z()));
    if (reach_.contains(p)) return p;
  }
  return otherwise;
}

Vector3 MovingOffer::any_direction() {
  std::normal_distribution<double> normal;
  const double x = normal(random_), y = normal(random_);
  return Vector3(x, y, normal(random_)).stableNormalized();
}

/// Bézier curve of second order.
Vector3 MovingOffer::curve(double u) const {
  return (1 - u) * (1 - u) * from_ + 2 * u * (1 - u) * key_ + u * u * to_;
}

void MovingOffer::begin_piece() {
  from_ = p_;
  along_ = 0;
  const auto is_in_reach = [this] {
    for (int k = 1; k < kCurveChecks; ++k)
      if (!reach_.contains(curve(static_cast<double>(k) / kCurveChecks))) return false;
    return true;
  };
  for (int i = 0; i < kMaxDraws; ++i) {
    to_ = draw(settings_.next_low, settings_.next_high, from_);
    const Vector3 direction = any_direction();
    std::normal_distribution<double> normal(0, settings_.spread);
    key_ = (from_ + to_) / 2 + (settings_.spread > 0 ? normal(random_) : 0.0) * direction;
    if (is_in_reach()) break;
    key_ = (from_ + to_) / 2;
  }
  speed_ = within(settings_.slowest, settings_.fastest);
  turn_speed_ = within(settings_.slowest_turn, settings_.fastest_turn);
  axis_ = any_direction();
}

void MovingOffer::move_on(double length) {
  const Vector3 slope = 2 * (1 - along_) * (key_ - from_) + 2 * along_ * (to_ - key_);
  along_ += slope.norm() > 1e-6 ? length / slope.norm() : 1.0;
  p_ = curve(std::min(along_, 1.0));
  if (along_ >= 1) begin_piece();
}

/// Turns back where the wrist ends, about another axis where that does not lead back either.
void MovingOffer::turn_on(double angle) {
  const auto turned = [&](double by) {
    return (turn_ * Eigen::Quaterniond(Eigen::AngleAxisd(by, axis_))).normalized();
  };
  const double before = angle_of(turn_);
  const auto is_beyond = [&](double by) {
    const double after = angle_of(turned(by));
    return after > settings_.max_turn && after > before;
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
  move_on(speed_ * dt);
  turn_on(turn_speed_ * dt);
}

}  // namespace handsel::sim
