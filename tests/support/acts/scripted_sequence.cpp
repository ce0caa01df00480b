// SPDX-License-Identifier: Apache-2.0
// A random script of a person with an object, and of a second person beside.
#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <optional>

#include "tests/support/acts/acted_sequence.hpp"

namespace handsel::test {
namespace {

constexpr double kUsual =
    0.13;  // horizontal distance of a kept object from the shoulder, divided by the stature
constexpr double kSpace = 0.55;        // distance of hesitating people from the robot's hand [m]
constexpr double kCounterTop = 0.95;   // height of the counter [m]
constexpr double kCounterAway = 0.46;  // distance of the counter's middle from the person [m]

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed * 0x9e3779b97f4a7c15ULL + 17) {}
  double within(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random_);
  }
  bool chance(double share) { return within(0, 1) < share; }
  double about(double size) { return within(-size, size); }

 private:
  std::mt19937_64 random_;
};

Vector3 level(const Vector3& v) { return {v.x(), v.y(), 0}; }

/// Place of anna, drawn before all else, since the counter is beside her.
struct Place {
  Vector3 feet{Vector3::Zero()};
  double yaw{}, beside{};  // direction of the counter from the person's facing [rad]
  bool left_handed{};
};

Place place_of(Draw& draw) {
  Place place;
  place.feet = Vector3(1.40 + draw.about(0.15), draw.about(0.25), 0);
  place.yaw = std::atan2(-place.feet.y(), -place.feet.x()) + draw.about(0.35);
  place.left_handed = draw.chance(0.15);
  place.beside = (place.left_handed ? 1 : -1) * draw.within(0.8, 1.5);
  return place;
}

Counter counter_beside(const Place& place) {
  const double direction = place.yaw + place.beside;
  return {place.feet + Vector3(kCounterAway * std::cos(direction),
                               kCounterAway * std::sin(direction), kCounterTop - 0.02),
          Vector3(0.36, 0.36, 0.04)};
}

class Scripted final : public ActedSequence {
 public:
  Scripted(const ActStage& stage, std::uint64_t seed)
      : stage_(stage), draw_(seed), place_(place_of(draw_)), counter_(counter_beside(place_)) {
    ActedPerson::Settings settings;
    settings.id = "anna";
    settings.feet = place_.feet;
    settings.yaw = yaw_ = place_.yaw;
    settings.stature = draw_.within(1.55, 1.90);
    settings.left_handed = place_.left_handed;
    settings.sway = draw_.within(0.001, 0.006);
    const ActedPerson model(settings, Vector3(0.3, 0, 1));
    shoulder_ = model.shoulder();
    head_ = model.joint("head");
    torso_ = model.joint("torso");
    side_ = model.side();
    reach_ = model.reach();
    stature_ = settings.stature;
    pace_ = draw_.within(0.7, 1.3);
    kept_ = draw_.chance(0.75) ? before_body() : beside_leg();
    hand_ = kept_;
    anna_.emplace(settings, kept_);
    ben_.emplace(ben(), Vector3(0.05, -0.2, 0.8));
    write();
    object_ = anna_->T_world_hand() * T_hand_object_;
    next();
  }

  void step(double dt) override {
    clock_ += dt;
    if (anna_->is_over(clock_ - begun_) && !pieces_.empty()) next();
    anna_->move(clock_ - begun_, clock_, seen_by(anna_->gaze()), dt);
    ben_->move(clock_ - ben_begun_, clock_ + 7, object_.translation(), dt);
    if (carrier_ == Carrier::anna) object_ = anna_->T_world_hand() * T_hand_object_;
    if (carrier_ == Carrier::ben) object_ = ben_->T_world_hand() * T_hand_object_;
  }
  double duration() const override { return duration_; }
  std::vector<const Person*> people() const override {
    std::vector<const Person*> out{&anna_->body()};
    if (has_ben_) out.push_back(&ben_->body());
    return out;
  }
  Pose T_world_object() const override { return object_; }
  Act act() const override { return anna_->act(); }

 private:
  enum class Carrier { anna, ben, counter };
  struct Step {
    Piece piece;
    std::function<void()> at_begin;
  };

  void next() {
    Step step = std::move(pieces_.front());
    pieces_.pop_front();
    if (step.at_begin) step.at_begin();
    anna_->begin(step.piece);
    begun_ = clock_;
  }

