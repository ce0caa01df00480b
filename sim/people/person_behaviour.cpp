// What makes people different: who offers, hesitates, changes their mind, looks away, steps aside.
#include <limits>

#include "sim/people/person.hpp"
#include "sim/people/person_parts.hpp"

namespace handsel::sim {

namespace {

constexpr double kPart = 0.6;   // each part of a reach with a stop takes this share of one without
constexpr double kLetGo = 0.5;  // who gives lets go once the robot has held on for so long [s]
constexpr double kComeNear = 0.35;   // the robot's hand, when who changes their mind does so [m]
constexpr double kReconsider = 2.0;  // before the second offer [s]
constexpr double kMoveTime = 1.0;    // to where a giver who keeps moving begins to do so [s]
// Such a giver holds the object this far out: share of the arm's length [1], before the shoulder
// [m].
constexpr double kMinOut = 0.6, kMaxOut = 0.95, kMinBefore = 0.4;
constexpr double kOffFingers = 0.35;  // ... and this far from the robot's palm [m]
constexpr double kOfferTime = 1.0;    // of the motion [s]
constexpr double kTurnBack = 0.5;    // time constant of a hand that turns back after the motion [s]
constexpr double kMostTurn = 0.6;    // of the offer out of the way ahead [rad]
constexpr double kBeforeHand = 0.5;  // from the robot's hand, where something is held out [m]
constexpr double kImpatience = 8.0;  // who is ignored for so long holds it out anew [s] ...
constexpr double kStepNearer = 0.12;  // ... and comes nearer by this [m] ...
constexpr int kMostSteps = 2;         // ... so often ...
constexpr double kBend = 0.01;  // ... where the arm need not bend for it by more than this [m]
// [m] What somebody holds passes furniture with the hand so far above it, up to so far beside it,
// and lower with every step away from there.
constexpr double kAbove = 0.12, kBeside = 0.12;
constexpr double kOverFurniture = 0.02;  // of the lowest point of what is held [m]
// Who waits for something raises a hand so long [s], to so far ahead of the shoulder and below it,
// over the stature: the forearm level.
constexpr double kReadyTime = 0.7, kReadyAhead = 0.18, kReadyBelow = 0.19;
// Who takes something draws it away from the robot's hand before it is lifted: within so long [s],
// and from so far off on [m].
constexpr double kLift = 1.2, kClearOfHand = 0.30, kOffHand = 0.15;

}  // namespace

/// Share of the way of a reach or an offer.
double PersonModel::reach_fraction() const {
  const double t = since(), part = kPart * duration_, stop = settings_.behaviour.hesitation;
  const bool wavers = !came_once_ && (stop > 0 || settings_.behaviour.withdraws);
  if (!wavers) return min_jerk(t / duration_);
  return t < part + stop ? kMidway * min_jerk(t / part)
                         : kMidway + (1 - kMidway) * min_jerk((t - part - stop) / part);
}

double PersonModel::reach_time() const {
  const bool wavers =
      !came_once_ && (settings_.behaviour.hesitation > 0 || settings_.behaviour.withdraws);
  return wavers ? 2 * kPart * duration_ + settings_.behaviour.hesitation : duration_;
}

bool PersonModel::is_offering() const {
  return phase_ == PersonPhase::offering && since() >= reach_time();
}

/// A giver offers unasked, a partner when the robot has asked for a reaction time.
bool PersonModel::is_to_offer() const {
  if (refusing_) return false;
  return settings_.kind == PersonKind::giver ||
         (announcement_ == Announcement::asks && clock_ - announced_at_ >= settings_.reaction);
}

void PersonModel::hold_back(const PersonView& view) {
  const double back = kOfferTime / settings_.behaviour.speed_scale;
  hand_target_ = from_ + min_jerk(since() / back) * (keep_point() - from_);
  if (!is_to_offer() || since() < duration_) return;
  from_ = hand_target_;
  home_ = feet_;
  duration_ = back;
  p_shoulder_offer_ = offer_from_shoulder(view);
  enter(PersonPhase::offering);
}

/// Returns the step that takes a partner back to its place, from where it went with what it took.
Vector3 PersonModel::step_to_place() const {
  return settings_.kind == PersonKind::partner ? Vector3(settings_.feet - home_)
                                               : Vector3(Vector3::Zero());
}

/// Comfortably toward the robot's hand, but not into it, after a step.
Vector3 PersonModel::offer_from_shoulder(const PersonView& view, const Vector3& step) const {
  const Vector3 root = shoulder(index()),
                to_hand = view.robot_hand - root - (home_ + step_to_place() - feet_) - step;
  Vector3 arm = comfortable_reach(body_, side_) - root;
  const double turn =
      std::remainder(std::atan2(to_hand.y(), to_hand.x()) - std::atan2(arm.y(), arm.x()), 2 * M_PI);
  arm = Eigen::AngleAxisd(std::clamp(turn, -kMostTurn, kMostTurn), Vector3::UnitZ()) * arm;
  const double too_near = kBeforeHand - (to_hand - arm).norm();
  if (too_near > 0) arm.head<2>() *= std::max(0.0, 1 - too_near / arm.head<2>().norm());
  return arm;
}

void PersonModel::come_back() {
  const Vector3 step = step_to_place();
  if (step.norm() > 0) feet_ = home_ + min_jerk(since() / step_time(step.norm())) * step;
}

/// Makes a giver who has given a partner: takes the object when it is handed back, and offers it at
/// rest when asked again.
void PersonModel::take_part() {
  if (settings_.kind == PersonKind::giver) settings_.kind = PersonKind::partner;
  settings_.moving = {};
}

void PersonModel::offer(double dt, const PersonView& view) {
  // Fingers that only touch the object could not bear it.
  lost_time_ = view.held_firmly ? lost_time_ + dt : 0;
  if (lost_time_ > kLetGo) {
    take_part();
    return give_up();
  }
  if (view.held_by_robot) return;
  if (settings_.moving.duration > 0) {
    offer_in_motion(dt, view);
    if (!moving_->is_over()) return;
  } else {
    come_back();
    turn_hand_back(dt);
    hand_target_ = from_ + reach_fraction() * (shoulder(index()) + p_shoulder_offer_ - from_);
  }
  const bool near =
      view.object != nullptr && (view.robot_hand - object_centre(view)).norm() < kComeNear;
  if (near || since() < duration_) ignored_ = 0;
  if ((ignored_ += dt) > kImpatience) {  // holds it out anew, nearer to where the robot's hand is
    ignored_ = 0;
    settings_.moving = {};
    from_ = hand_target_;
    home_ = feet_;
    const Vector3 step =
        kStepNearer *
        (view.robot_hand - points_[kTorso]).cwiseProduct(Vector3(1, 1, 0)).stableNormalized();
    p_shoulder_offer_ = offer_from_shoulder(view);
    const Vector3 nearer = offer_from_shoulder(view, step);
    // Nobody steps nearer only to bend the arm.
    const bool has_room = nearer.norm() > p_shoulder_offer_.norm() - kBend;
    const bool steps_nearer = has_room && !settings_.behaviour.seated && steps_nearer_ < kMostSteps;
    if (steps_nearer) p_shoulder_offer_ = nearer;
    if (steps_nearer) {
      ++steps_nearer_;
      settings_.behaviour.sidestep = step;
      home_aside_ = aside_;
      step_clock_ = 0;
      settings_.behaviour.sidestep_at = behaviour_time();
    }
    enter(PersonPhase::offering);
  }
  if (is_to_offer() && !(near && settings_.behaviour.withdraws && !came_once_)) return;
  came_once_ = true;
  from_ = hand_target_;
  duration_ = kReconsider;
  enter(PersonPhase::keeping);
}

/// Turns the hand back to the middle configuration of the wrist.
void PersonModel::turn_hand_back(double dt) {
  if (hand_turn_.w() < 1)
    hand_turn_ = hand_turn_.slerp(std::min(1.0, dt / kTurnBack), Eigen::Quaterniond::Identity());
}

/// Leads the hand to where the motion begins, then along it. The object turns about itself, so that
/// the hand goes around it.
void PersonModel::offer_in_motion(double dt, const PersonView& view) {
  const Eigen::Quaterniond facing(Eigen::AngleAxisd(yaw_, Vector3::UnitZ()));
  if (!moving_) {
    const ArmReach reach{shoulder(index()), forward(),
                         kMinOut * reach_,  kMaxOut * reach_,
                         kMinBefore,        view.robot_hand - facing * view.p_hand_object,
                         kOffFingers};
    // The boxes are of the object; in reach is the hand, in the middle posture of the wrist.
    MovingOfferSettings of_hand = settings_.moving;
    p_hand_object_ = view.p_hand_object;
    const Vector3 ahead = facing * p_hand_object_;
    for (Vector3* corner :
         {&of_hand.start_low, &of_hand.start_high, &of_hand.next_low, &of_hand.next_high})
      *corner -= ahead;
    moving_.emplace(of_hand, reach, shoulder(index()) + p_shoulder_offer_);
  }
  const bool waits = view.finger_distance < settings_.moving.waits_within;
  if (waits && since() < kMoveTime) phase_since_ += dt;
  const double s = min_jerk(since() / kMoveTime);
  if (s >= 1) moving_->step(dt, waits);
  hand_turn_ = Eigen::Quaterniond::Identity().slerp(s, moving_->turn());
  const Vector3 turned = facing * (p_hand_object_ - hand_turn_ * p_hand_object_);
  hand_target_ = from_ + s * (moving_->position() + turned - from_);
}

/// Returns the time that sidestep and change of hand are counted in [s].
double PersonModel::behaviour_time() const {
  return settings_.behaviour.from_carry ? clock_ - carried_since_ : clock_;
}

bool PersonModel::has_changed_hands() const {
  return behaviour_time() >= settings_.behaviour.changes_hand_at;
}

Side PersonModel::preferred_side() const {
  const Side usual = settings_.left_handed ? Side::left : Side::right;
  return has_changed_hands() ? other_side(usual) : usual;
}

/// Raises the preferred hand before the body while the robot has the object, or the other one where
/// the preferred does not reach and that one is free. A hand that was raised is lowered first.
void PersonModel::get_ready(double dt, const PersonView& view) {
  Side wanted = preferred_side();
  const bool is_carried = view.object != nullptr && view.held_by_robot;
  if (is_carried && !has_changed_hands() && !offered(view, wanted == Side::left ? 0 : 1) &&
      offered(view, wanted == Side::left ? 1 : 0))
    wanted = other_side(wanted);
  const bool is_raised = is_carried && side_ == wanted && !refusing_;
  ready_ = std::clamp(ready_ + (is_raised ? dt : -dt) / kReadyTime, 0.0, 1.0);
  hand_active_ = ready_ > 0;
  if (!hand_active_) side_ = wanted;
  const Vector3 rest =
      feet_ + aside_ + Eigen::AngleAxisd(yaw_, Vector3::UnitZ()) * template_[kHand[index()]];
  const Vector3 raised = shoulder(index()) +
                         settings_.stature * (kReadyAhead * forward() - Vector3(0, 0, kReadyBelow));
  hand_target_ = rest + min_jerk(ready_) * (raised - rest);
}

/// Not while both have hold of the object, or reach for it.
void PersonModel::step_aside(double dt) {
  const double length = settings_.behaviour.sidestep.norm();
  if (length <= 0) return;
  const bool free = phase_ == PersonPhase::watching || phase_ == PersonPhase::keeping ||
                    (phase_ == PersonPhase::offering && lost_time_ <= 0);
  const double duration = step_time(length);
  const bool under_way = step_clock_ > 0 && step_clock_ < duration;
  if (behaviour_time() < settings_.behaviour.sidestep_at || !(free || under_way)) return;
  step_clock_ += dt;
  aside_ = home_aside_ + min_jerk(step_clock_ / duration) * settings_.behaviour.sidestep;
}

/// The least height of a hand that holds something, there [m].
double PersonModel::height_above_furniture(const Vector3& hand) const {
  double least = -std::numeric_limits<double>::infinity();
  for (const Furniture& box : settings_.furniture) {
    const Vector3 p = box.T_world_box.inverse() * hand, half = box.size / 2;
    const double up = (box.T_world_box.linear().row(2).transpose().cwiseAbs()).dot(half),
                 z = box.T_world_box.translation().z();
    if (hand.z() < z - up) continue;  // it hangs over them
    const double beside = (p.cwiseAbs() - half).cwiseMax(0).head<2>().norm();
    const double above = std::max(kAbove, held_below_ + kOverFurniture);
    least = std::max(least, z + up + above - std::max(0.0, beside - kBeside));
  }
  return least;
}

/// Only what nobody else has hold of.
void PersonModel::keep_above_furniture(const Vector3& robot_hand) {
  const bool alone = phase_ == PersonPhase::withdrawing || phase_ == PersonPhase::keeping ||
                     phase_ == PersonPhase::leaving ||
                     (phase_ == PersonPhase::offering && lost_time_ <= 0);
  if (!alone) return;
  const double away = ((hand_target_ - robot_hand).norm() - kClearOfHand) / kOffHand;
  const double share = phase_ == PersonPhase::withdrawing
                           ? std::min(min_jerk(since() / kLift), min_jerk(away))
                           : 1.0;
  const double least = height_above_furniture(hand_target_);
  hand_target_.z() += share * std::max(0.0, least - hand_target_.z());
  // Nobody presses what they hold down on furniture.
  if (phase_ == PersonPhase::withdrawing)
    hand_target_.z() = std::max(hand_target_.z(), std::min(least, before_[kHand[index()]].z()));
}

/// Returns how far the object extends below the hand [m].
double PersonModel::below_hand(const PersonView& view) const {
  if (view.object == nullptr) return 0;
  double lowest = hand_target_.z();
  for (const Vector3& p : view.object->mesh.vertices)
    lowest = std::min(lowest, (view.T_world_object * p).z());
  return hand_target_.z() - lowest;
}

Vector3 PersonModel::looked_at(const PersonView& view) const {
  if (refusing_ || phase_ == PersonPhase::leaving || settings_.kind == PersonKind::walker)
    return points_[kHead] + forward();
  const BehaviourProfile& behaviour = settings_.behaviour;
  if (clock_ >= behaviour.look_away_at && clock_ < behaviour.look_away_at + behaviour.look_away)
    return points_[kHead] + left() + 0.3 * forward();
  const bool interesting = view.object != nullptr && (view.held_by_robot || wants_grip_ ||
                                                      settings_.kind == PersonKind::fetcher);
  return interesting ? object_centre(view) : view.robot_hand;
}

}  // namespace handsel::sim
