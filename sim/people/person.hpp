// SPDX-License-Identifier: Apache-2.0
// Emulates a person: computes body, gaze and the commanded poses of the hands from what the person
// observes; forces may deflect the hands. Pure: time advances by step(). Own method: behaviour
// profiles vary the conditions of a handover.
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
#include "sim/people/guided_hand.hpp"
#include "sim/people/moving_offer.hpp"
#include "sim/people/person_settings.hpp"
#include "sim/people/second_hand.hpp"
#include "sim/people/step_in.hpp"
#include "sim/people/taking_hand.hpp"
#include "sim/physics/grip.hpp"
#include "sim/recordings/recording.hpp"

namespace handsel::sim {

enum class PersonKind { taker, still, walker, recording, giver, external, fetcher, partner };

/// The individual behaviour of one person.
struct BehaviourProfile {
  double speed_scale{1};  ///< speed of the hand divided by the default speed
  double hesitation{};    ///< duration of a stop midway on the first reach or offer [s]
  bool withdraws{};    ///< withdraws the hand once from the first reach or offer, then repeats the
                       ///< motion
  double look_away{};  ///< duration for which the gaze is averted once [s]
  double look_away_at{};              ///< time at which the gaze is averted [s]
  Vector3 sidestep{Vector3::Zero()};  ///< displacement of one sidestep, world [m]
  double sidestep_at{};               ///< time at which the sidestep begins [s]
  /// Raises the receiving hand in advance, while the robot holds the object.
  bool readies{};
  /// Time from which only the other hand receives objects [s]; infinity: never.
  double changes_hand_at{std::numeric_limits<double>::infinity()};
  /// The times of sidestep and change of hand count from the robot's first grasp of the object.
  bool from_carry{};
  bool seated{};  ///< the person sits and takes no steps
  bool early{};   ///< takes an object within reach before it is at rest
};

/// A fixed box.
struct Furniture {
  Pose T_world_box{Pose::Identity()};  ///< pose of the centre
  Vector3 size{Vector3::Zero()};       ///< full extents [m]
};

struct PersonSettings {
  std::string id;                      ///< unique in the scenario
  Vector3 feet{Vector3::Zero()};       ///< position on the floor, world [m]
  double yaw{};                        ///< direction of the body, 0 = +x [rad]
  double stature{1.75};                ///< body height [m]
  PersonKind kind{PersonKind::taker};  ///< behaviour
  double reaction{0.4};                ///< reaction time from an offer to the reach [s]
  double approach_from{};  ///< distance behind the place from which the person walks in [m]
  double pull{8.0};        ///< pull force of a receiver [N]
  bool left_handed{};      ///< prefers the left hand; a recording defines its own hand
  bool holds{};            ///< a partner starts with the object in the hand
  std::shared_ptr<const Recording> recording;  ///< motion to replay; null: none
  std::string external;  ///< source of observations that an external person follows
  /// Max distance at which an external person's hand is guided to an offered object [m].
  double correction{0.15};
  double fetches_at{};  ///< time from which a fetcher reaches for the object [s]
  /// Where a fetcher puts the object down: its origin, world [m]; nullopt: keeps the object.
  std::optional<Vector3> puts_at;
  StepInSettings steps_in;       ///< walk of an otherwise resting person toward the robot and back
  MovingOfferSettings moving;    ///< how a giver moves the offered object; duration 0: no motion
  BehaviourProfile behaviour{};  ///< individual behaviour
  std::vector<Furniture> furniture;  ///< held objects stay above these boxes
  FreeGraspSettings taking;          ///< choice of a place on an object that the robot holds
  PersonManners manners;             ///< as of all people
};

/// The person's observations, by sight and by touch.
struct PersonView {
  /// Position of the robot's mobile platform, world [m]; nullopt: the robot has none.
  std::optional<Vector3> platform{};
  Vector3 robot_hand{Vector3::Zero()};    ///< palm position, world [m]
  const ObjectModel* object{nullptr};     ///< object of the handover; nullptr: none
  Pose T_world_object{Pose::Identity()};  ///< pose of `object`
  /// Velocity of the object's centre of mass, world [m/s].
  Vector3 object_velocity{Vector3::Zero()};
  bool held_by_robot{};     ///< whether a hand of the robot holds `object`
  bool held_firmly{};       ///< whether the robot's grasp alone bears the object's weight
  bool pressed_by_robot{};  ///< whether a hand of the robot presses on `object`
  /// Left, right: displacement of the hand from its commanded position by forces, world [m].
  std::array<Vector3, 2> hand_pushed{Vector3::Zero(), Vector3::Zero()};
  bool grip_broke{};                    ///< the object slipped out of this person's hand
  Vector3 grip_force{Vector3::Zero()};  ///< force of this person's hand on the object, world [N]
  /// Force of the arm on the hand beyond the weight of what the hand holds, world [N].
  Vector3 arm_force{Vector3::Zero()};
  const std::vector<HandPart>* robot{nullptr};  ///< parts of the robot, world; nullptr: unobserved
  /// Distance of the robot's nearest finger from the surface of `object` [m].
  double finger_distance{std::numeric_limits<double>::infinity()};
  /// Position of `object` in the frame of the hand that holds it [m].
  Vector3 p_hand_object{Vector3::Zero()};
};

/// The robot's announcement to a partner about an object.
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
  leaving,
  guided,
  putting  ///< a fetcher puts the object down
};
const char* name(PersonPhase);  ///< Returns the name as in the enumeration.