  Vector3 seen_by(Gaze gaze) const {
    switch (gaze) {
      case Gaze::object:
        return object_.translation();
      case Gaze::robot:
        return stage_.p_hand;
      case Gaze::aside:
        return level(anna_->body().joints[0].position) + Vector3(0, 3, 1.5);
      default:
        break;
    }
    return anna_->body().joints[0].position +
           Vector3(std::cos(anna_->yaw()), std::sin(anna_->yaw()), 0);
  }

  /// Adds a piece; the duration follows from the distance where none is given.
  Piece& add(Act act, const Vector3& hand, double duration = 0) {
    Piece piece;
    piece.act = act;
    piece.hand = hand;
    piece.duration =
        duration > 0 ? duration : std::max(0.35, 0.45 + 1.1 * (hand - hand_).norm()) / pace_;
    hand_ = hand;
    duration_ += piece.duration;
    pieces_.push_back({piece, {}});
    return pieces_.back().piece;
  }
  void rest(Act act, double duration, Gaze gaze) { add(act, hand_, duration).gaze = gaze; }

  Vector3 before_body() {
    return torso_ + stature_ * Vector3(draw_.within(0.08, 0.12), side_ * draw_.within(0.04, 0.09),
                                       draw_.within(-0.08, 0.02));
  }
  Vector3 beside_leg() {
    return shoulder_ + Vector3(draw_.within(0.02, 0.08), side_ * 0.05, -0.93 * reach_);
  }
  /// Where the hand is when the object is offered in the direction `yaw` from the facing.
  Vector3 held_out(double yaw) {
    const double far = draw_.within(0.25, 0.31) * stature_, up = draw_.within(-0.19, -0.08);
    Vector3 arm = Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Vector3(far, 0, 0) +
                  Vector3(0, -side_ * 0.02 * stature_, up * stature_);
    if (arm.norm() > 0.95 * reach_) arm *= 0.95 * reach_ / arm.norm();
    return shoulder_ + arm;
  }
  /// Direction of a world point from the shoulder, from the facing [rad].
  double direction_to(const Vector3& p) const {
    const Vector3 root = feet() + Eigen::AngleAxisd(yaw_, Vector3::UnitZ()) * shoulder_;
    return std::remainder(std::atan2(p.y() - root.y(), p.x() - root.x()) - yaw_, 2 * M_PI);
  }
  Vector3 feet() const { return place_.feet + walked_; }
  /// Toward the robot's hand, with some space before the hand.
  Vector3 offered() {
    Vector3 out = held_out(std::clamp(direction_to(stage_.p_hand), -0.6, 0.6) + draw_.about(0.1));
    const Vector3 p_hand = in_body(stage_.p_hand), ahead(kHeldInFront, 0, 0);
    const double space = draw_.within(0.30, 0.42);
    for (int i = 0; i < 60 && (out + ahead - p_hand).norm() < space; ++i)
      out.head<2>() -= 0.01 * level(out - shoulder_).normalized().head<2>();
    return out;
  }

