#include "sim/world.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

#include "common/model/robot_capsules.hpp"
#include "sim/contacts.hpp"
#include "sim/handover_oracle.hpp"
#include "sim/limits_oracle.hpp"
#include "sim/object_surface.hpp"
#include "sim/person_hand.hpp"
#include "sim/robot_grasp.hpp"

namespace handsel::sim {

namespace {

constexpr double kReach = 0.001;         // contacts closer than this touch [m]
constexpr double kCollisionForce = 0.5;  // [N]
constexpr double kFloorHeight = 0.02;    // an object's origin lower than this lies on the floor [m]

struct ObjectBody {
  StartObject start;
  std::unique_ptr<btRigidBody> body;
  double least_inertia{};
  Pose T_world_object{Pose::Identity()};
  BodyState state;  // of the centre of mass
};

struct PersonBody {
  PersonModel model;
  Grip grip;
  int object{-1};  // index of the one the exchange is about
  bool broke{false};
  std::vector<BodyCapsule> capsules;
  std::vector<std::unique_ptr<btRigidBody>> colliders;  // kinematic; none for a hand
  std::array<std::unique_ptr<PersonHand>, 2> hands;     // left, right

  PersonHand& hand() { return *hands[model.side() == Side::left ? 0 : 1]; }
  const PersonHand& hand() const { return *hands[model.side() == Side::left ? 0 : 1]; }
};

struct Hash {
  std::uint64_t value{0xcbf29ce484222325ULL};
  void add(double x) {
    value ^= std::bit_cast<std::uint64_t>(x);
    value *= 0x100000001b3ULL;
    value ^= value >> 29;
  }
  template <class V>
  void add_all(const V& v) {
    for (Eigen::Index i = 0; i < v.size(); ++i) add(v[i]);
  }
};

Pose along(const Vector3& a, const Vector3& b) {
  return make_pose((a + b) / 2,
                   Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), (b - a).norm() > 1e-9 ? Vector3(b - a) : Vector3(0, 0, 1)));
}

bool of_hand(BodyPart part, Side side) {
  return side == Side::left ? part == BodyPart::hand_left || part == BodyPart::forearm_left
                            : part == BodyPart::hand_right || part == BodyPart::forearm_right;
}

}  // namespace

struct SimWorld::Impl {
  Impl(const RobotModel& robot_model, const ObjectLibrary& library, const config::Scenario& scenario, const SimSettings& s,
       std::uint64_t seed)
      : model(robot_model),
        settings(s),
        setup(set_up(scenario, robot_model, library, s.coverage, s.data_root, seed)),
        random(seed ^ 0x5e45'0f'f0'1ceULL),
        dispatcher(&configuration),
        dynamics(&dispatcher, &broadphase, &solver, &configuration),
        side(robot_model, setup.start, side_settings()),
        limits(robot_model, s.robot_side.max_gap, s.setpoint_period),
        separations(robot_model, s.ssm) {
    settings.constraint = settings.constraint && !setup.no_weld;
    dynamics.setGravity(btVector3(0, 0, -9.81));
    dynamics.getSolverInfo().m_numIterations = settings.solver_iterations;
    dynamics.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;  // with one, a contact slides freely across it
    build_fixed();
    robot = std::make_unique<RobotBody>(model, setup.T_world_base, setup.start, settings.servo, settings.pad, dynamics, shapes, kRobot,
                                        kObject | kFixed | kPerson);
    for (int i = 0; i < robot->bodies(); ++i) {
      btMultiBodyLinkCollider* collider = robot->collider(i);
      if (collider == nullptr) continue;
      own(*collider, Owner::robot, i);
      collider->setContactProcessingThreshold(kReach);
    }
    grasp = std::make_unique<RobotGrasp>(model, *robot, settings.touch_force, settings.grasp_time, settings.lose_time);
    robot_grip = Grip(settings.robot_grip);
    build_objects();
    build_people();
    prepare_sight();
    std::uint64_t salt = seed;
    for (const SensorSettings& sensor : setup.human_sensors) human_sensors.emplace_back(sensor, salt += 0x1000193);
    for (const SensorSettings& sensor : setup.object_sensors) object_sensors.emplace_back(sensor, salt += 0x1000193);
    watched = object_index(setup.watched);
    if (watched >= 0) handover = std::make_unique<HandoverOracle>(objects[watched].state.T_world_body.translation().z());
    external = filtered_external = Vector::Zero(model.dof());
    ssm_every = std::max(1, static_cast<int>(std::lround(0.01 / settings.step)));
  }

  ~Impl() {
    robot.reset();
    for (ObjectBody& object : objects) dynamics.removeRigidBody(object.body.get());
    for (PersonBody& person : people) {
      for (auto& collider : person.colliders) {
        if (collider) dynamics.removeRigidBody(collider.get());
      }
    }
    people.clear();
    for (auto& object : fixed) dynamics.removeCollisionObject(object.get());
  }

  RobotSideSettings side_settings() const {
    RobotSideSettings s = settings.robot_side;
    s.never_releases = setup.never_releases;
    return s;
  }

  double now() const { return static_cast<double>(steps) * settings.step; }

  int object_index(const std::string& id) const {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (objects[i].start.id == id) return static_cast<int>(i);
    }
    return -1;
  }