class PersonModel {
 public:
  explicit PersonModel(const PersonSettings&);

  /// Advances by dt [s] (>= 0). The time of a frozen person stops, but forces still move the
  /// hands.
  void step(double dt, const PersonView&);
  /// Takes an observation of the body that an external person follows; all other people and frozen
  /// people ignore the observation.
  void follow(const ObservedPerson&);
  /// Stops (`on`) or continues all actions of the person.
  void freeze(bool on) { frozen_ = on; }
  /// Starts a fast motion of the hand toward the robot's hand, at `speed` [m/s].
  void dart(double speed);
  /// Starts a walk backward; a held object stays in the hand.
  void leave();
  /// Moves a hand toward `point`, world [m], within its reach, for `duration` [s] from now; then it
  /// goes back and the person continues. 0 s: it goes back now. A hand that exchanges an object
  /// continues with that; people who are frozen or follow a source ignore the call.
  void guide_hand(Side side, const Vector3& point, double duration);
  /// Averts the gaze for `duration` [s] from now.
  void look_away(double duration);
  /// Ends all reaching for objects and all offers.
  void refuse() { refusing_ = true; }
  /// Chooses how the person holds an object from the beginning, with both hands what needs them:
  /// the object's end toward the robot is left free, what is wide is held across. Returns the pose
  /// of the object in the frame of hand(), nullopt: the object has no place for the hands. `turn`:
  /// orientation of the object in this frame.
  std::optional<Pose> hold_from_beginning(const ObjectModel& object,
                                          const Eigen::Quaterniond& turn);
  /// Takes an announcement of the robot: a partner takes an object only if the robot offers it, and
  /// offers an object if the robot asks for it.
  void announce(Announcement announcement);

  /// Returns whether the person needs PersonView::finger_distance: a giver moves the offer.
  bool needs_finger_distance() const { return settings_.moving.duration > 0; }
  /// Returns the source followed; empty: none.
  const std::string& source() const { return settings_.external; }
  const std::string& id() const { return settings_.id; }  ///< unique in the scenario
  /// Returns whether announce() changes the behaviour now or later.
  bool reacts_to_announcements() const {
    return settings_.kind == PersonKind::partner || settings_.kind == PersonKind::giver;
  }
  PersonPhase phase() const { return phase_; }  ///< current phase
  const Person& body() const { return body_; }  ///< ground truth, velocities included
  Side side() const { return side_; }           ///< side of the handover hand
  /// Returns whether the handover hand is to hold the object.
  bool wants_grip() const { return wants_grip_; }
  /// Returns whether a handover is under way: from reach or offer until the object is withdrawn or
  /// the hand is back at rest. Always false for a fetcher, which fetches the object itself.
  bool in_handover() const;
  /// Returns whether the person offers the object at rest: from the end of the offering motion
  /// until the withdrawal.
  bool is_offering() const;
  /// Returns the commanded state of the handover hand; its axes turn with the body.
  const BodyState& hand() const { return hands_[hand_index()]; }
  /// Returns the commanded state; 0 left, 1 right.
  const BodyState& hand(int side) const { return hands_[side]; }
  /// Returns the configuration of a hand, 0 left, 1 right; nullopt: a fist.
  const std::optional<HandConfiguration>& hand_configuration(int side) const {
    return side == hand_index() ? hand_configuration_ : second_hand_.configuration();
  }
  /// Returns the configuration of the handover hand; nullopt: a fist.
  const std::optional<HandConfiguration>& hand_configuration() const { return hand_configuration_; }
  /// Returns whether the person takes or holds the object of the handover with both hands.
  bool uses_both_hands() const { return second_hand_.is_active(); }
  /// Returns whether a hand takes part in the handover: the handover hand, or each of both.
  bool takes_part(Side side) const { return side == side_ || uses_both_hands(); }
  /// Returns the shape of a hand; 0 left, 1 right.
  HumanHand hand_shape(int side) const;
  /// Returns where in the frame of hand() the person moves the held object, to leave a receiver
  /// room on it [m]; nullopt: the object stays where it is in the hand.
  const std::optional<Vector3>& p_hand_object_to_give() const { return p_hand_object_to_give_; }
  bool placed() const { return placed_; }  ///< the body was placed elsewhere without a motion
  double reach() const { return reach_; }  ///< shoulder to the centre of the hand [m]

