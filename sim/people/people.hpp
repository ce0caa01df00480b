// People as bodies of the physics: kinematic capsules, free hands on springs, a grip on the object of the exchange.
#pragma once

#include <array>
#include <deque>
#include <memory>
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

class People {
 public:
  /// Who starts with an object in the hand has it put there.
  People(const SceneSetup&, const SimSettings&, ObjectBodies& objects, ShapeStore&, btDynamicsWorld&);
  ~People();
  People(const People&) = delete;
  People& operator=(const People&) = delete;

  std::size_t size() const { return people_.size(); }
  PersonModel& model(std::size_t i) { return people_.at(i).model; }
  const PersonModel& model(std::size_t i) const { return people_.at(i).model; }
  const std::vector<BodyCapsule>& capsules(std::size_t i) const { return people_[i].capsules; }

  /// Moves those who follow this source: the body named as they are, else the first seen.
  void follow(const HumanObservation&);
  bool follow_somebody() const;
  /// Decides, moves and holds for the coming step. `gripped`: the object in the robot's hand, -1: none.
  void move(double dt, const BodyState& robot_hand, int gripped);

  bool grips(int object) const;
  bool touches(int object) const;
  /// Whether a touched person is soft there now; `code` as in the index of a touch.
  bool yields(int code) const;
  const std::string& id(int code) const;  ///< of a touched person
  /// What the separation is measured to. The exchange lasts until the robot's hand has drawn back from the object it gave.
  void volumes(const Vector3& robot_hand, std::vector<PersonVolume>& out) const;

 private:
  struct Body {
    PersonModel model;
    Grip grip;
    int object{-1};  // number of the one the exchange is about, or it is after
    int fetches{-1};
    bool broke{false};
    std::vector<BodyCapsule> capsules;
    std::vector<std::unique_ptr<btRigidBody>> colliders;  // kinematic; none for a hand
    std::array<std::unique_ptr<PersonHand>, 2> hands;     // left, right

    PersonHand& hand() { return *hands[model.side() == Side::left ? 0 : 1]; }
    const PersonHand& hand() const { return *hands[model.side() == Side::left ? 0 : 1]; }
  };
  void build(const StartPerson&, const SimSettings&, int number, ShapeStore&);
  void look(Body&, double dt, const BodyState& robot_hand, int gripped);
  void hold_or_let_go(Body&);
  void pull(Body&, double dt);
  double hand_gap(const Body&) const;

  ObjectBodies& objects_;
  btDynamicsWorld& world_;
  std::vector<Body> people_;
};

}  // namespace handsel::sim
