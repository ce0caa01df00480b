// SPDX-License-Identifier: Apache-2.0
#include "tests/support/acts/acted_person.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/human/human_body.hpp"

namespace handsel::test {
namespace {

std::size_t index(const std::string& joint) {
  return static_cast<std::size_t>(body_joint_index(joint));
}

double min_jerk(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}

Eigen::Matrix3d about_z(double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix();
}

}  // namespace

const char* name(Act act) {
  static constexpr const char* kNames[] = {
      "keeps",  "brings_out", "offers",   "hesitates", "withdraws", "aborts", "carries",
      "drinks", "inspects",   "gestures", "puts_down", "passes",    "points", "receives"};
  return kNames[static_cast<int>(act)];
}

ActedPerson::ActedPerson(const Settings& settings, const Vector3& hand)
    : settings_(settings),
      template_(standing_body(Vector3::Zero(), 0, settings.stature)),
      feet_(settings.feet),
      feet_from_(settings.feet),
      hand_(hand),
      hand_from_(hand),
      yaw_(settings.yaw),
      yaw_from_(settings.yaw) {
  const char side = settings_.left_handed ? 'l' : 'r';
  const auto bone = [&](const char* a, const char* b) {
    return (joint((std::string{side} + a).c_str()) - joint((std::string{side} + b).c_str())).norm();
  };
  upper_ = bone("_shoulder", "_elbow");
  lower_ = bone("_elbow", "_wrist");
  palm_ = bone("_wrist", "_hand");
  body_.id = settings_.id;
  body_.stature = settings_.stature;
  body_.gaze_known = true;
  body_.gaze_direction = {std::cos(yaw_), std::sin(yaw_), 0};
  body_.joints = template_;
  piece_.duration = 1e-3;
  piece_.hand = hand;
  move(1, 0, settings.feet, 0);
}

Vector3 ActedPerson::joint(const char* name) const { return template_[index(name)].position; }

Vector3 ActedPerson::shoulder() const {
  return joint(settings_.left_handed ? "l_shoulder" : "r_shoulder");
}

Vector3 ActedPerson::to_body(const Vector3& p_world) const {
  return about_z(-yaw_) * (p_world - feet_);
}

void ActedPerson::begin(const Piece& piece) {
  piece_ = piece;
  feet_from_ = feet_;
  hand_from_ = hand_;
  yaw_from_ = yaw_;
}

void ActedPerson::move(double t, double clock, const Vector3& look_at, double dt) {
  const double s = min_jerk(t / piece_.duration);
  feet_ = feet_from_ + s * piece_.step;
  yaw_ = yaw_from_ + s * piece_.turn;
  hand_ = hand_from_ + s * (piece_.hand - hand_from_);
  const Vector3 sway = settings_.sway * Vector3(std::sin(1.9 * clock + settings_.feet.x() * 40),
                                                std::sin(1.4 * clock + settings_.feet.y() * 40), 0);
  const Vector3 tremor = settings_.tremor * Vector3(std::sin(9.1 * clock), std::sin(7.3 * clock),
                                                    std::sin(8.2 * clock + 1));
  const Eigen::Matrix3d R = about_z(yaw_);
  for (std::size_t i = 0; i < template_.size(); ++i) {
    const double height = template_[i].position.z() / settings_.stature;
    body_.joints[i].position = feet_ + R * template_[i].position + height * sway;
  }
  bend_arm(feet_ + R * (hand_ + tremor) + 0.7 * sway);
  const Vector3 head = body_.joints[index("head")].position;
  const Vector3 wanted = (look_at - head).stableNormalized();
  Vector3& gaze = body_.gaze_direction;
  gaze = (gaze + std::min(1.0, dt / 0.15) * (wanted - gaze)).stableNormalized();
  body_.gaze_origin = head + 0.08 * gaze;
}

/// Hand and forearm line up, elbow down and out.
void ActedPerson::bend_arm(const Vector3& target) {
  const std::string side = settings_.left_handed ? "l" : "r";
  const Vector3 root = body_.joints[index(side + "_shoulder")].position;
  const double lower = lower_ + palm_;
  Vector3 to = target - root;
  const double d = std::clamp(to.norm(), std::abs(upper_ - lower) + 1e-3, reach());
  to = to.stableNormalized();
  const double a = (upper_ * upper_ - lower * lower + d * d) / (2 * d);
  const double h = std::sqrt(std::max(0.0, upper_ * upper_ - a * a));
  const Vector3 down = Vector3(0, 0, -0.8) + about_z(yaw_) * Vector3(-0.2, 0.4 * this->side(), 0);
  const Vector3 out = (down - down.dot(to) * to).stableNormalized();
  const Vector3 elbow = root + a * to + h * out, hand = root + d * to;
  body_.joints[index(side + "_elbow")].position = elbow;
  body_.joints[index(side + "_hand")].position = hand;
  body_.joints[index(side + "_wrist")].position = elbow + lower_ / lower * (hand - elbow);
}

Pose ActedPerson::T_world_hand() const {
  return make_pose(body_.joints[index(settings_.left_handed ? "l_hand" : "r_hand")].position,
                   Eigen::Quaterniond(about_z(yaw_)));
}

}  // namespace handsel::test