 private:
  void place_body();
  void command_hands(double dt);
  void bend_arm(int side, const Vector3& target);
  void turn_gaze(const Vector3& target, double dt);
  void enter(PersonPhase);
  void run_phase(double dt, const PersonView&);
  /// Returns whether a walker would come too near to a mobile robot.
  bool waits_for_robot(const PersonView& view) const;
  /// Waits at rest, then turns back. `duration`: of the whole walk [s].
  void wait_for_robot(double dt, double duration);
  void watch(double dt, const PersonView&);
  void reach_out(double dt, const PersonView&);
  void replay(double dt, const PersonView&);
  void pull(double dt, const PersonView&);
  void withdraw(double dt, const PersonView&);
  void retract(double dt);
  void continue_dart(double dt, const PersonView&);
  void give_up();
  void end_keeping(const PersonView&);
  void walk_away();
  void begin_to_put(const PersonView&);
  void put_down();
  bool may_guide(Side side) const;
  bool leaves_handover_to_guide(Side side) const;
  Vector3 within_reach(int side, const Vector3& point) const;
  void move_guided_hands(double dt);
  void end_guide();
  void bend_guided_arms();
  void become_partner();
  void hold_object(const PersonView&);
  bool is_to_offer() const;
  void return_to_place();
  Vector3 step_to_place() const;
  Vector3 offer_from_shoulder(const PersonView&, const Vector3& step = Vector3::Zero()) const;
  void offer(double dt, const PersonView&);
  void turn_hand_back(double dt);
  void offer_in_motion(double dt, const PersonView&);
  void step_aside(double dt, const PersonView&);
  double reach_fraction() const;
  double reach_duration() const;
  Vector3 gaze_target(const PersonView&) const;
  void run_external_person(double dt, const PersonView&);
  void pull_toward(const Vector3& p_free_hand, double dt, const PersonView&);
  void release();
  bool is_offered_to(const PersonView&, int side) const;
  bool is_unavailable(const PersonView&) const;
  void choose_hand(const PersonView&);
  bool chooses_place() const;
  void choose_place(const PersonView&);
  Vector3 side_to_take(const PersonView&) const;
  FreeGraspQuery place_query(const ObjectModel&, const HumanArm&) const;
  FreeGraspQuery place_query_of_both(const PersonView&, const HumanArm&) const;
  bool needs_both_hands(const ObjectModel&) const;
  bool has_places(const PersonView&) const;
  Eigen::Quaterniond hand_at_rest(int side) const;
  void move_second_hand();
  std::optional<Vector3> choose_place_to_give(const ObjectModel&, const Eigen::Quaterniond& turn);
  std::optional<Pose> hold_with_both(const ObjectModel&, const Eigen::Quaterniond& turn);
  Vector3 middle_of_reach() const;
  void hold_to_give_back(const PersonView&);
  void hold_otherwise(const PersonView&);
  void repeat_offer(const PersonView&);
  bool is_robot_hand_far(const PersonView&) const;
  void remember_hold();
  bool gives_from_place() const;
  double lean_to_reach(const Vector3& p_hand) const;
  double lean_to_take(const Pose& T_world_hand, int side) const;
  double lean_to_places(const PersonView&) const;
  void begin_with_second_hand();
  double trunk() const;
  Vector3 by_leaning(double lean) const;
  Vector3 upright_shoulder(int side) const;
  void update_hand(double dt, const PersonView&);
  void raise_hand_in_advance(double dt, const PersonView&);
  bool has_changed_hands() const;
  Side preferred_side() const;
  double behaviour_time() const;
  Vector3 grasp_point(const PersonView&) const;
  Vector3 nearest_grasp_point(const PersonView&, const Vector3& from) const;
  Vector3 recorded_contact(const Vector3& feet) const;
  Vector3 shoulder(int side) const;
  Eigen::Quaterniond facing() const {
    return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_, Vector3::UnitZ()));
  }
  Vector3 forward() const { return {std::cos(yaw_), std::sin(yaw_), 0}; }
  Vector3 left() const { return {-std::sin(yaw_), std::cos(yaw_), 0}; }
  Vector3 object_centre(const PersonView& v) const { return v.T_world_object * v.object->com; }
  double hand_to_surface(const PersonView&, const Vector3& p_hand) const;
  double hand_to_surface(const PersonView& view) const {
    return hand_to_surface(view, hand_target_);
  }
  Vector3 carry_position() const;
  Vector3 rest_position() const { return rest_position(hand_index()); }
  Vector3 rest_position(int side) const;
  double height_above_furniture(const Vector3& hand) const;
  void keep_above_furniture(const Vector3& robot_hand);
  double extent_below_hand(const PersonView&) const;
  double phase_time() const { return clock_ - phase_since_; }
  Vector3 hand_point() const { return hands_[hand_index()].T_world_body.translation(); }
  int hand_index() const { return side_ == Side::left ? 0 : 1; }

  PersonSettings settings_;
  BodyPoints template_{}, points_{}, before_{};
  double reach_{};           // distance from the shoulder to the centre of the hand [m]
  double clock_{0};          // own time, which stops while frozen [s]
  double phase_since_{0};    // begin of the phase, by clock_ [s]
  double offer_time_{0};     // duration for which the robot has offered the object [s]
  double exit_time_{0};      // duration for which the condition that ends the phase has held [s]
  double overload_time_{0};  // duration for which the grip force has been too large [s]
  double cooldown_{0};       // time until the next reach is allowed [s]
  double playback_{0};       // time in the recording [s]
  double progress_{0};       // progress of a withdrawal, 0 to 1
  PersonPhase phase_{PersonPhase::watching};
  Side side_{Side::right};
  bool frozen_{false}, refusing_{false}, wants_grip_{false}, hand_active_{false}, first_{true},
      placed_{false};
  bool first_attempt_over_{false};  // whether the first reach or offer is over
  double sidestep_time_{0};         // time since the begin of the sidestep [s]
  // Time of the robot's first grasp of the object, by clock_ [s]; infinity: none so far.
  double carried_since_{std::numeric_limits<double>::infinity()};
  bool held_by_robot_before_{true};  // whether the robot held the object in the previous step
  // Where the robot grasped the object, world [m]; nullopt: unobserved.
  std::optional<Vector3> p_object_at_grasp_;
  double held_below_{0};      // extent of the held object below the hand [m]
  double raise_progress_{0};  // progress of raising the hand, 0 to 1
  double ignored_time_{0};    // duration for which the robot has ignored the offer [s]
  Announcement announcement_{Announcement::none};
  double announced_at_{0};  // by clock_ [s]
  int steps_nearer_{0};
  Vector3 p_shoulder_offer_{Vector3::Zero()}, home_aside_{Vector3::Zero()};
  Vector3 feet_{Vector3::Zero()}, home_{Vector3::Zero()}, aside_{Vector3::Zero()};
  double yaw_{}, lean_{0}, lean_from_{0}, lean_to_{0}, duration_{1}, speed_{0}, feet_speed_{0},
      walk_direction_{1}, waited_for_robot_{0};
  Vector3 hand_target_{Vector3::Zero()}, from_{Vector3::Zero()}, to_{Vector3::Zero()},
      side_of_object_{Vector3::UnitX()}, warp_{Vector3::Zero()}, step_{Vector3::Zero()};
  std::optional<FollowedBody> followed_;             // body of an external person
  std::array<std::optional<GuidedHand>, 2> guided_;  // hands dragged from outside
  std::optional<MovingOffer> moving_;                // motion of the offer; nullopt: not begun
  Vector3 p_hand_object_{Vector3::Zero()};           // the moved object in the hand frame [m]
  std::optional<Vector3> p_hand_object_to_give_;     // as p_hand_object_to_give()
  std::vector<Pose> held_in_vain_;                   // hand in the frame of the object offered
  TakingHand taking_;                                // place of the hand on an object that is taken
  std::optional<HandConfiguration> hand_configuration_;  // of the handover hand; nullopt: a fist
  SecondHand second_hand_;  // on an object that is taken with both hands
  // Orientation of the handover hand before a reach.
  Eigen::Quaterniond R_world_rest_{Eigen::Quaterniond::Identity()};
  double bend_{0};                            // how far the wrist bends as the hand needs, 0 to 1
  Vector3 retract_control_{Vector3::Zero()};  // control point of a retracting hand's curve [m]
  // Rotation of the handover hand from the neutral wrist configuration.
  Eigen::Quaterniond hand_turn_{Eigen::Quaterniond::Identity()};
  // Offset of the hand from its reported position, world [m].
  Vector3 hand_offset_{Vector3::Zero()};
  Vector3 gaze_{Vector3::UnitX()};
  Person body_;
  std::array<BodyState, 2> hands_;
};

}  // namespace handsel::sim
