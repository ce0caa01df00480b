// SPDX-License-Identifier: Apache-2.0
#include "sim/people/people.hpp"

#include <algorithm>

#include "common/model/object_surface.hpp"
#include "sim/people/person_parts.hpp"
#include "sim/physics/contacts.hpp"

namespace handsel::sim {

namespace {

// Max number of capsules of a person; the index of a touch is person * kMaxCapsules + capsule.
constexpr int kMaxCapsules = 100;

Pose capsule_pose(const Vector3& a, const Vector3& b) {
  return make_pose((a + b) / 2, Eigen::Quaterniond::FromTwoVectors(
                                    Vector3::UnitZ(),
                                    (b - a).norm() > 1e-9 ? Vector3(b - a) : Vector3(0, 0, 1)));
}

bool of_hand(BodyPart part, Side side) {
  return side == Side::left ? part == BodyPart::hand_left || part == BodyPart::forearm_left
                            : part == BodyPart::hand_right || part == BodyPart::forearm_right;
}

/// Returns the pose of a held object in the hand frame. `turn`: orientation of the object,
/// whose nearest part is then at the palm. `ahead`: distance of an unturned object [m].
Pose held_pose(const ObjectModel& model, const std::optional<Eigen::Quaterniond>& turn,
               double ahead) {
  constexpr double kMaxOffset = 0.4;     // first offset of a turned object's origin [m]
  constexpr double kOffsetStep = 0.002;  // decrement of the offset [m]
  if (!turn) return Pose(Eigen::Translation3d(ahead, 0, 0));
  double offset = kMaxOffset;
  const Vector3 palm_direction = turn->inverse() * Vector3::UnitX();
  while (offset > 0 && surface_distance(model, -offset * palm_direction) > kPalmDistance)
    offset -= kOffsetStep;
  return make_pose(Vector3(offset, 0, 0), *turn);
}

/// Returns the distance of the nearest end of a part from the object's surface [m].
double distance_of(const std::vector<HandPart>& parts, const ObjectModel& model,
                   const Pose& T_world_object) {
  double min_distance = std::numeric_limits<double>::infinity();
  const Pose T_object_world = T_world_object.inverse();
  for (const HandPart& part : parts) {
    for (const Vector3& p : {part.a, part.b})
      min_distance =
          std::min(min_distance, surface_distance(model, T_object_world * p) - part.radius);
  }
  return min_distance;
}

/// Returns how many hands of the robot hold an object.
std::size_t hands_on(int object, const std::vector<RobotHandState>& robot_hands) {
  return static_cast<std::size_t>(
      std::count_if(robot_hands.begin(), robot_hands.end(),
                    [object](const RobotHandState& hand) { return hand.gripped == object; }));
}

bool is_hand(BodyPart part) { return part == BodyPart::hand_left || part == BodyPart::hand_right; }
int hand_number(BodyPart part) { return part == BodyPart::hand_left ? 0 : 1; }

/// Returns whether a part is forearm or hand of an arm that takes part in the handover.
bool exchanges(const PersonModel& person, BodyPart part) {
  return (of_hand(part, Side::left) && person.takes_part(Side::left)) ||
         (of_hand(part, Side::right) && person.takes_part(Side::right));
}

}  // namespace

int object_index(const ObjectBodies& objects, const std::string& id) {
  const auto found = std::find_if(objects.begin(), objects.end(),
                                  [&](const ObjectBody& o) { return o.start().id == id; });
  return found == objects.end() ? -1 : static_cast<int>(found - objects.begin());
}

People::People(const SceneSetup& setup, const SimSettings& settings, ObjectBodies& objects,
               ShapeStore& shapes, btDynamicsWorld& world)
    : objects_(objects), world_(world), manners_(settings.manners) {
  people_.reserve(setup.people.size());
  for (const StartPerson& start : setup.people)
    build(start, settings, static_cast<int>(people_.size()), shapes);
}

People::~People() {
  for (Body& person : people_) {
    for (auto& collider : person.colliders) {
      if (collider) world_.removeRigidBody(collider.get());
    }
  }
}

void People::build(const StartPerson& start, const SimSettings& settings, int number,
                   ShapeStore& shapes) {
  PersonSettings person_settings = start.settings;
  person_settings.taking = settings.taking;
  person_settings.manners = settings.manners;
  Body person{PersonModel(person_settings),
              Grip(settings.person_grip),
              TwoHandHold(settings.person_two_hand_grip),
              std::nullopt,
              -1,
              object_index(objects_, start.fetches),
              false,
              {},
              {},
              {}};
  person.capsules = body_capsules(person.model.body());
  for (std::size_t c = 0; c < person.capsules.size(); ++c) {
    const BodyCapsule& capsule = person.capsules[c];
    const int code = number * kMaxCapsules + static_cast<int>(c);
    if (is_hand(capsule.part)) {
      const int hand = hand_number(capsule.part);
      person.hands[hand] =
          std::make_unique<PersonHand>(settings.person_hand, person.model.hand(hand),
                                       person.model.hand_shape(hand), world_, kPerson, kRobot);
      own(person.hands[hand]->body(), Owner::person, code);
      person.colliders.push_back(nullptr);
      continue;
    }
    btConvexShape* shape = shapes.convex(Capsule{capsule.radius, (capsule.b - capsule.a).norm()});
    btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, shape);
    info.m_startWorldTransform = to_bt(capsule_pose(capsule.a, capsule.b));
    info.m_friction = 0.6;
    auto body = std::make_unique<btRigidBody>(info);
    body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    body->setActivationState(DISABLE_DEACTIVATION);
    own(*body, Owner::person, code);
    world_.addRigidBody(body.get(), kPerson, kRobot);
    person.colliders.push_back(std::move(body));
  }
  if (!start.holds.empty()) {
    person.object = object_index(objects_, start.holds);
    ObjectBody& object = objects_[person.object];
    const Eigen::Quaterniond turn = start.hand_turn.value_or(Eigen::Quaterniond::Identity());
    const auto T_hand_object = person.model.hold_from_beginning(object.model(), turn);
    for (int s = 0; s < 2; ++s) person.hands[s]->place(person.model.hand(s));
    const Pose hand = person.hand().state().T_world_body;
    object.put(hand * T_hand_object.value_or(held_pose(object.model(), start.hand_turn,
                                                       manners_.giving_object_ahead)));
    if (person.model.uses_both_hands())
      person.both.hold(
          {person.hands[0]->state().T_world_body, person.hands[1]->state().T_world_body},
          object.state().T_world_body);
    else
      person.grip.hold(hand.inverse() * object.state().T_world_body);
  }
  people_.push_back(std::move(person));
}

