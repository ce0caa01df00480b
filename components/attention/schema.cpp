// SPDX-License-Identifier: Apache-2.0
#include "components/attention/schema.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/human/body_index.hpp"
#include "common/model/human/body_motion.hpp"
#include "components/attention/looks.hpp"
#include "components/attention/object_search.hpp"
#include "components/attention/watch.hpp"

namespace handsel::attention {

Body::Body(const RobotModel& robot, const Vector3& p_tool_grasp)
    : robot_(robot), capsules_(robot_capsules(robot)), p_tool_grasp_(p_tool_grasp) {}

Separation Body::separation_at(const Vector& q, const Pose& T_world_base, const HumanState& people,
                               const SeparationExemption& exception) const {
  robot_.forward(q, links_);
  return separation(capsules_, links_, T_world_base, people, exception);
}

Vector3 Body::grasp_point(const Vector& q, const Pose& T_world_base) const {
  robot_.forward(q, links_);
  const int tool = robot_.tool_link();
  return T_world_base * (tool < 0
                             ? Vector3(0, 0, 0)
                             : Vector3(links_[static_cast<std::size_t>(tool)] * p_tool_grasp_));
}

namespace {

// Height from which people and objects are searched for [m].
constexpr double kEyeHeight = 1.3;

/// Searches for the lost object of the action, else for people.
class Search : public Schema {
 public:
  Search(const Body& body, const MotorSettings& motor)
      : body_(body), motor_(motor), object_search_(motor) {}
  Behaviour kind() const override { return Behaviour::search; }
  double perceive(const World& w, TimePoint now) override {
    const bool seen = person_of_interest(w, Vector3::Zero(), motor_.lost_after) != nullptr;
    if (seen || !started_) last_seen_ = now;
    started_ = true;
    const Vector3 p_eye = w.active ? body_.base_point(*w.active, Vector3(0, 0, kEyeHeight))
                                   : Vector3(0, 0, kEyeHeight);
    const auto place = object_search_.target(w, p_eye, now);
    searches_object_ = place.has_value();
    searching_ = searches_object_ || !seen;
    if (place) {
      target_ = *place;
      aimed_ = true;
      return 0;
    }
    if (seen) return kInfinity;
    const double since = to_seconds(now - last_seen_);
    if (w.active) {
      const double angle = 0.9 * std::sin(0.6 * since);
      target_ = body_.base_point(*w.active,
                                 Vector3(2.0 * std::cos(angle), 2.0 * std::sin(angle), kEyeHeight));
      aimed_ = true;
    }
    return since;
  }
  bool released(const World&) const override { return searching_; }
  bool needs_gaze() const override { return searches_object_; }
  std::optional<Vector3> gaze() const override {
    return aimed_ ? std::optional(target_) : std::nullopt;
  }

 private:
  const Body& body_;
  MotorSettings motor_;
  ObjectSearch object_search_;
  bool started_{}, searching_{true}, aimed_{}, searches_object_{};
  TimePoint last_seen_{};
  Vector3 target_{Vector3::Zero()};
};

class Track : public Schema {
 public:
  Track(const Body& body, const MotorSettings& motor, const ZoneSettings& zones)
      : body_(body), motor_(motor), zone_(zones) {}
  Behaviour kind() const override { return Behaviour::track; }
  double perceive(const World& w, TimePoint now) override {
    constexpr double kAngle = 0.1;
    const Vector3 base = w.active ? body_.base_point(*w.active, Vector3::Zero()) : Vector3::Zero();
    const Person* person = person_of_interest(w, base, motor_.lost_after);
    tracked_ = false;
    if (!person) return kInfinity;
    const BodyJoint& head = person->joints[body::head];
    const BodyJoint& torso = person->joints[body::torso];
    const Eigen::Vector2d away = (torso.position - base).head<2>();
    const double distance = std::max(0.1, away.norm());
    tracked_ = zone_.update(distance, now) <= Zone::social;
    target_ = head.position;
    const double speed = std::max(torso.velocity.norm(), head.velocity.norm());
    return kAngle / std::max(1e-3, speed / distance);
  }
  bool released(const World&) const override { return tracked_; }
  std::optional<Vector3> gaze() const override {
    return tracked_ ? std::optional(target_) : std::nullopt;
  }

