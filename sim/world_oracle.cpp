// SPDX-License-Identifier: Apache-2.0
// Evaluation of the emulated world: collisions, separation, the handover, ground truth.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "common/model/platform.hpp"
#include "sim/world_parts.hpp"

namespace handsel::sim {

namespace {

// Max overlap of a person's fist and a robot's hand before both hold the object [m].
constexpr double kMaxHandOverlap = 0.002;
constexpr double kMaxFloorHeight = 0.02;  // max height of the origin of an object on the floor [m]

}  // namespace

void SimWorld::Impl::evaluate() {
  bool collided = false;
  for (const Touch& t : touches) {
    if (t.a != Owner::robot) continue;
    const bool by_hand = of_hand(t.index_a);
    if (t.b == Owner::object && by_hand) continue;
    const bool complies = t.b == Owner::person && people->complies(t.index_b);
    const bool hands_meet =
        complies && (people->has_digits(t.index_b) ? t.normal_force >= settings.collision_force
                                                   : t.distance < -kMaxHandOverlap);
    const bool hands_collide = hands_meet && by_hand && handover && !handover->shared();
    if (!hands_collide && (complies || t.normal_force < settings.collision_force)) continue;
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

  update_robot_hands();
  people->volumes(robot_hands, person_volumes);
  near = separations.separation(*robot, person_volumes);
  min_separation = std::min(min_separation, near.distance);
  if (near.link >= 0 && near.distance < 0.5) {
    const Vector3 n = (near.on_person - near.on_robot).stableNormalized();
    const Vector3 v =
        robot->point_velocity(robot->body_of(near.link), near.on_robot) - near.person_velocity;
    closing.add(v.dot(n));
  }
  const bool is_person_pushing = is_pushed();
  if (steps % ssm_every == 0 && !is_person_pushing &&
      separations.violates(near, *robot, reference.velocity, reference.acceleration))
    ssm_violations += ssm_every;

  if (watched >= 0) {
    handover->observe(situation(), settings.step);
    taking.observe(grips(watched), taker());
  }
  if (steps % ssm_every == 0) measure_other_robots();
  add_to_hash();
}

void SimWorld::Impl::measure_other_robots() {
  if (other_robots.empty()) return;
  for (OtherRobotBody& other : other_robots) {
    other.place(now());
    const double distance = other.distance(robot_hull, robot->T_world_links());
    min_robot_distance = std::min(min_robot_distance, distance);
    if (distance >= 0) continue;
    collisions += static_cast<std::uint64_t>(ssm_every);
    last_collision = "the robot meets robot " + other.id();
  }
}

/// Returns whether a person pushes the robot, or did so within kPushDuration, and the robot does
/// not press against the person. During a push the person moves the arm, and the volumes of hand
/// and arm overlap.
bool SimWorld::Impl::is_pushed() {
  const auto person = [](const Touch& t) {
    return t.a == Owner::robot && t.b == Owner::person && t.normal_force > 0;
  };
  if (std::any_of(touches.begin(), touches.end(), person)) {
    pushed_at = now();
    pushes.clear();
    std::copy_if(touches.begin(), touches.end(), std::back_inserter(pushes), person);
  }
  return now() < pushed_at + kPushDuration &&
         !separations.presses(*robot, pushes, reference.velocity);
}

ObjectSituation SimWorld::Impl::situation() const {
  ObjectSituation s;
  const ObjectBody& object = objects[watched];
  s.height = object.state().T_world_body.translation().z();
  s.robot_grips = grips(watched);
  s.on_floor = object.T_world_object().translation().z() < kMaxFloorHeight;
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

std::optional<Taker> SimWorld::Impl::taker() const {
  const int number = people->touching_person(watched);
  if (number < 0) return std::nullopt;
  const auto holds_it = [this](const RobotHandState& hand) { return hand.gripped == watched; };
  const auto held = std::find_if(robot_hands.begin(), robot_hands.end(), holds_it);
  const RobotHandState& hand = held != robot_hands.end() ? *held : robot_hands.front();
  const PersonModel& person = people->model(static_cast<std::size_t>(number));
  return Taker{&person.body(), person.side(), &objects[watched].model(),
               objects[watched].T_world_object(), hand.palm.T_world_body.translation()};
}

void SimWorld::Impl::add_to_hash() {
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

void SimWorld::ground_truth(GroundTruth& out) const {
  const Impl& w = *impl_;
  out.sim_time = w.now();
  if (w.watched >= 0) {
    out.object = w.objects[w.watched].start().id;
    out.T_world_object = w.objects[w.watched].T_world_object();
    w.handover->write(out);
    w.taking.write(out);
    out.hold = !w.grips(w.watched) ? "" : w.constraint_carries ? "constraint" : "contact";
    out.held_time = w.held_time;
    out.constraint_time = w.constraint_time;
  }
  out.separation = w.near.distance;
  out.min_separation = w.min_separation;
  out.min_robot_distance = w.min_robot_distance;
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
  const Group* platform = w.model.group(kPlatformGroup);
  const auto of_platform = [platform](Eigen::Index axis) {
    return platform != nullptr &&
           std::find(platform->axes.begin(), platform->axes.end(), axis) != platform->axes.end();
  };
  const auto of_arm = [](const Impl::Hand& hand, Eigen::Index axis) {
    return hand.arm == nullptr ||
           std::find(hand.arm->axes.begin(), hand.arm->axes.end(), axis) != hand.arm->axes.end();
  };
  for (Eigen::Index i = 0; i < w.robot->velocity().size(); ++i) {
    const bool is_monitored =
        of_platform(i) || std::any_of(w.hands.begin(), w.hands.end(),
                                      [&](const Impl::Hand& hand) { return of_arm(hand, i); });
    if (is_monitored && std::abs(w.robot->velocity()[i]) > 1e-3) out.robot_moving = true;
  }
  out.person.clear();
  double min_distance = std::numeric_limits<double>::infinity();
  const Vector3 p_world_robot =
      T_world_platform(w.model, w.robot->position(), w.setup.T_world_base).translation();
  for (std::size_t p = 0; p < w.people->size(); ++p) {
    const Person& person = w.people->model(p).body();
    const double d = (person.joints.front().position - p_world_robot).norm();
    if (d < min_distance) min_distance = d, out.person = person.joints;
  }
}

}  // namespace handsel::sim