void People::follow(const HumanObservation& seen) {
  for (Body& person : people_) {
    if (person.model.source() != seen.source || seen.people.empty()) continue;
    const auto named =
        std::find_if(seen.people.begin(), seen.people.end(),
                     [&](const ObservedPerson& p) { return p.body == person.model.id(); });
    person.model.follow(named == seen.people.end() ? seen.people.front() : *named);
  }
}

bool People::any_follows_source() const {
  return std::any_of(people_.begin(), people_.end(),
                     [](const Body& person) { return !person.model.source().empty(); });
}

void People::announce(Announcement announcement, const std::string& human,
                      const std::string& object) {
  for (Body& person : people_) {
    const bool is_about_it =
        person.object >= 0 && (object.empty() || objects_[person.object].start().id == object);
    const bool is_meant = is_about_it && (human.empty() || human == person.model.id());
    person.model.announce(is_meant ? announcement : Announcement::none);
  }
}

bool People::any_reacts_to_announcements() const {
  return std::any_of(people_.begin(), people_.end(),
                     [](const Body& person) { return person.model.reacts_to_announcements(); });
}

void People::move(double dt, const std::vector<RobotHandState>& robot_hands,
                  const std::vector<HandPart>& robot) {
  for (Body& person : people_) {
    observe(person, dt, robot_hands, robot);
    hold_or_release(person);
    pull(person, dt);
  }
}

/// Returns the robot hand relevant to a person: the hand that holds the person's object, else the
/// nearest to the object that the person holds, else a hand that holds any object, else the
/// nearest.
const RobotHandState& People::hand_for(const Body& person,
                                       const std::vector<RobotHandState>& robot_hands) const {
  const auto holds_same = [&](const RobotHandState& hand) {
    return hand.gripped >= 0 && hand.gripped == person.object;
  };
  const auto holds = [](const RobotHandState& hand) { return hand.gripped >= 0; };
  const bool is_holding = person.object >= 0 && person.holds();
  const BodyState at = is_holding ? objects_[person.object].state() : person.hand().state();
  const Vector3 p = at.T_world_body.translation();
  const auto is_nearer = [&p](const RobotHandState& a, const RobotHandState& b) {
    return (a.palm.T_world_body.translation() - p).norm() <
           (b.palm.T_world_body.translation() - p).norm();
  };
  auto found = std::find_if(robot_hands.begin(), robot_hands.end(), holds_same);
  if (found == robot_hands.end() && !is_holding)
    found = std::find_if(robot_hands.begin(), robot_hands.end(), holds);
  if (found == robot_hands.end())
    found = std::min_element(robot_hands.begin(), robot_hands.end(), is_nearer);
  return *found;
}