 private:
  const Body& body_;
  MotorSettings motor_;
  ZoneTracker zone_;
  bool tracked_{};
  Vector3 target_{Vector3::Zero()};
};

class Avoid : public Schema {
 public:
  Avoid(const Body& body, const MotorSettings& motor, const ZoneSettings& zones)
      : body_(body), motor_(motor), zone_(zones) {}
  Behaviour kind() const override { return Behaviour::avoid; }
  double perceive(const World& w, TimePoint now) override {
    factor_ = 1.0;
    near_ = leaves_path_ = false;
    distance_ = w.people && w.people->people.empty() ? kInfinity : 0.0;
    if (!w.people || w.people->people.empty() || !robot_known(w, body_)) return kInfinity;
    const SeparationExemption exception = handover_exemption(w);
    const ActiveTrajectory& active = *w.active;
    const Separation s =
        body_.separation_at(active.position, active.T_world_base, *w.people, exception);
    near_ = zone_.update(s.distance, now) <= Zone::interaction;
    distance_ = std::max(0.0, s.distance);
    double closing = 0.0;
    for (const Person& person : w.people->people)
      if (person.id == s.person)
        closing = directed_speed(person, s.part, (s.on_robot - s.on_person).normalized());
    double stimulus = urgency(s.distance, closing, motor_.urgent_speed);
    if (w.forecast && w.forecast->trajectory != 0 && w.forecast->trajectory == active.trajectory)
      stimulus = std::min(stimulus, std::max(0.0, w.forecast->clearance));
    if (!near_) return stimulus;

    const bool partner = in_handover_with(w, s.person);
    const double contact_time = partner ? motor_.partner_contact_time : motor_.avoid_contact_time;
    factor_ =
        ramp(s.distance, motor_.avoid_stop, partner ? motor_.partner_slow : motor_.avoid_slow);
    reason_ = "a person is near";
    if (closing > motor_.recoil_speed && s.distance / closing < contact_time * factor_) {
      factor_ = s.distance / closing / contact_time;
      reason_ = "a person comes close";
    }
    const double reaction = partner ? 0.0 : motor_.recoil_time * closing;
    const bool closes_in =
        closing > motor_.recoil_speed && s.distance < motor_.avoid_stop + reaction;
    if (active.trajectory != 0 && active.rest.size() > 0) {
      constexpr double kSame = 2e-4, kFarther = 1e-3;  // [m]
      const double ahead = least_along(active, *w.people, exception, 1);
      if (closes_in && ahead < s.distance + kFarther) {
        leaves_path_ = least_along(active, *w.people, exception, -1) <= s.distance + kFarther;
        if (!leaves_path_) factor_ = motor_.recoil_factor;
        reason_ = "recoil: a person closes in";
      } else if (ahead > s.distance + (closing > motor_.recoil_speed ? kFarther : -kSame)) {
        factor_ = std::max(factor_, motor_.avoid_recede);
      }
    } else if (closes_in) {
      factor_ = motor_.recoil_factor;
      reason_ = "recoil: a person closes in on the resting arm";
    }
    return stimulus;
  }
  double person_distance() const override { return distance_; }
  bool released(const World&) const override { return near_; }
  double speed_factor() const override { return factor_; }
  bool leaves_path() const override { return leaves_path_; }
  const char* reason() const override { return reason_; }

 private:
  /// Returns the min distance along the running trajectory at two times ahead. The earlier one
  /// alone is not sufficient, because a jerk-limited trajectory hardly moves at its start and end.
  double least_along(const ActiveTrajectory& active, const HumanState& people,
                     const SeparationExemption& exception, int direction) {
    constexpr double kFirst = 0.15, kSecond = 0.4;  // times ahead [s]
    return std::min(distance_along(active, people, exception, direction * kFirst),
                    distance_along(active, people, exception, direction * kSecond));
  }
  double distance_along(const ActiveTrajectory& active, const HumanState& people,
                        const SeparationExemption& exception, double ahead) {
    sample_ = active.rest.at(active.time + ahead);
    posture_ = active.position;
    for (std::size_t i = 0; i < active.axes.size() && static_cast<int>(i) < active.rest.size(); ++i)
      if (active.axes[i] < posture_.size())
        posture_[active.axes[i]] = sample_.position[static_cast<Eigen::Index>(i)];
    return body_.separation_at(posture_, active.T_world_base, people, exception).distance;
  }

