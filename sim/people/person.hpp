// An emulated person: a body moved by what it sees, its hands wanted somewhere and pushed
// elsewhere. Pure: time comes in steps. Own method: the behaviours vary what the robot has to cope
// with.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/object_model.hpp"
#include "sim/people/followed_body.hpp"
#include "sim/people/moving_offer.hpp"
#include "sim/people/recording.hpp"
#include "sim/people/step_in.hpp"
#include "sim/physics/grip.hpp"

namespace handsel::sim {

enum class PersonKind { taker, still, walker, recording, giver, external, fetcher, partner };

/// What makes a person different from the next.
struct BehaviourProfile {
  double speed_scale{1};  ///< of the hand, times the usual
  double hesitation{};    ///< stops midway on the first reach or offer [s]
  bool withdraws{};    ///< withdraws the hand once from its first reach or offer, and comes again
  double look_away{};  ///< looks elsewhere once, so long [s] ...
  double look_away_at{};              ///< ... from this time on [s]
  Vector3 sidestep{Vector3::Zero()};  ///< walks so far [m] ...
  double sidestep_at{};               ///< ... from this time on [s]
  /// Raises the hand that will take while the robot has the object.
  bool readies{};
  /// Takes with the other hand only from this time on, the first is busy [s].
  double changes_hand_at{std::numeric_limits<double>::infinity()};
  /// The times of sidestep and change of hand count from when the robot has the object.
  bool from_carry{};
  bool seated{};  ///< sits, and takes no steps aside or back
  bool early{};   ///< takes what comes within reach while it still moves
};

/// A box that stands where it is.
struct Furniture {
  Pose T_world_box{Pose::Identity()};  ///< of its centre
  Vector3 size{Vector3::Zero()};       ///< full extents [m]
};

struct PersonSettings {
  std::string id;                      ///< unique in the scenario
  Vector3 feet{Vector3::Zero()};       ///< world [m]
  double yaw{};                        ///< facing, 0 = +x [rad]
  double stature{1.75};                ///< [m]
  PersonKind kind{PersonKind::taker};  ///< behaviour
  double reaction{0.4};                ///< from offer to reach [s]
  double approach_from{};              ///< walks in from this far behind its place [m]
  double pull{8.0};                    ///< when taking [N]
  bool left_handed{};                  ///< prefers the left hand; a recording has a hand of its own
  bool holds{};                        ///< a partner begins with its object in the hand
  std::shared_ptr<const Recording> recording;  ///< motion to play; null: none
  std::string external;                        ///< source of the body an external person follows
  /// An external person's hand closer than this to an offered object is led to it [m].
  double correction{0.15};
  double max_warp{0.10};             ///< a recorded hand is moved by no more than this [m]
  double warp_time{0.5};             ///< over the last part before contact [s]
  double fetches_at{};               ///< a fetcher reaches for its object from then on [s]
  StepInSettings steps_in;           ///< a person at rest otherwise comes from behind
  MovingOfferSettings moving;        ///< how a giver moves what is offered; duration 0: not at all
  BehaviourProfile behaviour{};      ///< what this person does differently
  std::vector<Furniture> furniture;  ///< what they hold is kept above it
};

/// What the person sees and feels.
struct PersonView {
  /// Where the platform of a robot that drives stands, world [m]; nullopt: the robot does not
  /// drive.
  std::optional<Vector3> platform{};
  Vector3 robot_hand{Vector3::Zero()};       ///< world [m]
  const ObjectModel* object{nullptr};        ///< the one the handover is about; nullptr: none
  Pose T_world_object{Pose::Identity()};     ///< of `object`
  Vector3 object_velocity{Vector3::Zero()};  ///< of its centre of mass, world [m/s]
  bool held_by_robot{};                      ///< `object` is in a hand of the robot
  bool held_firmly{};                        ///< and would not fall if nobody else held it
  /// Left, right: how far forces keep the hand from where it is wanted [m].
  std::array<Vector3, 2> hand_pushed{Vector3::Zero(), Vector3::Zero()};
  bool grip_broke{};                    ///< it slipped out of this person's hand
  Vector3 grip_force{Vector3::Zero()};  ///< that this person's hand exerts on the object [N]
  /// Of the robot's nearest finger from the surface of `object` [m].
  double finger_distance{std::numeric_limits<double>::infinity()};
  /// Of `object`, in the frame of the hand that holds it [m].
  Vector3 p_hand_object{Vector3::Zero()};
};

/// What a partner hears the robot say about an object.
enum class Announcement { none, offers, asks };

enum class PersonPhase {
  arriving,
  watching,
  reaching,
  closing,
  pulling,
  withdrawing,
  keeping,
  retracting,
  offering,
  darting,
  leaving
};
const char* name(PersonPhase);  ///< as in the enumeration

class PersonModel {
 public:
  explicit PersonModel(const PersonSettings&);