  void add_fixed(btCollisionShape* shape, const Pose& T, Owner owner, int index) {
    auto object = std::make_unique<btCollisionObject>();
    object->setCollisionShape(shape);
    object->setWorldTransform(to_bt(T));
    object->setFriction(0.8);
    own(*object, owner, index);
    dynamics.addCollisionObject(object.get(), kFixed, kRobot | kObject);
    fixed.push_back(std::move(object));
  }

  void build_fixed() {
    add_fixed(&floor, Pose::Identity(), Owner::floor, 0);
    for (std::size_t i = 0; i < setup.boxes.size(); ++i) {
      add_fixed(shapes.convex(Box{setup.boxes[i].size}), setup.boxes[i].T_world_box, Owner::fixed, static_cast<int>(i));
    }
  }

  void build_objects() {
    for (const StartObject& start : setup.objects) {
      ObjectBody object;
      object.start = start;
      Pose T_com_object = Pose::Identity();
      T_com_object.translation() = -start.model->com;
      btCollisionShape* shape = shapes.combine(start.model->parts, T_com_object);
      if (shape == nullptr) throw ConfigError("object " + start.id + " of model " + start.model_name + " has no parts to collide with");
      btVector3 inertia(0, 0, 0);
      shape->calculateLocalInertia(start.model->mass, inertia);
      btRigidBody::btRigidBodyConstructionInfo info(start.model->mass, nullptr, shape, inertia);
      info.m_startWorldTransform = to_bt(Pose(start.T_world_object * T_com_object.inverse()));
      info.m_friction = start.model->friction;
      info.m_rollingFriction = 0;
      info.m_linearDamping = 0;
      info.m_angularDamping = 0.02;
      object.body = std::make_unique<btRigidBody>(info);
      object.body->setActivationState(DISABLE_DEACTIVATION);
      object.least_inertia = std::min({inertia.x(), inertia.y(), inertia.z()});
      own(*object.body, Owner::object, static_cast<int>(objects.size()));
      dynamics.addRigidBody(object.body.get(), kObject, kRobot | kFixed | kObject);
      objects.push_back(std::move(object));
      read_object(objects.back());
    }
  }

