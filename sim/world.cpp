#include "sim/world.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

#include "common/model/manipulator.hpp"
#include "common/model/robot_capsules.hpp"
#include "sim/oracle/handover_oracle.hpp"
#include "sim/oracle/limits_oracle.hpp"
#include "sim/people/people.hpp"
#include "sim/physics/contacts.hpp"
#include "sim/robot/hand_measure.hpp"
#include "sim/robot/robot_grasp.hpp"
#include "sim/robot/stuck_hand.hpp"

namespace handsel::sim {

namespace {

constexpr double kReach = 0.001;         // contacts closer than this touch [m]
constexpr double kCollisionForce = 0.5;  // [N]
constexpr double kFingersMeet =
    0.002;  // the person's hand and the robot's overlap by more, before both have the object [m]
constexpr double kMostHelped = 1.0;  // [kg] the constraint helps to hold no more than this
constexpr double kPush = 0.2;        // so long after the last touch a push still moves the arm [s]
constexpr double kFloorHeight = 0.02;  // an object's origin lower than this lies on the floor [m]

/// Where a source looks that looks elsewhere, from where it looked [m].
const Vector3 kElsewhere(100.0, 100.0, 0.0);

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

}  // namespace

struct SimWorld::Impl {
  Impl(const RobotModel& robot_model, const ObjectLibrary& library,
       const config::Scenario& scenario, const SimSettings& s, std::uint64_t seed)
      : model(robot_model),
        settings(s),
        setup(set_up(scenario, robot_model, library, s.coverage, s.data_root, seed)),
        random(seed ^ 0x5e45'0f'f0'1ceULL),
        dispatcher(&configuration),
        dynamics(&dispatcher, &broadphase, &solver, &configuration),
        side(robot_model, setup.start, s.robot_side),
        reference{side.position(), side.velocity(), side.acceleration(), side.effort()},
        limits(robot_model, s.robot_side.max_gap, s.setpoint_period),
        separations(robot_model, s.ssm) {
    settings.constraint = settings.constraint && !setup.no_weld;
    dynamics.setGravity(btVector3(0, 0, -9.81));
    dynamics.getSolverInfo().m_numIterations = settings.solver_iterations;
    dynamics.getSolverInfo().m_solverMode |=
        SOLVER_USE_2_FRICTION_DIRECTIONS;  // with one, a contact slides freely across it
    build_fixed();
    robot = std::make_unique<RobotBody>(
        model, setup.T_world_base, setup.start, settings.servo, settings.pad,
        BodyWorld{dynamics, shapes, kRobot, kObject | kFixed | kPerson});
    for (int i = 0; i < robot->bodies(); ++i) {
      btMultiBodyLinkCollider* collider = robot->collider(i);
      if (collider == nullptr) continue;
      own(*collider, Owner::robot, i);
      collider->setContactProcessingThreshold(kReach);
    }
    for (const Manipulator& hand : hands_of(model)) add_hand(hand);
    if (hands.empty()) add_hand({});
    if (setup.never_releases) stuck_hand.emplace(finger_axes());
    for (const StartObject& start : setup.objects)
      objects.emplace_back(start, static_cast<int>(objects.size()), shapes, dynamics);
    people = std::make_unique<People>(setup, settings, objects, shapes, dynamics);
    prepare_sight();
    std::uint64_t salt = seed;
    for (const SensorSettings& sensor : setup.human_sensors)
      human_sensors.emplace_back(sensor, salt += 0x1000193);
    for (const SensorSettings& sensor : setup.object_sensors)
      object_sensors.emplace_back(sensor, salt += 0x1000193);
    watched = object_index(objects, setup.watched);
    if (watched >= 0) {
      const bool from_person =
          std::any_of(setup.people.begin(), setup.people.end(),
                      [&](const StartPerson& p) { return p.holds == setup.watched; });
      handover = std::make_unique<HandoverOracle>(
          objects[watched].state().T_world_body.translation().z(), from_person);
    }
    ssm_every = std::max(1, static_cast<int>(std::lround(0.01 / settings.step)));
  }

  ~Impl() {
    robot.reset();
    people.reset();
    objects.clear();
    for (auto& object : fixed) dynamics.removeCollisionObject(object.get());
  }

  std::vector<int> finger_axes() const {
    std::vector<int> axes;
    for (const Hand& hand : hands)
      if (hand.fingers != nullptr)
        axes.insert(axes.end(), hand.fingers->axes.begin(), hand.fingers->axes.end());
    return axes;
  }

  void add_hand(const Manipulator& hand) {
    hands.push_back(
        {hand.arm, hand.fingers, hand.palm,
         RobotGrasp(hand.palm, *robot, settings.touch_force, settings.grasp_time,
                    settings.lose_time),
         Grip(settings.robot_grip),
         HandMeasure(model.dof(), settings.wrench_filter, settings.step, hands.empty())});
  }

  double now() const { return static_cast<double>(steps) * settings.step; }

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
      add_fixed(shapes.convex(Box{setup.boxes[i].size}), setup.boxes[i].T_world_box, Owner::fixed,
                static_cast<int>(i));
    }
  }