  void keep() {
    if (draw_.chance(0.3)) kept_ = before_body();
    add(Act::withdraws, kept_);
    rest(Act::keeps, draw_.within(0.6, 2.2), draw_.chance(0.5) ? Gaze::robot : Gaze::ahead);
  }
  void offer() {
    const Vector3 out = offered();
    const double kept = std::max(level(kept_ - shoulder_).norm(), kUsual * stature_);
    if (level(out - shoulder_).norm() < kept + kMinOutward) return;
    const bool has_space = (in_body(stage_.p_hand) - out).norm() > kSpace;
    if (draw_.chance(0.3) && has_space) {
      add(Act::brings_out, hand_ + draw_.within(0.35, 0.55) * (out - hand_)).gaze = Gaze::robot;
      rest(Act::hesitates, draw_.within(0.3, 1.2), Gaze::robot);
    }
    add(Act::brings_out, out).gaze = Gaze::robot;
    rest(Act::offers, draw_.within(1.2, 2.5), draw_.chance(0.7) ? Gaze::robot : Gaze::object);
    add(Act::withdraws, kept_);
  }
  void abort() {
    const Vector3 out = hand_ + draw_.within(0.6, 1.0) * (offered() - hand_);
    add(Act::aborts, out).gaze = Gaze::robot;
    add(Act::aborts, kept_);
  }
  void drink() {
    add(Act::drinks, head_ + Vector3(0.06, side_ * 0.02, -0.06)).gaze = Gaze::ahead;
    rest(Act::drinks, draw_.within(0.8, 2.5), Gaze::ahead);
    add(Act::drinks, kept_);
    rest(Act::keeps, draw_.within(0.4, 1.5), Gaze::ahead);
  }
  void inspect() {
    add(Act::inspects, head_ + Vector3(draw_.within(0.20, 0.30), side_ * draw_.within(0, 0.08),
                                       draw_.within(-0.28, -0.10)))
        .gaze = Gaze::object;
    rest(Act::inspects, draw_.within(1.0, 2.5), Gaze::object);
    add(Act::inspects, kept_);
  }
  void gesture() {
    const Vector3 middle =
        shoulder_ + Vector3(draw_.within(0.20, 0.30), -side_ * 0.05, draw_.within(-0.30, -0.12));
    const int strokes = 3 + static_cast<int>(draw_.within(0, 5));
    for (int i = 0; i < strokes; ++i) {
      const Vector3 by(draw_.about(0.10), draw_.about(0.18), draw_.about(0.15));
      add(Act::gestures, middle + by, draw_.within(0.25, 0.5)).gaze =
          draw_.chance(0.5) ? Gaze::robot : Gaze::aside;
      if (draw_.chance(0.4)) rest(Act::gestures, draw_.within(0.03, 0.12), Gaze::robot);
    }
    add(Act::gestures, kept_);
  }
  void carry_past() {
    const double turn = (draw_.chance(0.5) ? 1 : -1) * draw_.within(1.2, 1.8);
    const double far = draw_.within(0.8, 1.8), speed = draw_.within(0.5, 0.9);
    turn_by(turn);
    walk(far, far / speed);
    turn_by(M_PI);
    if (draw_.chance(0.4)) rest(Act::keeps, draw_.within(0.5, 1.5), Gaze::ahead);
    walk(far, far / speed);
    turn_by(M_PI - turn - 2 * M_PI);
  }
  void turn_by(double angle) {
    Piece& piece = add(Act::carries, hand_, std::max(0.6, std::abs(angle) / 2.5));
    piece.turn = angle;
    yaw_ += angle;
  }
  void walk(double length, double time) {
    Piece& piece =
        add(Act::carries, hand_ + Vector3(draw_.about(0.03), 0, draw_.about(0.03)), time);
    piece.step = length * Vector3(std::cos(yaw_), std::sin(yaw_), 0);
    walked_ += piece.step;
  }
  void come_nearer() {
    const double length = draw_.within(-0.25, 0.25);
    walk(length, std::max(0.6, std::abs(length) / 0.5));
    rest(Act::keeps, draw_.within(0.5, 1.5), Gaze::robot);
  }
  void put_down() {
    const Vector3 top = in_body(Vector3(counter_.centre.x() + draw_.about(0.03),
                                        counter_.centre.y() + draw_.about(0.03),
                                        kCounterTop + stage_.object->height_above_support + 0.002));
    const Vector3 hand = top - Vector3(kHeldInFront, 0, 0);
    add(Act::puts_down, hand + Vector3(0, 0, 0.12)).gaze = Gaze::object;
    add(Act::puts_down, hand).gaze = Gaze::object;
    rest(Act::puts_down, draw_.within(0.2, 0.5), Gaze::object);
    add(Act::puts_down, beside_leg());
    pieces_.back().at_begin = [this] { carrier_ = Carrier::counter; };
    rest(Act::puts_down, draw_.within(0.5, 1.2), Gaze::robot);
    add(Act::puts_down, hand).gaze = Gaze::object;
    add(Act::puts_down, hand + Vector3(0, 0, 0.1)).gaze = Gaze::object;
    pieces_.back().at_begin = [this] { carrier_ = Carrier::anna; };
    add(Act::keeps, kept_);
    rest(Act::keeps, draw_.within(0.5, 1.2), Gaze::robot);
  }
  void point_aside() {
    const double robot = direction_to(stage_.p_robot), hand = direction_to(stage_.p_hand);
    const double beyond = draw_.within(0.8, 1.3);
    const double aside =
        side_ > 0 ? std::max(robot, hand) + beyond : std::min(robot, hand) - beyond;
    add(Act::points, held_out(aside)).gaze = Gaze::aside;
    rest(Act::points, draw_.within(0.6, 1.5), Gaze::aside);
    add(Act::points, kept_);
  }
  /// Offers the object to ben, who takes it in two of three cases.
  void pass() {
    const double direction = direction_to(level(ben_->body().joints[0].position));
    const double turn = direction - std::clamp(direction, -0.5, 0.5);
    if (turn != 0) turn_by(turn);
    const Vector3 out = held_out(direction_to(level(ben_->body().joints[0].position)));
    add(Act::passes, out).gaze = Gaze::aside;
    const bool takes = draw_.chance(0.67);
    rest(Act::passes, draw_.within(0.7, 1.5), Gaze::aside);
    pieces_.back().at_begin = [this] { reach_by_ben(); };
    if (!takes) {
      add(Act::passes, kept_);
      pieces_.back().at_begin = [this] { retract_ben(); };
      rest(Act::keeps, 0.8, Gaze::aside);
      return;
    }
    add(Act::passes, beside_leg());
    pieces_.back().at_begin = [this] {
      carrier_ = Carrier::ben;
      T_hand_object_ = ben_->T_world_hand().inverse() * object_;
      retract_ben();
    };
    rest(Act::passes, draw_.within(1.5, 2.5), Gaze::aside);
  }
  void reach_by_ben() {
    Piece piece;
    piece.act = Act::receives;
    piece.duration = 0.6;
    const Vector3 p = object_.translation();
    const Vector3 back = level(ben_->body().joints[0].position - p).normalized();
    piece.hand = ben_->to_body(p + 0.07 * back - Vector3(0, 0, 0.02));
    ben_->begin(piece);
    ben_begun_ = clock_;
  }
  void retract_ben() {
    Piece piece;
    piece.act = Act::receives;
    piece.duration = 0.9;
    piece.hand = Vector3(0.25, -0.12, 1.1);
    ben_->begin(piece);
    ben_begun_ = clock_;
  }
  /// Returns ben, who is beside anna, within reach of her offer.
  ActedPerson::Settings ben() {
    ActedPerson::Settings settings;
    settings.id = "ben";
    const auto toward = [&](const Vector3& p) {
      return std::atan2(p.y() - place_.feet.y(), p.x() - place_.feet.x());
    };
    const double robot = toward(stage_.p_robot);
    const double hand = robot + std::remainder(toward(stage_.p_hand) - robot, 2 * M_PI);
    const double beyond = draw_.within(0.9, 1.6);
    const double beside =
        draw_.chance(0.5) ? std::max(robot, hand) + beyond : std::min(robot, hand) - beyond;
    const Vector3 away(std::cos(beside), std::sin(beside), 0);
    settings.feet = place_.feet + draw_.within(0.95, 1.1) * away;
    settings.yaw = std::atan2(-away.y(), -away.x());
    settings.stature = draw_.within(1.6, 1.85);
    return settings;
  }
  Vector3 in_body(const Vector3& p_world) const {
    return Eigen::AngleAxisd(-yaw_, Vector3::UnitZ()) * (p_world - feet());
  }