  const Body& body_;
  MotorSettings motor_;
  ZoneTracker zone_;
  bool near_{}, leaves_path_{};
  double distance_{}, factor_{1.0};
  const char* reason_{""};
  MotionState3 sample_;
  Vector posture_;
};

class Pick : public Schema {
 public:
  Pick(const Body& body, const MotorSettings& motor) : body_(body), motor_(motor) {}
  Behaviour kind() const override { return Behaviour::pick; }
  double perceive(const World& w, TimePoint) override {
    distance_ = kInfinity;
    if (!w.scene || !w.action || !robot_known(w, body_)) return kInfinity;
    for (const SceneObject& object : w.scene->objects) {
      if (object.id != w.action->object) continue;
      target_ = object.T_world_object.translation();
      distance_ = (target_ - body_.grasp_point(w.active->position, w.active->T_world_base)).norm();
    }
    return distance_;
  }
  bool released(const World& w) const override {
    return doing(w, ActionKind::pick) && !w.action->holding && std::isfinite(distance_);
  }
  double speed_factor() const override {
    return motor_.ease_factor +
           (1.0 - motor_.ease_factor) * ramp(distance_, 0.0, motor_.ease_distance);
  }
  const char* reason() const override { return "easing onto the object"; }
  std::optional<Vector3> gaze() const override {
    return std::isfinite(distance_) ? std::optional(target_) : std::nullopt;
  }

 private:
  const Body& body_;
  MotorSettings motor_;
  double distance_{kInfinity};
  Vector3 target_{Vector3::Zero()};
};

/// Detects a person whose hand approaches the object that the robot holds, and for how long.
class ReachWatch {
 public:
  explicit ReachWatch(const MotorSettings& motor)
      : near_(motor.reach_near), arrived_(motor.reach_arrived), hold_(motor.reach_hold) {}

  /// Returns the distance of the nearest reaching hand [m]; +inf: none.
  double observe(const World& w, const Vector3& p_held, TimePoint now) {
    double nearest = kInfinity;
    std::string nearest_person;
    if (w.people == nullptr) return nearest;
    for (const Person& person : w.people->people) {
      const double distance = nearest_hand(person, p_held).distance;
      if (distance > near_ || distance > nearest || !(reaches(w, person.id) || distance < arrived_))
        continue;
      nearest = distance;
      nearest_person = person.id;
    }
    if (nearest_person != person_) since_ = now;
    person_ = nearest_person;
    held_ = !nearest_person.empty() && now - since_ >= from_seconds(hold_);
    return nearest;
  }
  void forget() { person_.clear(), held_ = false; }
  std::optional<TaskWish> wish() const {
    return held_ ? std::optional(TaskWish{TaskChange::give, person_}) : std::nullopt;
  }

 private:
  static bool reaches(const World& w, const std::string& person) {
    return w.facts && std::any_of(w.facts->facts.begin(), w.facts->facts.end(), [&](const Fact& f) {
             return f.kind == FactKind::reaching && f.subject == person &&
                    f.object == w.action->object;
           });
  }

  double near_, arrived_, hold_;
  std::string person_;
  TimePoint since_{};
  bool held_{};
};

class Place : public Schema {
 public:
  Place(const Body& body, const MotorSettings& motor) : body_(body), motor_(motor), reach_(motor) {}
  Behaviour kind() const override { return Behaviour::place; }
  double perceive(const World& w, TimePoint now) override {
    height_ = kInfinity;
    if (!w.scene || !w.action || !robot_known(w, body_)) return kInfinity;
    const Vector3 p = body_.grasp_point(w.active->position, w.active->T_world_base);
    double hand = kInfinity;
    if (putting_down(w))
      hand = reach_.observe(w, p, now);
    else
      reach_.forget();
    for (const SceneBox& box : w.scene->boxes) {
      if (!box.supports) continue;
      const Vector3 local = box.T_world_box.inverse() * p;
      if (std::abs(local.x()) > 0.5 * box.size.x() || std::abs(local.y()) > 0.5 * box.size.y())
        continue;
      const double height = local.z() - 0.5 * box.size.z();
      if (height >= 0.0 && height < height_) {
        height_ = height;
        target_ = p - Vector3(0, 0, height);
      }
    }
    return std::min(height_, hand);
  }
  bool released(const World& w) const override { return putting_down(w) && std::isfinite(height_); }
  double speed_factor() const override {
    return motor_.ease_factor +
           (1.0 - motor_.ease_factor) * ramp(height_, 0.0, motor_.ease_distance);
  }
  const char* reason() const override { return "easing onto the support"; }
  std::optional<Vector3> gaze() const override {
    return std::isfinite(height_) ? std::optional(target_) : std::nullopt;
  }
  std::optional<TaskWish> wish() const override { return reach_.wish(); }

 private:
  static bool putting_down(const World& w) {
    return doing(w, ActionKind::place) && w.action->holding;
  }