  struct Hand {
    const Group *arm{}, *fingers{};
    int palm{-1};  // link
    RobotGrasp grasp;
    Grip grip;
    HandMeasure measured;
    int gripped{-1};  // object
  };

  BodyState tool_state(const Hand& hand) const {
    BodyState s;
    if (hand.palm < 0) return s;
    s.T_world_body = robot->T_world_link(hand.palm);
    s.velocity = robot->point_velocity(robot->body_of(hand.palm), s.T_world_body.translation());
    s.angular_velocity = robot->angular_velocity(robot->body_of(hand.palm));
    return s;
  }

  void hold_with(Hand& hand) {
    if (hand.gripped < 0 || !helped(hand.gripped)) return;
    ObjectBody& object = objects[hand.gripped];
    const Wrench w = hand.grip.update(tool_state(hand), object.state(), object.model().mass,
                                      object.min_inertia(), settings.step);
    if (!hand.grip.holding()) {
      release(hand);
      return;
    }
    object.push(w);
    robot->push(hand.grasp.palm(), object.state().T_world_body.translation(),
                {-w.force, -w.torque});
  }

  static void release(Hand& hand) {
    hand.grip.release();
    hand.grasp.reset();
    hand.gripped = -1;
  }

  /// What is heavy is held by contact alone: a spring in proportion to it is stiffer than hand and
  /// wrist can answer within a step.
  bool helped(int object) const {
    return settings.constraint && objects[object].model().mass <= kMostHelped;
  }

  bool grips(int object) const {
    return std::any_of(hands.begin(), hands.end(),
                       [&](const Hand& hand) { return hand.gripped == object; });
  }
  bool grips_something() const {
    return std::any_of(hands.begin(), hands.end(),
                       [](const Hand& hand) { return hand.gripped >= 0; });
  }
  bool of_hand(int body) const {
    return std::any_of(hands.begin(), hands.end(),
                       [&](const Hand& hand) { return hand.grasp.chain_of(body) >= 0; });
  }

  void update_grasp(Hand& hand) {
    int candidate = hand.gripped;
    if (candidate < 0) {
      double most = 0;
      for (int i = 0; i < static_cast<int>(objects.size()); ++i) {
        const double pressure = hand.grasp.pressure(touches, i);
        if (pressure > most) most = pressure, candidate = i;
      }
    }
    const Vector3 centre = candidate < 0 ? Vector3(Vector3::Zero())
                                         : objects[candidate].state().T_world_body.translation();
    const bool held = hand.grasp.update(touches, candidate, centre, settings.step);
    if (hand.gripped < 0 && held) {
      hand.gripped = candidate;
      if (helped(candidate))
        hand.grip.hold(tool_state(hand).T_world_body.inverse() *
                       objects[candidate].state().T_world_body);
    } else if (hand.gripped >= 0 && !held) {
      release(hand);
    }
  }

  void update_grasps() {
    for (Hand& hand : hands) update_grasp(hand);
    if (!grips_something()) return;
    held_time += settings.step;
    double by_constraints = 0, by_contacts = 0;
    for (const Hand& hand : hands) {
      if (hand.gripped < 0) continue;
      if (hand.grip.holding()) by_constraints += hand.grip.wrench().force.norm();
      by_contacts += hand.grasp.force(touches, hand.gripped).norm();
    }
    constraint_carries = by_constraints > by_contacts;
    if (constraint_carries) constraint_time += settings.step;
  }