  void build_people() {
    for (std::size_t p = 0; p < setup.people.size(); ++p) {
      PersonBody person{PersonModel(setup.people[p].settings), Grip(settings.person_grip), -1, false, {}, {}, {}};
      person.capsules = body_capsules(person.model.body());
      for (std::size_t c = 0; c < person.capsules.size(); ++c) {
        const BodyCapsule& capsule = person.capsules[c];
        if (capsule.part == BodyPart::hand_left || capsule.part == BodyPart::hand_right) {
          const int hand = capsule.part == BodyPart::hand_left ? 0 : 1;
          person.hands[hand] = std::make_unique<PersonHand>(settings.person_hand, person.model.hand(hand), dynamics, kPerson, kRobot);
          own(person.hands[hand]->body(), Owner::person, static_cast<int>(p * 100 + c));
          person.colliders.push_back(nullptr);
          continue;
        }
        btConvexShape* shape = shapes.convex(Capsule{capsule.radius, (capsule.b - capsule.a).norm()});
        btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, shape);
        info.m_startWorldTransform = to_bt(along(capsule.a, capsule.b));
        info.m_friction = 0.6;
        auto body = std::make_unique<btRigidBody>(info);
        body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
        body->setActivationState(DISABLE_DEACTIVATION);
        own(*body, Owner::person, static_cast<int>(p * 100 + c));
        dynamics.addRigidBody(body.get(), kPerson, kRobot);
        person.colliders.push_back(std::move(body));
      }
      if (!setup.people[p].holds.empty()) {
        person.object = object_index(setup.people[p].holds);
        ObjectBody& object = objects[person.object];
        const double beside = PersonModel::kPalm + 0.05;
        const Pose hand = person.hand().state().T_world_body;
        object.body->setWorldTransform(to_bt(Pose(hand * Eigen::Translation3d(beside, 0, 0))));
        object.body->setInterpolationWorldTransform(object.body->getWorldTransform());
        read_object(object);
        person.grip.hold(hand.inverse() * object.state.T_world_body);
      }
      people.push_back(std::move(person));
    }
  }

  void read_object(ObjectBody& object) {
    object.state.T_world_body = from_bt(object.body->getWorldTransform());
    object.state.velocity = from_bt(object.body->getLinearVelocity());
    object.state.angular_velocity = from_bt(object.body->getAngularVelocity());
    object.T_world_object = object.state.T_world_body;
    object.T_world_object.translation() -= object.T_world_object.linear() * object.start.model->com;
  }

  BodyState tool_state() const {
    const int tool = model.tool_link();
    BodyState s;
    if (tool < 0) return s;
    s.T_world_body = robot->T_world_link(tool);
    s.velocity = robot->point_velocity(robot->body_of(tool), s.T_world_body.translation());
    s.angular_velocity = robot->angular_velocity(robot->body_of(tool));
    return s;
  }

  void apply(ObjectBody& object, const Wrench& wrench) {
    object.body->applyCentralForce(to_bt(wrench.force));
    object.body->applyTorque(to_bt(wrench.torque));
  }

  void move_people() {
    const double dt = settings.step;
    for (PersonBody& person : people) {
      PersonView view;
      view.robot_hand = tool_state().T_world_body.translation();
      if (!person.grip.holding() && !person.model.wants_grip())
        person.object = gripped >= 0 ? gripped : person.model.exchanging() ? person.object : -1;
      if (person.object >= 0) {
        const ObjectBody& object = objects[person.object];
        view.object = object.start.model;
        view.T_world_object = object.T_world_object;
        view.object_velocity = object.state.velocity;
        view.held_by_robot = gripped == person.object;
        view.grip_force = person.grip.wrench().force;
      }
      for (int s = 0; s < 2; ++s) {
        view.hand_pushed[s] = person.hands[s]->state().T_world_body.translation() - person.model.hand(s).T_world_body.translation();
      }
      view.grip_broke = person.broke;
      person.broke = false;
      person.model.step(dt, view);
      hold_or_let_go(person);
      const bool soft = person.model.exchanging();
      person.capsules = body_capsules(person.model.body());
      for (int s = 0; s < 2; ++s) person.hands[s]->pull_to(person.model.hand(s), dt);
      for (std::size_t c = 0; c < person.colliders.size(); ++c) {
        const BodyCapsule& capsule = person.capsules[c];
        if (person.colliders[c]) person.colliders[c]->setWorldTransform(to_bt(along(capsule.a, capsule.b)));
        btRigidBody& body = person.colliders[c] ? *person.colliders[c] : person.hands[capsule.part == BodyPart::hand_left ? 0 : 1]->body();
        const int flags = body.getCollisionFlags() & ~btCollisionObject::CF_NO_CONTACT_RESPONSE;
        const bool yields = soft && of_hand(capsule.part, person.model.side());
        body.setCollisionFlags(yields ? flags | btCollisionObject::CF_NO_CONTACT_RESPONSE : flags);
      }
      if (person.grip.holding()) {
        ObjectBody& object = objects[person.object];
        const BodyState hand = person.hand().state();
        const Wrench& w = person.grip.update(hand, object.state, object.start.model->mass, object.least_inertia, dt);
        apply(object, w);
        person.hand().push(object.state.T_world_body.translation(), {-w.force, -w.torque});
        person.broke = !person.grip.holding();
      }
    }
  }

  void hold_or_let_go(PersonBody& person) {
    if (!person.model.wants_grip()) {
      person.grip.release();
    } else if (!person.grip.holding() && !person.broke && person.object >= 0) {
      if (hand_gap(person) < PersonModel::kPalm + 0.03) {
        person.grip.hold(person.hand().state().T_world_body.inverse() * objects[person.object].state.T_world_body);
      } else {
        person.broke = true;
      }
    }
  }

  double hand_gap(const PersonBody& person) const {
    const ObjectBody& object = objects[person.object];
    return surface_distance(*object.start.model, object.T_world_object.inverse() * person.hand().state().T_world_body.translation());
  }

  bool hand_touches(const PersonBody& person, int object) const {
    if (person.object != object || object < 0) return false;
    if (person.grip.holding()) return true;
    const PersonPhase phase = person.model.phase();
    return (phase == PersonPhase::closing || phase == PersonPhase::reaching) && hand_gap(person) < PersonModel::kPalm + 0.012;
  }

  void hold_with_robot() {
    if (gripped < 0 || !settings.constraint) return;
    ObjectBody& object = objects[gripped];
    const BodyState tool = tool_state();
    const Wrench w = robot_grip.update(tool, object.state, object.start.model->mass, object.least_inertia, settings.step);
    if (!robot_grip.holding()) {
      let_go();
      return;
    }
    apply(object, w);
    robot->push(grasp->palm(), object.state.T_world_body.translation(), {-w.force, -w.torque});
  }

  void let_go() {
    robot_grip.release();
    grasp->reset();
    gripped = -1;
  }

  void update_grasp() {
    int candidate = gripped;
    if (candidate < 0) {
      double most = 0;
      for (int i = 0; i < static_cast<int>(objects.size()); ++i) {
        const double pressure = grasp->pressure(touches, i);
        if (pressure > most) most = pressure, candidate = i;
      }
    }
    const Vector3 centre = candidate < 0 ? Vector3(Vector3::Zero()) : objects[candidate].state.T_world_body.translation();
    const bool held = grasp->update(touches, candidate, centre, settings.step);
    if (gripped < 0 && held) {
      gripped = candidate;
      if (settings.constraint) robot_grip.hold(tool_state().T_world_body.inverse() * objects[candidate].state.T_world_body);
    } else if (gripped >= 0 && !held) {
      let_go();
    }
    if (gripped < 0) return;
    held_time += settings.step;
    constraint_carries = robot_grip.holding() && robot_grip.wrench().force.norm() > grasp->force(touches, gripped).norm();
    if (constraint_carries) constraint_time += settings.step;
  }

  // What the world does to the hand: contacts of palm and fingers and the hold of the object, at the tool's origin in its axes.
  void measure() {
    Wrench wrench;
    external.setZero();
    const BodyState tool = tool_state();
    const Vector3 origin = tool.T_world_body.translation();
    const auto add = [&](int body, const Vector3& point, const Vector3& force, const Vector3& torque) {
      robot->project(body, point, {force, torque}, external);
      if (grasp->chain_of(body) < 0) return;
      wrench.force += force;
      wrench.torque += torque + (point - origin).cross(force);
    };
    double contact = 0;
    for (const Touch& t : touches) {
      if (t.a != Owner::robot || t.normal_force <= 0) continue;
      add(t.index_a, t.point, t.force_on_a, Vector3::Zero());
      if (t.b == Owner::person) contact += t.normal_force;
    }
    if (gripped >= 0 && robot_grip.holding()) {
      const Wrench& w = robot_grip.wrench();
      add(grasp->palm(), objects[gripped].state.T_world_body.translation(), -w.force, -w.torque);
    }
    const double k = std::min(1.0, settings.step * 2 * M_PI * settings.wrench_filter);
    filtered.force += k * (tool.T_world_body.linear().transpose() * wrench.force - filtered.force);
    filtered.torque += k * (tool.T_world_body.linear().transpose() * wrench.torque - filtered.torque);
    filtered_external += k * (external - filtered_external);
    payload += std::min(1.0, settings.step * 2 * M_PI * 5.0) * (-wrench.force.z() / 9.81 - payload);
    contact_force += std::min(1.0, settings.step / 0.01) * (contact - contact_force);
    largest_contact = std::max(largest_contact, contact_force);
  }

  void judge() {
    bool collided = false;
    for (const Touch& t : touches) {
      if (t.a != Owner::robot || t.normal_force < kCollisionForce) continue;
      const bool by_hand = grasp->chain_of(t.index_a) >= 0;
      if (t.b == Owner::object && by_hand) continue;
      if (t.b == Owner::person && yielding(t.index_b)) continue;
      if (!collided) {
        last_collision = robot->name_of(t.index_a) + " hits " +
                         (t.b == Owner::fixed    ? setup.boxes[t.index_b].id
                          : t.b == Owner::floor  ? std::string("floor")
                          : t.b == Owner::object ? objects[t.index_b].start.id
                                                 : setup.people[t.index_b / 100].settings.id);
      }
      collided = true;
    }
    if (collided) ++collisions;

    std::vector<PersonVolume>& volumes = person_volumes;
    volumes.clear();
    for (const PersonBody& person : people) {
      volumes.push_back({&person.model.body(), person.model.exchanging() || exchanged(person), person.model.side()});
    }
    near = separations.separation(*robot, volumes);
    least_separation = std::min(least_separation, near.distance);
    if (near.link >= 0 && near.distance < 0.5) {
      const Vector3 n = (near.on_person - near.on_robot).stableNormalized();
      const Vector3 v = robot->point_velocity(robot->body_of(near.link), near.on_robot) - near.person_velocity;
      peak_closing = std::max(peak_closing, v.dot(n));
    }
    if (steps % ssm_every == 0 && separations.violates(near, *robot, side.velocity(), side.acceleration())) ssm_violations += ssm_every;

    if (watched >= 0) handover->observe(situation(), settings.step);
    add_to_hash();
  }

  // The exchange lasts until the robot's hand has drawn back from the object it gave.
  bool exchanged(const PersonBody& person) const {
    if (person.model.phase() != PersonPhase::keeping || person.object < 0) return false;
    return (tool_state().T_world_body.translation() - objects[person.object].state.T_world_body.translation()).norm() < 0.35;
  }

  bool yielding(int code) const {
    const PersonBody& person = people[code / 100];
    return person.model.exchanging() && of_hand(person.capsules[code % 100].part, person.model.side());
  }

  ObjectSituation situation() const {
    ObjectSituation s;
    const ObjectBody& object = objects[watched];
    s.height = object.state.T_world_body.translation().z();
    s.robot_grips = gripped == watched;
    s.on_floor = object.T_world_object.translation().z() < kFloorHeight;
    for (const Touch& t : touches) {
      if (t.a == Owner::robot && t.b == Owner::object && t.index_b == watched && t.normal_force > 0) s.robot_touches = true;
      if (t.a != Owner::object || t.index_a != watched) continue;
      if (t.b == Owner::floor) s.on_floor = true;
      if (t.b == Owner::fixed && setup.boxes[t.index_b].supports) s.on_surface = true;
    }
    for (const PersonBody& person : people) {
      s.human_grips = s.human_grips || (person.grip.holding() && person.object == watched);
      s.human_touches = s.human_touches || hand_touches(person, watched);
    }
    return s;
  }

  void add_to_hash() {
    hash.add_all(robot->position());
    hash.add_all(robot->velocity());
    for (const ObjectBody& object : objects) {
      hash.add_all(object.state.T_world_body.translation());
      hash.add_all(object.state.velocity);
      hash.add_all(object.state.angular_velocity);
    }
    for (const PersonBody& person : people) {
      for (const BodyJoint& joint : person.model.body().joints) hash.add_all(joint.position);
    }
  }

  void sense() {
    bool looked = false;
    const auto observe = [&](auto& sensor) {
      if (!sensor.due(now())) return;
      if (!looked) look();
      looked = true;
      sensor.observe(now(), sight);
    };
    for (HumanSensor& sensor : human_sensors) observe(sensor);
    for (ObjectSensor& sensor : object_sensors) observe(sensor);
  }

  void look() {
    sight.people.clear();
    sight.bodies.clear();
    sight.objects.clear();
    for (const PersonBody& person : people) {
      sight.people.push_back(&person.model.body());
      sight.bodies.push_back(person.capsules);
    }
    for (const ObjectBody& object : objects) sight.objects.push_back({object.start.id, object.start.model_name, object.T_world_object});
    for (std::size_t i = 0; i < hiding_links.size(); ++i) {
      const LinkCapsule& c = hiding_links[i];
      const Pose& T = robot->T_world_link(c.link);
      sight.robot[i] = {T * c.a, T * c.b, c.radius};
    }
  }

  void prepare_sight() {
    const auto hidden = [](const SensorSettings& s) { return s.occlusion; };
    if (std::none_of(setup.human_sensors.begin(), setup.human_sensors.end(), hidden) &&
        std::none_of(setup.object_sensors.begin(), setup.object_sensors.end(), hidden))
      return;
    hiding_links = robot_capsules(model);
    sight.robot.resize(hiding_links.size());
    for (const StartBox& box : setup.boxes) sight.boxes.push_back({box.T_world_box, box.size});
  }

  void step() {
    while (next_disturbance < setup.disturbances.size() && setup.disturbances[next_disturbance].at <= now() + 1e-9) {
      control(setup.disturbances[next_disturbance++].control);
    }
    side.step(now(), settings.step, gripped >= 0);
    robot->drive(side.position(), side.velocity(), side.acceleration(), side.effort());
    move_people();
    hold_with_robot();
    dynamics.stepSimulation(settings.step, 0);
    ++steps;
    robot->read();
    for (ObjectBody& object : objects) read_object(object);
    gather(dispatcher, settings.step, kReach, touches);
    update_grasp();
    measure();
    judge();
    sense();
  }

  std::string control(const SimControl& c) {
    const auto everyone = [&](auto&& act) -> std::string {
      bool any = false;
      for (PersonBody& person : people) {
        if (!c.subject.empty() && person.model.id() != c.subject) continue;
        act(person.model);
        any = true;
      }
      return any ? "" : "there is no person " + c.subject;
    };
    const double until = c.value > 0 ? now() + c.value : std::numeric_limits<double>::infinity();
    switch (c.action) {
      case SimAction::person_freeze:
        return everyone([](PersonModel& p) { p.freeze(true); });
      case SimAction::person_unfreeze:
        return everyone([](PersonModel& p) { p.freeze(false); });
      case SimAction::person_dart:
        return everyone([&](PersonModel& p) { p.dart(c.value > 0 ? c.value : 1.0); });
      case SimAction::person_leave:
        return everyone([](PersonModel& p) { p.leave(); });
      case SimAction::person_refuse:
        return everyone([](PersonModel& p) { p.refuse(); });
      case SimAction::robot_stop:
        side.user_stop();
        return "";
      case SimAction::robot_enable:
        side.enable();
        return "";
      case SimAction::silence_human:
        human_silent_until = until;
        return "";
      case SimAction::silence_robot_state:
        state_silent_until = until;
        return "";
      case SimAction::restore:
        human_silent_until = state_silent_until = 0;
        return "";
      default:
        return "";
    }
  }

  double noise(double sigma) { return sigma > 0 ? sigma * normal(random) : 0; }

  const RobotModel& model;
  SimSettings settings;
  SceneSetup setup;
  std::mt19937_64 random;
  std::normal_distribution<double> normal{0, 1};

  ShapeStore shapes;
  btStaticPlaneShape floor{btVector3(0, 0, 1), 0};
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld dynamics;
  std::vector<std::unique_ptr<btCollisionObject>> fixed;
  std::unique_ptr<RobotBody> robot;
  std::vector<ObjectBody> objects;
  std::vector<PersonBody> people;

  RobotSide side;
  Grip robot_grip{GripSettings{}};
  std::unique_ptr<RobotGrasp> grasp;
  bool constraint_carries{false};  // the constraint's force on the object is larger than that of the hand's contacts together
  double held_time{0}, constraint_time{0};
  int gripped{-1}, watched{-1}, ssm_every{10};
  std::uint64_t steps{0}, state_sequence{0};
  std::size_t next_disturbance{0};
  double human_silent_until{0}, state_silent_until{0};
  std::vector<Touch> touches;
  std::vector<PersonVolume> person_volumes;
  Sight sight;
  std::vector<LinkCapsule> hiding_links;
  std::vector<HumanSensor> human_sensors;
  std::vector<ObjectSensor> object_sensors;

  Wrench filtered;
  Vector external, filtered_external;
  double payload{0}, contact_force{0}, largest_contact{0};

  LimitsOracle limits;
  SeparationOracle separations;
  std::unique_ptr<HandoverOracle> handover;
  TrueSeparation near{std::numeric_limits<double>::infinity(), -1, Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  double least_separation{std::numeric_limits<double>::infinity()}, peak_closing{0};
  std::uint64_t collisions{0}, ssm_violations{0};
  std::string last_collision;
  Hash hash;
};