  /// Advances by dt [s] (>= 0). A frozen person's own time stops; its pushed hands still move.
  void step(double dt, const PersonView&);
  /// Takes where an external person is now, as reported from outside; other people and frozen ones
  /// ignore it.
  void follow(const ObservedPerson&);
  void freeze(bool on) { frozen_ = on; }  ///< on: the person no longer acts
  void dart(double speed);                ///< the hand moves fast toward the robot's hand [m/s]
  void leave();                           ///< walks 3 m backward, with what is in the hand
  void refuse() { refusing_ = true; }     ///< neither reaches for nor offers an object any more
  /// Tells a partner what the robot does: a partner takes only what is offered, and offers what the
  /// robot asks for.
  void announce(Announcement announcement);

  /// Whether a giver moves what is offered: the distance of the robot's fingers is needed.
  bool minds_fingers() const { return settings_.moving.duration > 0; }
  const std::string& source() const { return settings_.external; }  ///< followed; empty: none
  const std::string& id() const { return settings_.id; }            ///< unique in the scenario
  /// Whether announce() changes, now or later, what the person does.
  bool listens() const {
    return settings_.kind == PersonKind::partner || settings_.kind == PersonKind::giver;
  }
  PersonPhase phase() const { return phase_; }     ///< what the person does now
  const Person& body() const { return body_; }     ///< ground truth, velocities included
  Side side() const { return side_; }              ///< of the handover hand
  bool wants_grip() const { return wants_grip_; }  ///< whether that hand is to hold its object
  /// Whether a handover is under way: from reach or offer until the object is withdrawn or
  /// the hand is back. Never for a fetcher, which takes an object by itself.
  bool in_handover() const;
  /// Whether the person offers the object at rest: from the end of the motion until the withdrawal.
  bool is_offering() const;
  /// Where the handover hand is wanted; axes turn with the body.
  const BodyState& hand() const { return hands_[index()]; }
  const BodyState& hand(int side) const { return hands_[side]; }  ///< 0 left, 1 right
  bool placed() const { return placed_; }  ///< the next step takes it elsewhere without a motion
  double reach() const { return reach_; }  ///< shoulder to middle of the hand [m]
  static constexpr double kPalm = 0.03;    ///< middle of the hand to what it holds [m]