  void measure(Hand& hand) {
    Wrench load;
    Vector3 at = Vector3::Zero();
    if (hand.gripped >= 0 && hand.grip.holding()) {
      load = {-hand.grip.wrench().force, -hand.grip.wrench().torque};
      at = objects[hand.gripped].state().T_world_body.translation();
    }
    hand.measured.update(touches, *robot, hand.grasp, tool_state(hand).T_world_body, load, at);
  }

  void judge() {
    bool collided = false;
    for (const Touch& t : touches) {
      if (t.a != Owner::robot) continue;
      const bool by_hand = of_hand(t.index_a);
      if (t.b == Owner::object && by_hand) continue;
      const bool yields = t.b == Owner::person && people->yields(t.index_b);
      const bool fingers_meet =
          yields && by_hand && t.distance < -kFingersMeet && handover && !handover->shared();
      if (!fingers_meet && (yields || t.normal_force < kCollisionForce)) continue;
      if (!collided) {
        last_collision = robot->name_of(t.index_a) + " hits " +
                         (t.b == Owner::fixed    ? setup.boxes[t.index_b].id
                          : t.b == Owner::floor  ? std::string("floor")
                          : t.b == Owner::object ? objects[t.index_b].start().id
                                                 : people->id(t.index_b));
      }
      collided = true;
    }
    if (collided) ++collisions;

    people->volumes(tool_state(hands.front()).T_world_body.translation(), person_volumes);
    near = separations.separation(*robot, person_volumes);
    min_separation = std::min(min_separation, near.distance);
    if (near.link >= 0 && near.distance < 0.5) {
      const Vector3 n = (near.on_person - near.on_robot).stableNormalized();
      const Vector3 v =
          robot->point_velocity(robot->body_of(near.link), near.on_robot) - near.person_velocity;
      closing.add(v.dot(n));
    }
    const bool given_way = gives_way();
    if (steps % ssm_every == 0 && !given_way &&
        separations.violates(near, *robot, reference.velocity, reference.acceleration))
      ssm_violations += ssm_every;

    if (watched >= 0) handover->observe(situation(), settings.step);
    add_to_hash();
  }

  /// A person pushes the robot, or has just done so, and it does not press against them: from the
  /// touch on it is the push that says where it goes, and the volumes that stand for hand and arm
  /// overlap.
  bool gives_way() {
    const auto person = [](const Touch& t) {
      return t.a == Owner::robot && t.b == Owner::person && t.normal_force > 0;
    };
    if (std::any_of(touches.begin(), touches.end(), person)) {
      pushed_at = now();
      pushes.clear();
      std::copy_if(touches.begin(), touches.end(), std::back_inserter(pushes), person);
    }
    return now() < pushed_at + kPush && !separations.presses(*robot, pushes, reference.velocity);
  }

  ObjectSituation situation() const {
    ObjectSituation s;
    const ObjectBody& object = objects[watched];
    s.height = object.state().T_world_body.translation().z();
    s.robot_grips = grips(watched);
    s.on_floor = object.T_world_object().translation().z() < kFloorHeight;
    for (const Touch& t : touches) {
      if (t.a == Owner::robot && t.b == Owner::object && t.index_b == watched && t.normal_force > 0)
        s.robot_touches = true;
      if (t.a != Owner::object || t.index_a != watched) continue;
      if (t.b == Owner::floor) s.on_floor = true;
      if (t.b == Owner::fixed && setup.boxes[t.index_b].supports) s.on_surface = true;
    }
    s.human_grips = people->grips(watched);
    s.human_touches = people->touches(watched);
    return s;
  }

  void add_to_hash() {
    hash.add_all(robot->position());
    hash.add_all(robot->velocity());
    for (const ObjectBody& object : objects) {
      hash.add_all(object.state().T_world_body.translation());
      hash.add_all(object.state().velocity);
      hash.add_all(object.state().angular_velocity);
    }
    for (std::size_t p = 0; p < people->size(); ++p) {
      for (const BodyJoint& joint : people->model(p).body().joints) hash.add_all(joint.position);
    }
  }

  void sense() {
    bool looked = false;
    const auto observe = [&](auto& sensor) {
      if (!sensor.due(now())) return;
      if (!looked) look();
      looked = true;
      if (const SensorSettings& s = sensor.settings(); !s.link.empty())
        sensor.carry_to(robot->T_world_link(model.link_index(s.link)) * s.T_link_sensor);
      sensor.observe(now(), sight);
    };
    for (HumanSensor& sensor : human_sensors) observe(sensor);
    for (ObjectSensor& sensor : object_sensors) observe(sensor);
  }