SimWorld::SimWorld(const RobotModel& robot, const ObjectLibrary& library, const config::Scenario& scenario, const SimSettings& settings,
                   std::uint64_t seed)
    : impl_(std::make_unique<Impl>(robot, library, scenario, settings, seed)) {}
SimWorld::~SimWorld() = default;
SimWorld::SimWorld(SimWorld&&) noexcept = default;

void SimWorld::step() { impl_->step(); }
double SimWorld::time() const { return impl_->now(); }

void SimWorld::command(const JointCommand& command, std::uint64_t writer) {
  impl_->limits.observe(command, writer, impl_->now(), impl_->robot->position());
  impl_->side.command(command, impl_->now());
}

std::string SimWorld::control(const SimControl& c) { return impl_->control(c); }

bool SimWorld::robot_state(RobotState& out) {
  Impl& w = *impl_;
  if (w.now() < w.state_silent_until) return false;
  out.robot = w.model.name();
  out.sequence = ++w.state_sequence;
  out.T_world_base = w.setup.T_world_base;
  out.position = w.robot->position();
  for (Eigen::Index i = 0; i < out.position.size(); ++i) out.position[i] += w.noise(w.settings.position_noise);
  out.velocity = w.robot->velocity();
  out.effort = w.robot->effort();
  out.external_torque = w.filtered_external;
  for (Eigen::Index i = 0; i < out.external_torque.size(); ++i) out.external_torque[i] += w.noise(0.1 * w.settings.force_noise);
  out.wrist_wrench = w.filtered;
  for (int i = 0; i < 3; ++i) {
    out.wrist_wrench.force[i] += w.noise(w.settings.force_noise);
    out.wrist_wrench.torque[i] += w.noise(0.1 * w.settings.force_noise);
  }
  out.hand_effort = 0;
  if (const Group* hand = w.model.group("hand")) {
    for (int axis : hand->axes) out.hand_effort += std::abs(w.robot->effort()[axis]);
  }
  out.payload = std::max(0.0, w.payload);
  out.mode = w.side.mode();
  return true;
}

