// SPDX-License-Identifier: Apache-2.0
// People as bodies of the physics world: kinematic capsules, free hands on springs, and a grip on
// the object of the handover.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "sim/oracle/separation_oracle.hpp"
#include "sim/people/person.hpp"
#include "sim/people/person_hand.hpp"
#include "sim/people/two_hand_hold.hpp"
#include "sim/physics/grip.hpp"
#include "sim/physics/object_body.hpp"
#include "sim/scene/settings.hpp"

namespace handsel::sim {

/// Objects of the scene; their addresses never change.
using ObjectBodies = std::deque<ObjectBody>;

/// Returns the index of the object with this id; -1: none.
int object_index(const ObjectBodies& objects, const std::string& id);

/// The state of a robot hand as people observe it.
struct RobotHandState {
  BodyState palm;                 ///< state of the palm, world
  std::vector<HandPart> fingers;  ///< parts of the finger links, world
  int gripped{-1};                ///< index of the held object; -1: none
  bool holds_firmly{};            ///< whether all hands on that object can bear its weight
  int pressed{-1};                ///< index of the object that the hand presses on; -1: none
};

class People {
 public:
  /// Places an object in the hand of each person that starts with one.
  People(const SceneSetup&, const SimSettings&, ObjectBodies& objects, ShapeStore&,
         btDynamicsWorld&);
  ~People();
  People(const People&) = delete;
  People& operator=(const People&) = delete;

  std::size_t size() const { return people_.size(); }  ///< number of people
  /// Returns a person in the order of the scene. Throws std::out_of_range.
  PersonModel& model(std::size_t i) { return people_.at(i).model; }
  /// Returns a person in the order of the scene. Throws std::out_of_range.
  const PersonModel& model(std::size_t i) const { return people_.at(i).model; }
  /// Returns a person's capsules as of the last move(), world frame; no check of the index.
  const std::vector<BodyCapsule>& capsules(std::size_t i) const { return people_[i].capsules; }

  /// Moves the people that follow this source: each to the body with the person's id, else to the
  /// first observed body.
  void follow(const HumanObservation&);
  /// Announces to the partners that the robot offers `object` to `human`, or asks for the object;
  /// an empty text stands for any.
  void announce(Announcement announcement, const std::string& human, const std::string& object);
  /// Returns whether any person reacts to announcements.
  bool any_reacts_to_announcements() const;
  /// Returns whether any person follows observations from outside.
  bool any_follows_source() const;
  /// Advances decisions, motions and grips of all people by dt [s]. `robot_hands`: not empty.
  /// `robot`: parts of all links of the robot, world.
  void move(double dt, const std::vector<RobotHandState>& robot_hands,
            const std::vector<HandPart>& robot);
  /// Sets the position of the robot's mobile platform, world [m].
  void set_platform(const Vector3& p_world) { platform_ = p_world; }
  bool grips(int object) const;  ///< Returns whether a person's hand holds the object.
  /// Returns whether a person's hand holds the object, or reaches for the object and nearly
  /// touches it (taking_touch_gap).
  bool touches(int object) const { return touching_person(object) >= 0; }
  /// Returns the index of the first person for whom touches() holds; -1: none.
  int touching_person(int object) const;
  /// Returns whether the touched part is the forearm or hand of a handover, which complies with
  /// contact; `code` as in the index of a touch.
  bool complies(int code) const;
  /// Returns whether the touched part is a hand with palm and digits.
  bool has_digits(int code) const;
  const std::string& id(int code) const;  ///< Returns the id of a touched person.
  /// Writes the volumes to which the separation is measured. Forearm and hand of a handover are
  /// exempt until every hand of the robot is 0.35 m from the object.
  void volumes(const std::vector<RobotHandState>& robot_hands,
               std::vector<PersonVolume>& out) const;

 private:
  struct Body {
    PersonModel model;
    Grip grip;         // of the handover hand
    TwoHandHold both;  // of both hands, in place of `grip`
    // Velocity of the object in both hands and of each hand, world [m/s]; nullopt: not held so.
    std::optional<std::array<Vector3, 3>> velocities;
    int object{-1};  // index of the object of the handover, or of the fetched object
    int fetches{-1};
    bool broke{false};
    std::vector<BodyCapsule> capsules;
    std::vector<std::unique_ptr<btRigidBody>> colliders;  // kinematic; nullptr for a hand
    std::array<std::unique_ptr<PersonHand>, 2> hands;     // left, right

    PersonHand& hand() { return *hands[model.side() == Side::left ? 0 : 1]; }
    const PersonHand& hand() const { return *hands[model.side() == Side::left ? 0 : 1]; }
    bool holds() const { return grip.holding() || both.holding(); }
  };
  void build(const StartPerson&, const SimSettings&, int number, ShapeStore&);
  const RobotHandState& hand_for(const Body&, const std::vector<RobotHandState>& robot_hands) const;
  void observe(Body&, double dt, const std::vector<RobotHandState>& robot_hands,
               const std::vector<HandPart>& robot);
  void hold_or_release(Body&);
  void pull(Body&, double dt);
  void pull_with_both(Body&, double dt);
  void feel(Body&, double dt, PersonView&) const;
  void move_in_hand(Body&, const Vector3& p_hand_object, double dt) const;
  double hand_gap(const Body&) const;
  double hand_gap(const Body&, int side) const;

  ObjectBodies& objects_;
  btDynamicsWorld& world_;
  PersonManners manners_;
  std::vector<Body> people_;
  std::optional<Vector3> platform_;  // of a mobile robot
};

}  // namespace handsel::sim