  const Body& body_;
  MotorSettings motor_;
  ReachWatch reach_;
  double height_{kInfinity};
  Vector3 target_{Vector3::Zero()};
};

/// Base of GIVE and RECEIVE, which both observe the person's hand at the exchange point but differ
/// in the holder of the object.
class Exchange : public Schema {
 public:
  Exchange(Behaviour kind, const Body& body, const MotorSettings& motor)
      : kind_(kind), body_(body), motor_(motor) {}
  Behaviour kind() const override { return kind_; }
  double perceive(const World& w, TimePoint now) override {
    present_ = false;
    shift_.reset();
    if (!w.action || !robot_known(w, body_)) return kInfinity;
    const Vector3 p = body_.grasp_point(w.active->position, w.active->T_world_base);
    const Person* person = person_of_interest(w, p, motor_.lost_after);
    if (!person) return kInfinity;
    const NearHand hand = nearest_hand(*person, p);
    distance_ = hand.distance;
    present_ = distance_ < motor_.hand_near || attentive(w, person->id);
    const bool at_exchange = distance_ < motor_.hand_near;
    gaze_ = at_exchange ? hand.position : person->joints[body::head].position;
    shift_ = kind_ == Behaviour::give ? shift_of_give(w, *person, now) : shift_of_receive(w);
    if (shift_ && shift_->norm() > motor_.shift_limit)
      *shift_ *= motor_.shift_limit / shift_->norm();
    const double closing =
        distance_ > 1e-6 ? hand.velocity.dot((p - hand.position) / distance_) : 0.0;
    return urgency(distance_, closing, motor_.urgent_speed);
  }
  bool released(const World& w) const override {
    const bool holds = kind_ == Behaviour::give;
    return present_ && doing(w, holds ? ActionKind::give : ActionKind::receive) &&
           w.action->holding == holds;
  }
  double speed_factor() const override {
    return motor_.hand_factor +
           (1.0 - motor_.hand_factor) * ramp(distance_, 0.5 * motor_.hand_near, motor_.hand_near);
  }
  const char* reason() const override { return "the person's hand is at the exchange"; }
  std::optional<Vector3> gaze() const override {
    return present_ ? std::optional(gaze_) : std::nullopt;
  }
  std::optional<Vector3> target_shift() const override { return present_ ? shift_ : std::nullopt; }

 private:
  /// Returns the shift to the hand that the receiver has extended for `shift_hold`, unless a hand
  /// is at the object.
  std::optional<Vector3> shift_of_give(const World& w, const Person& person, TimePoint now) {
    const ActionPhase phase = w.action->phase;
    const Vector3 p_robot = body_.base_point(*w.active, Vector3::Zero());
    std::optional<Vector3> shift;
    if (doing(w, ActionKind::give) && distance_ >= motor_.hand_near &&
        (phase == ActionPhase::carry || phase == ActionPhase::offer))
      shift = shift_to_extended_hand(*w.action, person, p_robot, motor_);
    if (!shift) extended_since_.reset();
    if (shift && !extended_since_) extended_since_ = now;
    const bool held = shift && now - *extended_since_ >= from_seconds(motor_.shift_hold);
    return held ? shift : std::nullopt;
  }
  /// Returns the shift to the giver's predicted object position after `shift_lead`.
  std::optional<Vector3> shift_of_receive(const World& w) const {
    if (!doing(w, ActionKind::receive) || w.action->phase != ActionPhase::approach || !w.scene)
      return std::nullopt;
    for (const SceneObject& object : w.scene->objects) {
      if (object.id != w.action->object || object.holder != Holder::human) continue;
      Vector3 p_expected = object.T_world_object.translation();
      if (object.velocity.norm() > motor_.shift_speed)
        p_expected += motor_.shift_lead * object.velocity;
      return p_expected - w.action->exchange_point;
    }
    return std::nullopt;
  }

  Behaviour kind_;
  const Body& body_;
  MotorSettings motor_;
  bool present_{};
  double distance_{kInfinity};
  Vector3 gaze_{Vector3::Zero()};
  std::optional<Vector3> shift_;
  std::optional<TimePoint> extended_since_;
};

}  // namespace

std::unique_ptr<Schema> make_schema(Behaviour kind, const Body& body, const MotorSettings& motor,
                                    const ZoneSettings& zones, const WatchSettings& watch) {
  switch (kind) {
    case Behaviour::search:
      return std::make_unique<Search>(body, motor);
    case Behaviour::track:
      return std::make_unique<Track>(body, motor, zones);
    case Behaviour::avoid:
      return std::make_unique<Avoid>(body, motor, zones);
    case Behaviour::pick:
      return std::make_unique<Pick>(body, motor);
    case Behaviour::place:
      return std::make_unique<Place>(body, motor);
    case Behaviour::give:
    case Behaviour::receive:
      return std::make_unique<Exchange>(kind, body, motor);
    case Behaviour::watch:
      return std::make_unique<Watch>(body, motor, watch);
  }
  return nullptr;
}

}  // namespace handsel::attention