void People::observe(Body& person, double dt, const std::vector<RobotHandState>& robot_hands,
                     const std::vector<HandPart>& robot) {
  const RobotHandState& robot_hand = hand_for(person, robot_hands);
  const int gripped = robot_hand.gripped;
  PersonView view;
  view.robot = &robot;
  view.platform = platform_;
  view.robot_hand = robot_hand.palm.T_world_body.translation();
  if (!person.holds() && !person.model.wants_grip())
    person.object = person.fetches >= 0          ? person.fetches
                    : gripped >= 0               ? gripped
                    : person.model.in_handover() ? person.object
                                                 : -1;
  if (person.object >= 0) {
    const ObjectBody& object = objects_[person.object];
    view.object = &object.model();
    view.T_world_object = object.T_world_object();
    view.object_velocity = object.state().velocity;
    view.held_by_robot = gripped == person.object;
    view.held_firmly = view.held_by_robot && robot_hand.holds_firmly;
    // Who holds an object with both hands releases it to as many hands.
    if (person.both.holding())
      view.held_firmly =
          view.held_firmly && hands_on(person.object, robot_hands) >=
                                  std::min<std::size_t>(person.hands.size(), robot_hands.size());
    view.pressed_by_robot = robot_hand.pressed == person.object;
    feel(person, dt, view);
    view.p_hand_object =
        person.hand().state().T_world_body.inverse() * view.T_world_object.translation();
    if (person.model.needs_finger_distance())
      view.finger_distance = distance_of(robot_hand.fingers, object.model(), view.T_world_object);
  }
  for (int s = 0; s < 2; ++s) {
    view.hand_pushed[s] = person.hands[s]->state().T_world_body.translation() -
                          person.model.hand(s).T_world_body.translation();
  }
  view.grip_broke = person.broke;
  person.broke = false;
  const bool placed = person.model.placed();
  person.model.step(dt, view);
  if (!placed) return;
  for (int s = 0; s < 2; ++s) person.hands[s]->place(person.model.hand(s));
}

/// Writes the forces that a person feels on the object and in the arms. Of a load in both hands the
/// person expects the weight and, while drawing it back, the force that accelerates it; the person
/// feels what is beyond.
void People::feel(Body& person, double dt, PersonView& view) const {
  const ObjectBody& object = objects_[person.object];
  const double mass = object.model().mass;
  const Vector3 weight = mass * from_bt(world_.getGravity());
  if (!person.both.holding()) {
    person.velocities.reset();
    view.grip_force = person.grip.wrench().force;
    view.arm_force = person.hand().arm_force();
    if (person.grip.holding()) view.arm_force += weight;
    return;
  }
  const std::array<Vector3, 3> now{object.state().velocity, person.hands[0]->state().velocity,
                                   person.hands[1]->state().velocity};
  const std::array<Vector3, 3> before = person.velocities.value_or(now);
  person.velocities = now;
  view.grip_force = person.both.on_object().force;
  view.arm_force = person.hands[0]->arm_force() + person.hands[1]->arm_force() + weight;
  if (dt > 0 && person.model.phase() == PersonPhase::withdrawing) {
    const Vector3 of_load = mass / dt * (now[0] - before[0]);
    view.grip_force -= of_load;
    view.arm_force -= of_load;
    for (std::size_t s = 0; s < 2; ++s)
      view.arm_force -= person.hands[s]->mass() / dt * (now[s + 1] - before[s + 1]);
  }
  double& up = view.grip_force.z();
  up = up > 0 ? std::max(0.0, up + weight.z()) : up;
}

void People::hold_or_release(Body& person) {
  if (!person.model.wants_grip()) {
    person.grip.release();
    person.both.release();
  } else if (!person.holds() && !person.broke && person.object >= 0) {
    const double max_gap = kPalmDistance + manners_.taking_hold_gap;
    if (person.model.uses_both_hands() &&
        std::max(hand_gap(person, 0), hand_gap(person, 1)) < max_gap) {
      person.both.hold(
          {person.hands[0]->state().T_world_body, person.hands[1]->state().T_world_body},
          objects_[person.object].state().T_world_body);
    } else if (!person.model.uses_both_hands() && hand_gap(person) < max_gap) {
      person.grip.hold(person.hand().state().T_world_body.inverse() *
                       objects_[person.object].state().T_world_body);
    } else {
      person.broke = true;
    }
  }
}

