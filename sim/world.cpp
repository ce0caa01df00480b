// SPDX-License-Identifier: Apache-2.0
#include "sim/world.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/physics/contacts.hpp"
#include "sim/scene/other_robots.hpp"
#include "sim/world_parts.hpp"

namespace handsel::sim {

SimWorld::Impl::Impl(const RobotModel& robot_model, const ObjectLibrary& library,
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
  if (drives(model))
    odometry.emplace(model, setup.start, settings.odometry, settings.localisation,
                     seed ^ 0x0d0'4e7'27ULL);
  settings.constraint = settings.constraint || setup.help_hold;
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
    collider->setContactProcessingThreshold(kContactDistance);
  }
  for (const Manipulator& hand : hands_of(model)) add_hand(hand);
  if (hands.empty()) add_hand({});
  if (setup.never_releases) stuck_hand.emplace(finger_axes());
  for (const StartObject& start : setup.objects)
    objects.emplace_back(start, static_cast<int>(objects.size()), shapes, dynamics);
  people = std::make_unique<People>(setup, settings, objects, shapes, dynamics);
  for (OtherRobotMotion& motion : read_other_robots(scenario))
    other_robots.emplace_back(std::move(motion));
  if (!other_robots.empty()) robot_hull = robot_capsules(model);
  prepare_sight();
  if (people->size() > 0) links = robot_capsules(model);
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

SimWorld::Impl::~Impl() {
  robot.reset();
  people.reset();
  objects.clear();
  for (auto& object : fixed) dynamics.removeCollisionObject(object.get());
}

std::vector<int> SimWorld::Impl::finger_axes() const {
  std::vector<int> axes;
  for (const Hand& hand : hands)
    if (hand.fingers != nullptr)
      axes.insert(axes.end(), hand.fingers->axes.begin(), hand.fingers->axes.end());
  return axes;
}

void SimWorld::Impl::add_hand(const Manipulator& hand) {
  hands.push_back(
      {hand.arm, hand.fingers, hand.palm,
       RobotGrasp(hand.palm, *robot, settings.touch_force, settings.grasp_time, settings.lose_time),
       Grip(settings.robot_grip),
       HandMeasure(model.dof(), settings.wrench_filter, settings.step, hands.empty())});
}

void SimWorld::Impl::add_fixed(btCollisionShape* shape, const Pose& T, Owner owner, int index) {
  auto object = std::make_unique<btCollisionObject>();
  object->setCollisionShape(shape);
  object->setWorldTransform(to_bt(T));
  object->setFriction(0.8);
  own(*object, owner, index);
  dynamics.addCollisionObject(object.get(), kFixed, kRobot | kObject);
  fixed.push_back(std::move(object));
}

void SimWorld::Impl::build_fixed() {
  add_fixed(&floor, Pose::Identity(), Owner::floor, 0);
  for (std::size_t i = 0; i < setup.boxes.size(); ++i) {
    add_fixed(shapes.convex(Box{setup.boxes[i].size}), setup.boxes[i].T_world_box, Owner::fixed,
              static_cast<int>(i));
  }
}

Vector SimWorld::Impl::measured_position() const {
  return odometry ? odometry->measured_position(robot->position()) : robot->position();
}

void SimWorld::Impl::step() {
  while (next_disturbance < setup.disturbances.size() &&
         setup.disturbances[next_disturbance].at <= now() + 1e-9) {
    control(setup.disturbances[next_disturbance++].control);
  }
  side.step(now(), settings.step);
  reference.position = side.position();
  reference.velocity = side.velocity();
  reference.acceleration = side.acceleration();
  reference.effort = side.effort();
  if (odometry) odometry->to_root(reference.position, reference.velocity, reference.acceleration);
  if (stuck_hand) stuck_hand->apply(settings.step, grips_something(), reference);
  robot->drive(reference.position, reference.velocity, reference.acceleration, reference.effort);
  update_robot_hands();
  if (odometry)
    people->set_platform(
        T_world_platform(model, robot->position(), setup.T_world_base).translation());
  people->move(settings.step, robot_hands, robot_parts);
  for (Hand& hand : hands) hold_with(hand);
  dynamics.stepSimulation(settings.step, 0);
  ++steps;
  robot->read();
  if (odometry) odometry->advance(robot->position(), now());
  side.measured(measured_position());
  for (ObjectBody& object : objects) object.read();
  gather(dispatcher, settings.step, kContactDistance, touches);
  update_grasps();
  for (Hand& hand : hands) measure(hand);
  evaluate();
  sense();
}

SimWorld::SimWorld(const RobotModel& robot, const ObjectLibrary& library,
                   const config::Scenario& scenario, const SimSettings& settings,
                   std::uint64_t seed)
    : impl_(std::make_unique<Impl>(robot, library, scenario, settings, seed)) {}
SimWorld::~SimWorld() = default;
SimWorld::SimWorld(SimWorld&&) noexcept = default;

void SimWorld::step() { impl_->step(); }
double SimWorld::time() const { return impl_->now(); }

void SimWorld::robot_reports(std::vector<RobotReport>& out) {
  out.clear();
  for (OtherRobotBody& robot : impl_->other_robots)
    if (robot.reports()) out.push_back(robot.report(impl_->now()));
}

void SimWorld::command(const JointCommand& command, std::uint64_t writer, double arrival) {
  Impl& w = *impl_;
  w.limits.observe(command, writer, w.now(), w.measured_position(), w.side.position());
  w.side.command(command, w.now(), arrival < 0 ? w.now() : arrival);
}

void SimWorld::observe(const HumanObservation& seen) { impl_->people->follow(seen); }
namespace {

/// Returns whether a robot that gives has the object in its hand for the receiver: a give with both
/// hands begins where the object stands, and ends there if nobody takes the object.
bool is_offering(const ActionStatus& action) {
  return action.kind == ActionKind::give && action.phase != ActionPhase::grasp &&
         action.phase != ActionPhase::lift && action.phase != ActionPhase::put_back;
}

}  // namespace

void SimWorld::announce(const ActionStatus& action) {
  Announcement announcement = Announcement::none;
  if (action.state == ActionState::running && is_offering(action))
    announcement = Announcement::offers;
  if (action.state == ActionState::running && action.kind == ActionKind::receive)
    announcement = Announcement::asks;
  impl_->people->announce(announcement, action.human, action.object);
}
bool SimWorld::listens() const { return impl_->people->any_reacts_to_announcements(); }
bool SimWorld::follows() const { return impl_->people->any_follows_source(); }

std::string SimWorld::control(const SimControl& c) { return impl_->control(c); }

const std::string& SimWorld::first_limit_violation() const {
  return impl_->limits.first_violation();
}
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