  void look() {
    sight.people.clear();
    sight.bodies.clear();
    sight.objects.clear();
    for (std::size_t p = 0; p < people->size(); ++p) {
      sight.people.push_back(&people->model(p).body());
      sight.bodies.push_back(people->capsules(p));
    }
    for (const ObjectBody& object : objects)
      sight.objects.push_back(
          {object.start().id, object.start().model_name, object.T_world_object()});
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
    while (next_disturbance < setup.disturbances.size() &&
           setup.disturbances[next_disturbance].at <= now() + 1e-9) {
      control(setup.disturbances[next_disturbance++].control);
    }
    side.step(now(), settings.step);
    reference.position = side.position();
    reference.velocity = side.velocity();
    reference.acceleration = side.acceleration();
    reference.effort = side.effort();
    if (stuck_hand) stuck_hand->apply(settings.step, grips_something(), reference);
    robot->drive(reference.position, reference.velocity, reference.acceleration, reference.effort);
    const auto holding = std::find_if(hands.begin(), hands.end(),
                                      [](const Hand& hand) { return hand.gripped >= 0; });
    const Hand& offering = holding != hands.end() ? *holding : hands.front();
    people->move(settings.step, tool_state(offering), offering.gripped);
    for (Hand& hand : hands) hold_with(hand);
    dynamics.stepSimulation(settings.step, 0);
    ++steps;
    robot->read();
    side.measured(robot->position());
    for (ObjectBody& object : objects) object.read();
    gather(dispatcher, settings.step, kReach, touches);
    update_grasps();
    for (Hand& hand : hands) measure(hand);
    judge();
    sense();
  }

  /// `how`: empty: by a person; "protective": by the robot's own protection, which ends by itself;
  /// "unannounced": without saying so.
  std::string stop_robot(const std::string& how) {
    if (how.empty())
      side.user_stop();
    else if (how == "protective")
      side.stop(DriveMode::protective_stop);
    else if (how == "unannounced")
      side.stop(DriveMode::enabled);
    else
      return "robot_stop is protective, unannounced or, without a subject, by a person; not \"" +
             how + "\"";
    return "";
  }

  /// Of the source, or of all sources of people.
  std::string disturb(const std::string& source, const SensorFault& fault) {
    bool any = false;
    for (HumanSensor& sensor : human_sensors) {
      if (!source.empty() && sensor.settings().source != source) continue;
      sensor.disturb(fault);
      any = true;
    }
    return any ? "" : "there is no source of people " + source;
  }

