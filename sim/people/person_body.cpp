// SPDX-License-Identifier: Apache-2.0
// Positions of a person's body, arms and gaze, and grasp points of a hand on an object.
#include <algorithm>

#include "common/model/object_surface.hpp"
#include "sim/people/person.hpp"
#include "sim/people/person_parts.hpp"

namespace handsel::sim {

void PersonModel::place_body() {
  if (followed_) {
    followed_->sample(clock_, points_);
    const Vector3 left = points_[kShoulder[0]] - points_[kShoulder[1]];
    yaw_ = std::atan2(-left.x(), left.y());
    return;
  }
  const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw_, Vector3::UnitZ()).toRotationMatrix();
  BodyPoints own = template_;
  if (settings_.recording) {
    settings_.recording->sample(playback_, own);
  } else if (lean_ != 0) {
    const Eigen::Matrix3d tilt = Eigen::AngleAxisd(lean_, Vector3::UnitY()).toRotationMatrix();
    const auto lean = [&](int i) { own[i] = own[kWaist] + tilt * (own[i] - own[kWaist]); };
    for (int i : {kHead, kNeck, kTorso}) lean(i);
    for (int s = 0; s < 2; ++s) {
      for (int i : {kShoulder[s], kElbow[s], kWrist[s], kHand[s]}) lean(i);
    }
  }
  for (std::size_t i = 0; i < own.size(); ++i) points_[i] = feet_ + aside_ + R * own[i];
}

/// Moves hand and arm so that the hand is at `target`. Near the rest configuration the arm keeps
/// its shape; farther away hand and forearm align and the elbow points down and out. So no joint
/// jumps when a motion of the hand begins or ends.
void PersonModel::bend_arm(int s, const Vector3& target) {
  const Vector3 root = points_[kShoulder[s]], elbow = points_[kElbow[s]],
                wrist = points_[kWrist[s]], hand = points_[kHand[s]];
  const double upper = (elbow - root).norm(), lower = (wrist - elbow).norm(),
               palm = (hand - wrist).norm();
  const double away = min_jerk((target - hand).norm() / 0.3);
  const Vector3 along = (target - root).stableNormalized();
  Vector3 palm_direction =
      ((1 - away) * (hand - wrist).stableNormalized() + away * along).stableNormalized();
  if (const auto& configuration = hand_configuration(s)) {
    const Vector3 fingers = configuration->R_world_hand * Vector3::UnitZ();
    palm_direction = ((1 - bend_) * palm_direction + bend_ * fingers).stableNormalized();
  }
  const Vector3 palm_vector = palm * palm_direction;
  Vector3 to = target - palm_vector - root;
  const double d = std::clamp(to.norm(), std::abs(upper - lower) + 1e-3, upper + lower - 1e-6);
  to = to.norm() > 1e-9 ? Vector3(to.normalized()) : forward();
  const double a = (upper * upper - lower * lower + d * d) / (2 * d);
  const double h = std::sqrt(std::max(0.0, upper * upper - a * a));
  const auto across = [&](const Vector3& v) {
    return Vector3((v - v.dot(to) * to).stableNormalized());
  };
  const Vector3 led =
      across(Vector3(0, 0, -0.8) + (s == 0 ? 0.4 : -0.4) * left() - 0.2 * forward());
  const Vector3 bent =
      elbow - root -
      (elbow - root).dot((wrist - root).stableNormalized()) * (wrist - root).stableNormalized();
  const Vector3 own = bent.norm() > 1e-4 ? across(bent) : led;
  const Vector3 out = across((1 - away) * own + away * led);
  points_[kElbow[s]] = root + a * to + h * out;
  points_[kWrist[s]] = root + d * to;
  points_[kHand[s]] = points_[kWrist[s]] + palm_vector;
}

void PersonModel::turn_gaze(const Vector3& target, double dt) {
  const Vector3 want = (target - points_[kHead]).normalized();
  gaze_ = (gaze_ + std::min(1.0, dt / settings_.manners.person_gaze_time) * (want - gaze_))
              .normalized();
}

void PersonModel::command_hands(double dt) {
  for (int s = 0; s < 2; ++s) {
    const Vector3 before = hands_[s].T_world_body.translation(), now = points_[kHand[s]];
    hands_[s].velocity =
        first_ || dt <= 0 ? Vector3(Vector3::Zero()) : Vector3((now - before) / dt);
    Eigen::Quaterniond turned(Eigen::AngleAxisd(yaw_, Vector3::UnitZ()));
    if (s == hand_index()) turned = turned * hand_turn_;
    hands_[s].T_world_body = make_pose(now, turned);
  }
}

Vector3 PersonModel::carry_position() const {
  const PersonManners& manners = settings_.manners;
  // Of two hands each is as far beside the middle of the trunk.
  const double beside = uses_both_hands() ? std::abs(second_hand_.offset().dot(left())) / 2
                                          : manners.person_carry_beside;
  return points_[kTorso] + manners.person_carry_ahead * forward() +
         (side_ == Side::left ? beside : -beside) * left() -
         Vector3(0, 0, manners.person_carry_below);
}

/// Returns the position of a hand at rest, world [m].
Vector3 PersonModel::rest_position(int side) const {
  return feet_ + aside_ + Eigen::AngleAxisd(yaw_, Vector3::UnitZ()) * template_[kHand[side]];
}

Vector3 PersonModel::shoulder(int side) const { return points_[kShoulder[side]]; }

double PersonModel::hand_to_surface(const PersonView& view, const Vector3& p_hand) const {
  return surface_distance(*view.object, view.T_world_object.inverse() * p_hand);
}

/// Returns the recorded hand's position of max reach for a person at `feet`, world [m].
Vector3 PersonModel::recorded_contact(const Vector3& feet) const {
  BodyPoints points;
  settings_.recording->sample(settings_.recording->contact, points);
  return feet + Eigen::AngleAxisd(yaw_, Vector3::UnitZ()) * points[kHand[hand_index()]];
}

/// Returns the position of the hand's centre nearest to `from` at which the hand holds the object,
/// world [m].
Vector3 PersonModel::nearest_grasp_point(const PersonView& view, const Vector3& from) const {
  const Pose T_object_world = view.T_world_object.inverse();
  const auto distance = [&](const Vector3& p) {
    return surface_distance(*view.object, T_object_world * p);
  };
  Vector3 p = from;
  for (int i = 0; i < 8; ++i) {
    const double d = distance(p), h = 1e-4;
    if (std::abs(d - kPalmDistance) < 5e-4) break;
    const Vector3 slope((distance(p + h * Vector3::UnitX()) - d) / h,
                        (distance(p + h * Vector3::UnitY()) - d) / h,
                        (distance(p + h * Vector3::UnitZ()) - d) / h);
    if (slope.norm() < 1e-6) break;
    p -= (d - kPalmDistance) * slope.normalized();
  }
  return p;
}

/// Returns the position of the hand's centre at contact, in the chosen place, else on a line from
/// the object's centre along side_of_object_, world [m].
Vector3 PersonModel::grasp_point(const PersonView& view) const {
  if (taking_.has_place()) return taking_.goal(view.T_world_object).translation();
  const Vector3 centre = object_centre(view);
  const Pose T_object_world = view.T_world_object.inverse();
  double t = 0.4;
  for (int i = 0; i < 40; ++i) {
    const double beyond =
        surface_distance(*view.object, T_object_world * (centre + t * side_of_object_)) -
        kPalmDistance;
    t -= beyond;
    if (std::abs(beyond) < 5e-4 || t < 0) break;
  }
  return centre + std::max(t, 0.0) * side_of_object_;
}

}  // namespace handsel::sim