void People::pull(Body& person, double dt) {
  const bool in_handover = person.model.in_handover();
  person.capsules = body_capsules(person.model.body());
  for (int s = 0; s < 2; ++s) {
    person.hands[s]->set_configuration(person.model.hand_configuration(s));
    person.hands[s]->pull_to(person.model.hand(s), dt);
  }
  for (std::size_t c = 0; c < person.colliders.size(); ++c) {
    const BodyCapsule& capsule = person.capsules[c];
    if (person.colliders[c])
      person.colliders[c]->setWorldTransform(to_bt(capsule_pose(capsule.a, capsule.b)));
    btRigidBody& body = person.colliders[c] ? *person.colliders[c]
                                            : person.hands[hand_number(capsule.part)]->body();
    const int flags = body.getCollisionFlags() & ~btCollisionObject::CF_NO_CONTACT_RESPONSE;
    const bool is_compliant =
        in_handover && exchanges(person.model, capsule.part) &&
        !(is_hand(capsule.part) && person.model.hand_configuration(hand_number(capsule.part)));
    body.setCollisionFlags(is_compliant ? flags | btCollisionObject::CF_NO_CONTACT_RESPONSE
                                        : flags);
  }
  if (person.both.holding()) return pull_with_both(person, dt);
  if (!person.grip.holding()) return;
  ObjectBody& object = objects_[person.object];
  if (person.model.phase() == PersonPhase::offering && person.model.p_hand_object_to_give())
    move_in_hand(person, *person.model.p_hand_object_to_give(), dt);
  const Wrench& w = person.grip.update(person.hand().state(), object.state(), object.model().mass,
                                       object.min_inertia(), dt);
  object.push(w);
  person.hand().push(object.state().T_world_body.translation(), {-w.force, -w.torque});
  person.broke = !person.grip.holding();
}

/// Applies the forces between both hands and the object.
void People::pull_with_both(Body& person, double dt) {
  ObjectBody& object = objects_[person.object];
  person.both.update({person.hands[0]->state(), person.hands[1]->state()}, object.state(),
                     object.model().mass, object.min_inertia(), dt);
  person.broke = !person.both.holding();
  object.push(person.both.on_object());
  for (int s = 0; s < 2; ++s)
    person.hands[s]->push(person.hands[s]->state().T_world_body.translation(),
                          person.both.on_hand(s));
}

/// Moves the held object in the hand, toward this position in the frame of the hand [m].
void People::move_in_hand(Body& person, const Vector3& p_hand_object, double dt) const {
  const ObjectBody& object = objects_[person.object];
  Pose T = person.grip.T_holder_object();
  const Pose T_body_object = object.state().T_world_body.inverse() * object.T_world_object();
  const Vector3 left = p_hand_object - (T * T_body_object).translation();
  T.translation() +=
      std::min(1.0, manners_.giving_shift_speed * dt / std::max(left.norm(), 1e-9)) * left;
  person.grip.set_T_holder_object(T);
}

double People::hand_gap(const Body& person) const {
  return hand_gap(person, person.model.side() == Side::left ? 0 : 1);
}

double People::hand_gap(const Body& person, int side) const {
  const ObjectBody& object = objects_[person.object];
  return surface_distance(
      object.model(),
      object.T_world_object().inverse() * person.hands[side]->state().T_world_body.translation());
}

bool People::grips(int object) const {
  return std::any_of(people_.begin(), people_.end(),
                     [&](const Body& p) { return p.holds() && p.object == object; });
}

int People::touching_person(int object) const {
  const auto found = std::find_if(people_.begin(), people_.end(), [&](const Body& p) {
    if (p.object != object || object < 0) return false;
    if (p.holds()) return true;
    const PersonPhase phase = p.model.phase();
    return (phase == PersonPhase::closing || phase == PersonPhase::reaching) &&
           hand_gap(p) < kPalmDistance + manners_.taking_touch_gap;
  });
  return found != people_.end() ? static_cast<int>(found - people_.begin()) : -1;
}

bool People::complies(int code) const {
  const Body& person = people_[code / kMaxCapsules];
  return person.model.in_handover() &&
         exchanges(person.model, person.capsules[code % kMaxCapsules].part);
}

bool People::has_digits(int code) const {
  const Body& person = people_[code / kMaxCapsules];
  const BodyPart part = person.capsules[code % kMaxCapsules].part;
  return is_hand(part) && person.model.hand_configuration(hand_number(part)).has_value();
}

const std::string& People::id(int code) const { return people_[code / kMaxCapsules].model.id(); }

void People::volumes(const std::vector<RobotHandState>& robot_hands,
                     std::vector<PersonVolume>& out) const {
  out.clear();
  for (const Body& person : people_) {
    const auto is_near_object = [&](const RobotHandState& hand) {
      return (hand.palm.T_world_body.translation() -
              objects_[person.object].state().T_world_body.translation())
                 .norm() < 0.35;
    };
    const bool exchanged = person.model.phase() == PersonPhase::keeping && person.object >= 0 &&
                           std::any_of(robot_hands.begin(), robot_hands.end(), is_near_object);
    out.push_back({&person.model.body(), person.model.in_handover() || exchanged,
                   person.model.side(), person.model.uses_both_hands()});
  }
}

}  // namespace handsel::sim