  /// Writes two or three acts; the last may leave the object with another person.
  void write() {
    rest(Act::keeps, draw_.within(1.0, 1.8), Gaze::robot);
    const int acts = draw_.chance(0.5) ? 2 : 3;
    for (int i = 0; i < acts; ++i) {
      const double kind = draw_.within(0, 1);
      if (kind < 0.34) {
        offer();
      } else if (kind < 0.42) {
        abort();
      } else if (kind < 0.51) {
        drink();
      } else if (kind < 0.59) {
        inspect();
      } else if (kind < 0.68) {
        gesture();
      } else if (kind < 0.76) {
        carry_past();
      } else if (kind < 0.82) {
        come_nearer();
      } else if (kind < 0.89) {
        put_down();
      } else if (kind < 0.95) {
        point_aside();
      } else {
        has_ben_ = true;
        pass();
        return;
      }
      keep();
    }
  }

  ActStage stage_;
  Draw draw_;
  Place place_;
  Counter counter_;
  std::optional<ActedPerson> anna_, ben_;
  Vector3 shoulder_, head_, torso_, kept_, hand_, walked_{Vector3::Zero()};
  double side_{}, reach_{}, stature_{}, pace_{1}, yaw_{};
  std::deque<Step> pieces_;
  double duration_{}, clock_{}, begun_{}, ben_begun_{};
  bool has_ben_{};
  Carrier carrier_{Carrier::anna};
  Pose T_hand_object_{make_pose({kHeldInFront, 0, 0})};
  Pose object_{Pose::Identity()};
};

}  // namespace

Counter counter_of(std::uint64_t seed) {
  Draw draw(seed);
  return counter_beside(place_of(draw));
}

std::unique_ptr<ActedSequence> scripted_sequence(const ActStage& stage, std::uint64_t seed) {
  return std::make_unique<Scripted>(stage, seed);
}

}  // namespace handsel::test