void SimWorld::human_observations(std::vector<Delivery<HumanObservation>>& out) {
  for (HumanSensor& sensor : impl_->human_sensors) sensor.collect(impl_->now(), out);
  if (impl_->now() < impl_->human_silent_until) out.clear();
}

void SimWorld::object_observations(std::vector<Delivery<ObjectObservation>>& out) {
  for (ObjectSensor& sensor : impl_->object_sensors) sensor.collect(impl_->now(), out);
}

void SimWorld::truth(GroundTruth& out) const {
  const Impl& w = *impl_;
  out.sim_time = w.now();
  if (w.watched >= 0) {
    out.object = w.objects[w.watched].start.id;
    out.T_world_object = w.objects[w.watched].T_world_object;
    w.handover->write(out);
    out.hold = w.gripped != w.watched ? "" : w.constraint_carries ? "constraint" : "contact";
    out.held_time = w.held_time;
    out.constraint_time = w.constraint_time;
  }
  out.separation = w.near.distance;
  out.least_separation = w.least_separation;
  out.ssm_violations = w.ssm_violations;
  out.peak_closing_speed = w.peak_closing;
  out.contact_force = w.largest_contact;
  out.limit_share_velocity = w.limits.share_velocity();
  out.limit_share_acceleration = w.limits.share_acceleration();
  out.limit_share_jerk = w.limits.share_jerk();
  out.limit_violations = w.limits.violations();
  out.self_or_scene_collisions = w.collisions;
  out.commanders = w.limits.writers();
  out.setpoint_gap_max = w.limits.longest_gap();
  out.set_points = w.limits.count();
  out.hash = w.hash.value;
  out.robot_moving = false;
  const Group* arm = w.model.group("arm");
  for (Eigen::Index i = 0; i < w.robot->velocity().size(); ++i) {
    const bool counts = arm == nullptr || std::find(arm->axes.begin(), arm->axes.end(), i) != arm->axes.end();
    if (counts && std::abs(w.robot->velocity()[i]) > 1e-3) out.robot_moving = true;
  }
  out.person.clear();
  double least = std::numeric_limits<double>::infinity();
  for (const PersonBody& person : w.people) {
    const double d = (person.model.body().joints.front().position - w.setup.T_world_base.translation()).norm();
    if (d < least) least = d, out.person = person.model.body().joints;
  }
}

const std::string& SimWorld::last_limit_violation() const { return impl_->limits.last_violation(); }
const std::string& SimWorld::last_collision() const { return impl_->last_collision; }
DriveMode SimWorld::mode() const { return impl_->side.mode(); }
const std::vector<Touch>& SimWorld::touches() const { return impl_->touches; }
const std::string& SimWorld::robot_body(int body) const { return impl_->robot->name_of(body); }
bool SimWorld::robot_grips() const { return impl_->gripped >= 0; }
double SimWorld::robot_pressure() const { return impl_->watched < 0 ? 0 : impl_->grasp->pressure(impl_->touches, impl_->watched); }
double SimWorld::constraint_share() const { return impl_->held_time > 0 ? impl_->constraint_time / impl_->held_time : 0; }
const Pose& SimWorld::T_world_object(const std::string& id) const {
  const int i = impl_->object_index(id);
  if (i < 0) throw std::out_of_range("no object " + id);
  return impl_->objects[i].T_world_object;
}
const Person& SimWorld::person(std::size_t index) const { return impl_->people.at(index).model.body(); }
PersonPhase SimWorld::person_phase(std::size_t index) const { return impl_->people.at(index).model.phase(); }

}  // namespace handsel::sim
