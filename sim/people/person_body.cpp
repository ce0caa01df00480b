// Where body, arms and gaze of a person are, and where a hand holds an object.
#include <algorithm>

#include "common/model/object_surface.hpp"
#include "sim/people/person.hpp"
#include "sim/people/person_parts.hpp"

namespace handsel::sim {

void PersonModel::place_base() {
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

// Moves the hand to `target`. Near the base posture the arm keeps its shape, farther away hand and
// forearm line up, elbow down and out: no joint jumps when the hand begins or ends to be led.
void PersonModel::bend_arm(int s, const Vector3& target) {
  const Vector3 root = points_[kShoulder[s]], elbow = points_[kElbow[s]],
                wrist = points_[kWrist[s]], hand = points_[kHand[s]];
  const double upper = (elbow - root).norm(), lower = (wrist - elbow).norm(),
               palm = (hand - wrist).norm();
  const double away = min_jerk((target - hand).norm() / 0.3);
  const Vector3 along = (target - root).stableNormalized();
  const Vector3 palm_vector =
      palm * ((1 - away) * (hand - wrist).stableNormalized() + away * along).stableNormalized();
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

void PersonModel::look_at(const Vector3& target, double dt) {
  const Vector3 want = (target - points_[kHead]).normalized();
  gaze_ = (gaze_ + std::min(1.0, dt / 0.15) * (want - gaze_)).normalized();
}

void PersonModel::want_hands(double dt) {
  for (int s = 0; s < 2; ++s) {
    const Vector3 before = hands_[s].T_world_body.translation(), now = points_[kHand[s]];
    hands_[s].velocity =
        first_ || dt <= 0 ? Vector3(Vector3::Zero()) : Vector3((now - before) / dt);
    Eigen::Quaterniond turned(Eigen::AngleAxisd(yaw_, Vector3::UnitZ()));
    if (s == index()) turned = turned * hand_turn_;
    hands_[s].T_world_body = make_pose(now, turned);
  }
}

Vector3 PersonModel::keep_point() const {
  return points_[kTorso] + 0.22 * forward() + (side_ == Side::left ? 0.12 : -0.12) * left() -
         Vector3(0, 0, 0.05);
}

Vector3 PersonModel::shoulder(int side) const { return points_[kShoulder[side]]; }

double PersonModel::gap(const PersonView& view) const {
  return surface_distance(*view.object, view.T_world_object.inverse() * hand_target_);
}

// Where the recorded hand is at its farthest when the person stands at `feet`.
Vector3 PersonModel::at_contact(const Vector3& feet) const {
  BodyPoints points;
  settings_.recording->sample(settings_.recording->contact, points);
  return feet + Eigen::AngleAxisd(yaw_, Vector3::UnitZ()) * points[kHand[index()]];
}

// The place for the middle of the hand nearest to `from` from which it holds the object.
Vector3 PersonModel::nearest_hold(const PersonView& view, const Vector3& from) const {
  const Pose T_object_world = view.T_world_object.inverse();
  const auto distance = [&](const Vector3& p) {
    return surface_distance(*view.object, T_object_world * p);
  };
  Vector3 p = from;
  for (int i = 0; i < 8; ++i) {
    const double d = distance(p), h = 1e-4;
    if (std::abs(d - kPalm) < 5e-4) break;
    const Vector3 slope((distance(p + h * Vector3::UnitX()) - d) / h,
                        (distance(p + h * Vector3::UnitY()) - d) / h,
                        (distance(p + h * Vector3::UnitZ()) - d) / h);
    if (slope.norm() < 1e-6) break;
    p -= (d - kPalm) * slope.normalized();
  }
  return p;
}

// Where the middle of the hand touches the object, coming from side_of_object_.
Vector3 PersonModel::grasp_point(const PersonView& view) const {
  const Vector3 centre = object_centre(view);
  const Pose T_object_world = view.T_world_object.inverse();
  double t = 0.4;
  for (int i = 0; i < 40; ++i) {
    const double beyond =
        surface_distance(*view.object, T_object_world * (centre + t * side_of_object_)) - kPalm;
    t -= beyond;
    if (std::abs(beyond) < 5e-4 || t < 0) break;
  }
  return centre + std::max(t, 0.0) * side_of_object_;
}

}  // namespace handsel::sim
