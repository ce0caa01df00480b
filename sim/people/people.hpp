// People as bodies of the physics: kinematic capsules, free hands on springs, a grip on the object
// of the handover.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "sim/oracle/separation_oracle.hpp"
#include "sim/people/person.hpp"
#include "sim/people/person_hand.hpp"
#include "sim/physics/grip.hpp"
#include "sim/physics/object_body.hpp"
#include "sim/scene/settings.hpp"

namespace handsel::sim {

/// Objects keep their places: bodies are not moved in memory.
using ObjectBodies = std::deque<ObjectBody>;

/// The number of the object with that id; -1: none.
int object_index(const ObjectBodies& objects, const std::string& id);

/// A ball.
struct Ball {
  Vector3 p_world{Vector3::Zero()};  ///< of its middle [m]
  double radius{};                   ///< [m]
};

/// What people see of a hand of the robot.
struct RobotHandState {
  BodyState palm;             ///< world
  std::vector<Ball> fingers;  ///< ends of their links, while any person minds them
  int gripped{-1};            ///< object in the hand; -1: none
  bool holds_firmly{};        ///< with what grips that object, its weight could be borne
};

class People {
 public:
  /// Puts an object into the hand of each person that starts with one.
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

  /// Moves the people that follow this source: each to the body with its id, else to the first
  /// seen.
  void follow(const HumanObservation&);
  /// Tells the partners that the robot offers `object` to `human`, or asks for the object; empty:
  /// whoever, whatever.
  void announce(Announcement announcement, const std::string& human, const std::string& object);
  bool listen() const;           ///< whether the robot may say something to any of these people
  bool follow_somebody() const;  ///< whether any person follows a source outside
  /// Decides, moves and holds for the coming step. `robot_hands`: not empty.
  void move(double dt, const std::vector<RobotHandState>& robot_hands);
  /// Shows people where the platform of a robot that drives stands, world [m].
  void set_platform(const Vector3& p_world) { platform_ = p_world; }
  /// Returns whether any person minds how near the fingers of the robot are.
  bool mind_fingers() const;

  bool grips(int object) const;  ///< whether a person's hand holds the object
  /// Whether a person's hand holds the object or, reaching for it, is within 12 mm of contact.
  bool touches(int object) const { return toucher(object) >= 0; }
  /// Returns the number of the first person whose hand does so; -1: nobody's.
  int toucher(int object) const;
  /// Whether the touched part is forearm or hand of a handover, which yields; `code` as in the
  /// index of a touch.
  bool yields(int code) const;
  const std::string& id(int code) const;  ///< of a touched person
  /// Writes what the separation is measured to. Forearm and hand of a handover are exempt until
  /// every hand of the robot is 0.35 m from the object.
  void volumes(const std::vector<RobotHandState>& robot_hands,
               std::vector<PersonVolume>& out) const;

 private:
  struct Body {
    PersonModel model;
    Grip grip;
    int object{-1};  // number of the one the handover is about, or that is fetched
    int fetches{-1};
    bool broke{false};
    std::vector<BodyCapsule> capsules;
    std::vector<std::unique_ptr<btRigidBody>> colliders;  // kinematic; none for a hand
    std::array<std::unique_ptr<PersonHand>, 2> hands;     // left, right

    PersonHand& hand() { return *hands[model.side() == Side::left ? 0 : 1]; }
    const PersonHand& hand() const { return *hands[model.side() == Side::left ? 0 : 1]; }
  };
  void build(const StartPerson&, const SimSettings&, int number, ShapeStore&);
  const RobotHandState& hand_for(const Body&, const std::vector<RobotHandState>& robot_hands) const;
  void observe(Body&, double dt, const std::vector<RobotHandState>& robot_hands);
  void hold_or_release(Body&);
  void pull(Body&, double dt);
  double hand_gap(const Body&) const;

  ObjectBodies& objects_;
  btDynamicsWorld& world_;
  std::vector<Body> people_;
  std::optional<Vector3> platform_;  // of a robot that drives
};

}  // namespace handsel::sim