 private:
  void place_base();
  void want_hands(double dt);
  void bend_arm(int side, const Vector3& target);
  void look_at(const Vector3& target, double dt);
  void enter(PersonPhase);
  void act(double dt, const PersonView&);
  /// Returns whether someone walking would come too near to a robot that drives.
  bool waits_for_robot(const PersonView& view) const;
  /// Stands for a while, then turns back. `duration`: of the whole walk [s].
  void wait_for_robot(double dt, double duration);
  void watch(double dt, const PersonView&);
  void reach_out(double dt, const PersonView&);
  void play(double dt, const PersonView&);
  void pull(double dt, const PersonView&);
  void withdraw(double dt, const PersonView&);
  void retract(double dt);
  void dart_on(double dt, const PersonView&);
  void give_up();
  void take_part();
  void hold_back(const PersonView&);
  bool is_to_offer() const;
  void come_back();
  Vector3 step_to_place() const;
  Vector3 offer_from_shoulder(const PersonView&, const Vector3& step = Vector3::Zero()) const;
  void offer(double dt, const PersonView&);
  void turn_hand_back(double dt);
  void offer_in_motion(double dt, const PersonView&);
  void step_aside(double dt);
  double reach_fraction() const;
  double reach_time() const;
  Vector3 looked_at(const PersonView&) const;
  void accompany(double dt, const PersonView&);
  void pull_after(const Vector3& would_be, double dt, const PersonView&);
  void release();
  bool offered(const PersonView&, int side) const;
  bool out_of_hand(const PersonView&) const;
  void choose_hand(const PersonView&);
  void get_ready(double dt, const PersonView&);
  bool has_changed_hands() const;
  Side preferred_side() const;
  double behaviour_time() const;
  Vector3 grasp_point(const PersonView&) const;
  Vector3 nearest_hold(const PersonView&, const Vector3& from) const;
  Vector3 at_contact(const Vector3& feet) const;
  Vector3 shoulder(int side) const;
  Vector3 forward() const { return {std::cos(yaw_), std::sin(yaw_), 0}; }
  Vector3 left() const { return {-std::sin(yaw_), std::cos(yaw_), 0}; }
  Vector3 object_centre(const PersonView& v) const { return v.T_world_object * v.object->com; }
  double gap(const PersonView&) const;
  Vector3 keep_point() const;
  double height_above_furniture(const Vector3& hand) const;
  void keep_above_furniture(const Vector3& robot_hand);
  double below_hand(const PersonView&) const;
  double since() const { return clock_ - phase_since_; }
  Vector3 hand_point() const { return hands_[index()].T_world_body.translation(); }
  int index() const { return side_ == Side::left ? 0 : 1; }

  PersonSettings settings_;
  BodyPoints template_{}, points_{}, before_{};
  double reach_{}, clock_{0}, phase_since_{0}, offer_time_{0}, lost_time_{0}, sore_time_{0},
      cooldown_{0}, playback_{0}, progress_{0};
  PersonPhase phase_{PersonPhase::watching};
  Side side_{Side::right};
  bool frozen_{false}, refusing_{false}, wants_grip_{false}, hand_active_{false}, first_{true},
      placed_{false};
  bool came_once_{false};  // the first reach or offer is over
  double step_clock_{0};   // of the sidestep
  // When the robot first had the object, by the clock of the person [s]; infinity: not yet.
  double carried_since_{std::numeric_limits<double>::infinity()};
  bool seen_held_{true};              // the robot held the object in the step before
  std::optional<Vector3> p_gripped_;  // where it gripped the object; nullopt: not seen
  double held_below_{0};              // how far the held object extends below the hand [m]
  double ready_{0};                   // fraction of the time of raising the hand
  double ignored_{0};                 // the offer, so long [s]
  Announcement announcement_{Announcement::none};
  double announced_at_{0};  // by the clock of the person [s]
  int steps_nearer_{0};
  Vector3 p_shoulder_offer_{Vector3::Zero()}, home_aside_{Vector3::Zero()};
  Vector3 feet_{Vector3::Zero()}, home_{Vector3::Zero()}, aside_{Vector3::Zero()};
  double yaw_{}, lean_{0}, lean_from_{0}, lean_to_{0}, duration_{1}, speed_{0}, feet_speed_{0},
      walk_direction_{1}, waited_for_robot_{0};
  Vector3 hand_target_{Vector3::Zero()}, from_{Vector3::Zero()}, to_{Vector3::Zero()},
      side_of_object_{Vector3::UnitX()}, warp_{Vector3::Zero()}, step_{Vector3::Zero()};
  std::optional<FollowedBody> followed_;    // of an external person
  std::optional<MovingOffer> moving_;       // of a giver who keeps moving, once they offer
  Vector3 p_hand_object_{Vector3::Zero()};  // of what is moved, in the hand [m]
  // Of the handover hand from its middle configuration.
  Eigen::Quaterniond hand_turn_{Eigen::Quaterniond::Identity()};
  Vector3 led_{Vector3::Zero()};  // of its hand from where it is reported to be
  Vector3 gaze_{Vector3::UnitX()};
  Person body_;
  std::array<BodyState, 2> hands_;
};

}  // namespace handsel::sim