  std::string control(const SimControl& c) {
    const auto everyone = [&](auto&& act) -> std::string {
      bool any = false;
      for (std::size_t p = 0; p < people->size(); ++p) {
        if (!c.subject.empty() && people->model(p).id() != c.subject) continue;
        const bool any_may =
            c.action == SimAction::person_freeze || c.action == SimAction::person_unfreeze;
        if (!any_may && !people->model(p).source().empty()) continue;
        act(people->model(p));
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
        return stop_robot(c.subject);
      case SimAction::emergency_stop:
        side.stop(DriveMode::emergency_stop);
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
      case SimAction::human_frozen:
        return disturb(c.subject, {SensorFaultKind::frozen, now(), until - now()});
      case SimAction::human_empty:
        return disturb(c.subject, {SensorFaultKind::repeated_empty, now(), until - now()});
      case SimAction::human_late:
        return disturb(c.subject,
                       {SensorFaultKind::late, now(), std::numeric_limits<double>::infinity(),
                        Vector3::Zero(), c.value});
      case SimAction::human_elsewhere:
        return disturb(c.subject, {SensorFaultKind::elsewhere, now(), until - now(), kElsewhere});
      case SimAction::restore:
        human_silent_until = state_silent_until = 0;
        for (HumanSensor& sensor : human_sensors) sensor.restore();
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
  ObjectBodies objects;
  std::unique_ptr<People> people;

  RobotSide side;
  Reference reference;
  std::optional<StuckHand> stuck_hand;
  std::vector<Hand> hands;  // never empty; the first is that of the tool
  bool constraint_carries{
      false};  // the constraints' force on what is held is larger than that of the hands' contacts
  double held_time{0}, constraint_time{0};
  int watched{-1}, ssm_every{10};
  std::uint64_t steps{0}, state_sequence{0};
  std::size_t next_disturbance{0};
  double human_silent_until{0}, state_silent_until{0};
  std::vector<Touch> touches, pushes;
  double pushed_at{-kPush};
  std::vector<PersonVolume> person_volumes;
  Sight sight;
  std::vector<LinkCapsule> hiding_links;
  std::vector<HumanSensor> human_sensors;
  std::vector<ObjectSensor> object_sensors;

  LimitsOracle limits;
  SeparationOracle separations;
  std::unique_ptr<HandoverOracle> handover;
  TrueSeparation near{std::numeric_limits<double>::infinity(), -1, Vector3::Zero(), Vector3::Zero(),
                      Vector3::Zero()};
  double min_separation{std::numeric_limits<double>::infinity()};
  PeakSpeed closing;
  std::uint64_t collisions{0}, ssm_violations{0};
  std::string last_collision;
  Hash hash;
};

SimWorld::SimWorld(const RobotModel& robot, const ObjectLibrary& library,
                   const config::Scenario& scenario, const SimSettings& settings,
                   std::uint64_t seed)
    : impl_(std::make_unique<Impl>(robot, library, scenario, settings, seed)) {}
SimWorld::~SimWorld() = default;
SimWorld::SimWorld(SimWorld&&) noexcept = default;

void SimWorld::step() { impl_->step(); }
double SimWorld::time() const { return impl_->now(); }

void SimWorld::command(const JointCommand& command, std::uint64_t writer, double arrival) {
  Impl& w = *impl_;
  w.limits.observe(command, writer, w.now(), w.robot->position(), w.side.position());
  w.side.command(command, w.now(), arrival < 0 ? w.now() : arrival);
}

void SimWorld::observe(const HumanObservation& seen) { impl_->people->follow(seen); }
bool SimWorld::follows() const { return impl_->people->follow_somebody(); }

std::string SimWorld::control(const SimControl& c) { return impl_->control(c); }

bool SimWorld::robot_state(RobotState& out) {
  Impl& w = *impl_;
  if (w.now() < w.state_silent_until) return false;
  out.robot = w.model.name();
  out.sequence = ++w.state_sequence;
  out.T_world_base = w.setup.T_world_base;
  out.position = w.robot->position();
  for (Eigen::Index i = 0; i < out.position.size(); ++i)
    out.position[i] += w.noise(w.settings.position_noise);
  out.velocity = w.robot->velocity();
  out.effort = w.robot->effort();
  w.side.report(out.reference);
  out.external_torque = w.hands.front().measured.external_torque();
  for (std::size_t i = 1; i < w.hands.size(); ++i)
    out.external_torque += w.hands[i].measured.external_torque();
  for (std::size_t i = 0; i < w.hands.size(); ++i) {
    const Impl::Hand& hand = w.hands[i];
    if (!(w.side.payload(i) > 0) || hand.palm < 0)
      continue;  // what it was told to hold is part of the robot's own model
    const Wrench weight{Vector3(0, 0, 9.81 * w.side.payload(i)), Vector3::Zero()};
    w.robot->project(w.robot->body_of(hand.palm), w.tool_state(hand).T_world_body.translation(),
                     weight, out.external_torque);
  }
  for (Eigen::Index i = 0; i < out.external_torque.size(); ++i)
    out.external_torque[i] += w.noise(0.1 * w.settings.force_noise);
  const auto feel = [&w](const Impl::Hand& hand, Wrench& wrench, double& effort, double& payload) {
    wrench = hand.measured.wrist_wrench();
    for (int i = 0; i < 3; ++i) {
      wrench.force[i] += w.noise(w.settings.force_noise);
      wrench.torque[i] += w.noise(0.1 * w.settings.force_noise);
    }
    effort = 0;
    if (hand.fingers != nullptr)
      for (int axis : hand.fingers->axes) effort += std::abs(w.robot->effort()[axis]);
    payload = std::max(0.0, hand.measured.payload());
  };
  feel(w.hands.front(), out.wrist_wrench, out.hand_effort, out.payload);
  out.other_hands.resize(w.hands.size() - 1);
  for (std::size_t i = 1; i < w.hands.size(); ++i) {
    OtherHand& other = out.other_hands[i - 1];
    other.group = w.hands[i].fingers != nullptr ? w.hands[i].fingers->name : "";
    feel(w.hands[i], other.wrist_wrench, other.hand_effort, other.payload);
  }
  out.mode = w.side.mode();
  out.refusal = w.side.refusal();
  out.refused_set_points = w.side.refused();
  return true;
}

void SimWorld::human_observations(std::vector<Delivery<HumanObservation>>& out) {
  for (HumanSensor& sensor : impl_->human_sensors) sensor.collect(impl_->now(), out);
  if (impl_->now() < impl_->human_silent_until) out.clear();
}

void SimWorld::object_observations(std::vector<Delivery<ObjectObservation>>& out) {
  for (ObjectSensor& sensor : impl_->object_sensors) sensor.collect(impl_->now(), out);
}

void SimWorld::ground_truth(GroundTruth& out) const {
  const Impl& w = *impl_;
  out.sim_time = w.now();
  if (w.watched >= 0) {
    out.object = w.objects[w.watched].start().id;
    out.T_world_object = w.objects[w.watched].T_world_object();
    w.handover->write(out);
    out.hold = !w.grips(w.watched) ? "" : w.constraint_carries ? "constraint" : "contact";
    out.held_time = w.held_time;
    out.constraint_time = w.constraint_time;
  }
  out.separation = w.near.distance;
  out.min_separation = w.min_separation;
  out.ssm_violations = w.ssm_violations;
  out.peak_closing_speed = w.closing.peak();
  out.contact_force = w.hands.front().measured.largest_contact();
  out.limit_ratio_velocity = w.limits.ratio_velocity();
  out.limit_ratio_acceleration = w.limits.ratio_acceleration();
  out.limit_ratio_jerk = w.limits.ratio_jerk();
  out.limit_violations = w.limits.violations();
  out.self_or_scene_collisions = w.collisions;
  out.commanders = w.limits.writers();
  out.setpoint_gap_max = w.limits.max_gap();
  out.set_points = w.limits.count();
  out.hash = w.hash.value;
  out.robot_moving = false;
  const auto of_arm = [](const Impl::Hand& hand, Eigen::Index axis) {
    return hand.arm == nullptr ||
           std::find(hand.arm->axes.begin(), hand.arm->axes.end(), axis) != hand.arm->axes.end();
  };
  for (Eigen::Index i = 0; i < w.robot->velocity().size(); ++i) {
    const bool counts = std::any_of(w.hands.begin(), w.hands.end(),
                                    [&](const Impl::Hand& hand) { return of_arm(hand, i); });
    if (counts && std::abs(w.robot->velocity()[i]) > 1e-3) out.robot_moving = true;
  }
  out.person.clear();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < w.people->size(); ++p) {
    const Person& person = w.people->model(p).body();
    const double d = (person.joints.front().position - w.setup.T_world_base.translation()).norm();
    if (d < least) least = d, out.person = person.joints;
  }
}

const std::string& SimWorld::last_limit_violation() const { return impl_->limits.last_violation(); }
const std::string& SimWorld::last_collision() const { return impl_->last_collision; }
DriveMode SimWorld::mode() const { return impl_->side.mode(); }
const std::vector<Touch>& SimWorld::touches() const { return impl_->touches; }
const std::string& SimWorld::robot_body(int body) const { return impl_->robot->name_of(body); }
bool SimWorld::robot_grips() const { return impl_->grips_something(); }
double SimWorld::robot_pressure() const {
  double sum = 0;
  if (impl_->watched >= 0)
    for (const Impl::Hand& hand : impl_->hands)
      sum += hand.grasp.pressure(impl_->touches, impl_->watched);
  return sum;
}
double SimWorld::constraint_fraction() const {
  return impl_->held_time > 0 ? impl_->constraint_time / impl_->held_time : 0;
}
const Pose& SimWorld::T_world_object(const std::string& id) const {
  const int i = object_index(impl_->objects, id);
  if (i < 0) throw std::out_of_range("no object " + id);
  return impl_->objects[i].T_world_object();
}
const Person& SimWorld::person(std::size_t index) const {
  return impl_->people->model(index).body();
}
PersonPhase SimWorld::person_phase(std::size_t index) const {
  return impl_->people->model(index).phase();
}

}  // namespace handsel::sim
