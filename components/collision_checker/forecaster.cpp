// SPDX-License-Identifier: Apache-2.0
#include "components/collision_checker/forecaster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/manipulator.hpp"

namespace handsel::collision_checker {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMaxOtherMotion = 0.01;  // max motion of other axes with cached results [rad]
constexpr double kMaxRestMotion = 1e-3;   // max motion of a robot at rest [rad]
constexpr double kMaxClearance = 5.0;     // max clearance computed by a query [m]

std::string contact(const CollisionVerdict& verdict) {
  return verdict.first + " touches " + verdict.second;
}

bool same(const Attachment& a, const Attachment& b) {
  return a.object == b.object &&
         (a.object.empty() || a.T_tool_object.isApprox(b.T_tool_object, 1e-4));
}

bool same(const Trajectory& a, const Trajectory& b) {
  const auto same_segment = [](const Segment& s, const Segment& t) {
    return s.duration == t.duration && s.jerk == t.jerk;
  };
  const auto same_axis = [&](const AxisTrajectory& s, const AxisTrajectory& t) {
    return s.start.position == t.start.position && s.start.velocity == t.start.velocity &&
           s.start.acceleration == t.start.acceleration &&
           std::equal(s.segments.begin(), s.segments.end(), t.segments.begin(), t.segments.end(),
                      same_segment);
  };
  return std::equal(a.axes.begin(), a.axes.end(), b.axes.begin(), b.axes.end(), same_axis);
}

}  // namespace

MeasuredFingers::MeasuredFingers(const RobotModel& robot) {
  for (const Manipulator& hand : hands_of(robot))
    if (hand.fingers != nullptr)
      axes_.insert(axes_.end(), hand.fingers->axes.begin(), hand.fingers->axes.end());
}

Vector MeasuredFingers::in(Vector q) const {
  if (measured_.size() == q.size())
    for (const int axis : axes_) q[axis] = measured_[axis];
  return q;
}

Forecaster::Forecaster(const RobotModel& robot, ObjectLibrary library, CostSettings cost,
                       ForecastSettings settings)
    : robot_(robot),
      settings_(settings),
      world_(robot, std::move(library)),
      cost_(robot, cost),
      fingers_(robot),
      capsules_(robot_capsules(robot)),
      other_robots_(robot, settings.robot_ahead) {}

void Forecaster::set_scene(const Scene& scene) {
  const bool moved = !scene.T_world_base.isApprox(T_world_base_, 1e-6);
  world_.set_scene(scene);
  if (scene.robot_known) {
    T_world_base_ = scene.T_world_base;
    cost_.set_base(T_world_base_);
    fingers_.set(scene.robot_position);
  }
  if (moved || scene.revision != revision_) memory_.clear();
  revision_ = scene.revision;
  rest_.forecast.reset();
}

void Forecaster::set_people(const HumanState& people) {
  other_robots_.set(people.robots);
  HumanState without_robots = people;
  without_robots.robots.clear();
  world_.set_people(without_robots, PeopleParts::without_forearms_and_hands);
  cost_.set_people(people);
  hands_.clear();
  for (const Person& person : people.people)
    for (const HandPrediction& hand : person.hands) {
      const BodyPart part = hand.joint == "l_hand" ? BodyPart::hand_left : BodyPart::hand_right;
      const auto joint = std::find_if(person.joints.begin(), person.joints.end(),
                                      [&](const BodyJoint& j) { return j.name == hand.joint; });
      if (joint == person.joints.end()) continue;
      Hand& known = hands_.emplace_back();
      for (const BodyCapsule& capsule : body_capsules(person))
        if (capsule.part == part) known.radius = capsule.radius;
      known.motion.push_back({0, joint->position, 0});
      known.motion.insert(known.motion.end(), hand.ahead.begin(), hand.ahead.end());
    }
  rest_.forecast.reset();
}

void Forecaster::set_layers(LayersNow layers) {
  cost_.set_layers(std::move(layers));
  rest_.forecast.reset();
}

bool Forecaster::fits(const ActiveTrajectory& active) const {
  if (active.position.size() != robot_.dof()) return false;
  if (static_cast<int>(active.axes.size()) != active.rest.size()) return false;
  return std::all_of(active.axes.begin(), active.axes.end(),
                     [this](std::uint32_t axis) { return static_cast<int>(axis) < robot_.dof(); });
}

void Forecaster::remember_for(const ActiveTrajectory& active, const Vector& now) {
  Vector others = now;
  for (std::uint32_t axis : active.axes) others[axis] = 0;
  const bool known = !memory_.empty() && trajectory_ == active.trajectory &&
                     same(attachment_, active.attachment) && allowed_ == active.allowed_contacts &&
                     same(path_, active.rest) && others_.size() == others.size() &&
                     (others - others_).cwiseAbs().maxCoeff() < kMaxOtherMotion;
  if (known) return;
  if (!same(attachment_, active.attachment) || allowed_ != active.allowed_contacts ||
      trajectory_ != active.trajectory)
    world_.set_attachment(active.attachment, active.allowed_contacts);
  world_.set_moving_axes({active.axes.begin(), active.axes.end()});
  trajectory_ = active.trajectory;
  attachment_ = active.attachment;
  allowed_ = active.allowed_contacts;
  others_ = others;
  path_ = active.rest;
  const std::size_t states =
      2 + static_cast<std::size_t>(active.rest.duration() / settings_.spacing);
  memory_.assign(states, Memory::unknown);
  contacts_.assign(states, {});
  sample_.position.resize(active.rest.size());
  sample_.velocity.resize(active.rest.size());
  sample_.acceleration.resize(active.rest.size());
}

CollisionVerdict Forecaster::scene_verdict(std::size_t index, const Vector& q) {
  if (memory_[index] == Memory::unknown) {
    contacts_[index] = world_.check_scene(q);
    memory_[index] = contacts_[index].free ? Memory::free : Memory::collides;
  }
  return contacts_[index];
}

/// Returns the clearance of the links at the poses in `links_`.
double Forecaster::distance_to_ball(const Vector3& centre, double radius) const {
  double min_clearance = kInfinity;
  for (const LinkCapsule& capsule : capsules_) {
    const Pose T = T_world_base_ * links_[static_cast<std::size_t>(capsule.link)];
    min_clearance =
        std::min(min_clearance, segment_distance(T * capsule.a, T * capsule.b, centre, centre) -
                                    capsule.radius - radius);
  }
  return min_clearance;
}

void Forecaster::sample_at(const Vector& q, double ahead, TrajectoryForecast& forecast) {
  forecast.clearance = std::min(forecast.clearance, world_.distance_to_people(q));
  if (!hands_.empty()) robot_.forward(q, links_);
  for (const Hand& hand : hands_) {
    const auto next = std::find_if(hand.motion.begin(), hand.motion.end(),
                                   [&](const HandAhead& h) { return h.time > ahead; });
    if (next == hand.motion.begin() || next == hand.motion.end()) continue;
    const HandAhead& before = *std::prev(next);
    const double fraction = (ahead - before.time) / (next->time - before.time);
    const Vector3 expected = (1 - fraction) * before.position + fraction * next->position;
    forecast.clearance = std::min(forecast.clearance, distance_to_ball(expected, hand.radius));
  }
  if (cost_.concerned()) forecast.cost = std::clamp(cost_(q), forecast.cost, 1.0);
}

TrajectoryForecast Forecaster::forecast(const ActiveTrajectory& active) {
  TrajectoryForecast forecast;
  forecast.trajectory = active.trajectory;
  forecast.time_to_collision = kInfinity;
  forecast.clearance = kInfinity;
  if (!fits(active)) {
    forecast.collides = true;
    forecast.time_to_collision = 0;
    forecast.clearance = 0;
    forecast.reason = "the running trajectory does not fit the robot " + robot_.name();
    return forecast;
  }
  const Vector now = fingers_.in(active.position);
  const double duration = active.rest.duration();
  const bool backward = active.speed_factor < 0;
  if (active.trajectory == 0 || active.rest.size() == 0 || (!backward && active.time >= duration)) {
    const bool stood = rest_.forecast && rest_.position.size() == now.size() &&
                       (rest_.position - now).cwiseAbs().maxCoeff() < kMaxRestMotion;
    if (!stood) {
      if (!same(attachment_, active.attachment) || allowed_ != active.allowed_contacts)
        remember_for(active, now);
      rest_.forecast = forecast;
      sample_at(now, 0, *rest_.forecast);
      rest_.position = now;
    }
    rest_.forecast->trajectory = active.trajectory;
    return *rest_.forecast;
  }
  remember_for(active, now);
  rest_.forecast.reset();
  const double speed = std::max(std::abs(active.speed_factor), settings_.min_speed);
  const double reach = speed * settings_.horizon, spacing = settings_.spacing;
  const auto index_at = [&](double t) {
    return static_cast<long>(std::clamp(t, 0.0, duration) / spacing);
  };
  const long last_index = static_cast<long>(std::ceil(duration / spacing));
  // States lie on a fixed grid of the trajectory's time; the first is the next state in the
  // direction of motion.
  const long first =
      backward ? index_at(active.time) : std::min(last_index, index_at(active.time) + 1);
  const long end = backward ? index_at(active.time - reach)
                            : std::min(last_index, index_at(active.time + reach) + 1);
  sample_at(now, 0, forecast);
  // Robots that are too near to each other may move apart.
  const double allowed = std::min(
      0.0, other_robots_.approach(now, T_world_base_, 0).distance - settings_.min_approach);
  Vector q = now;
  for (long k = first;; k += backward ? -1 : 1) {
    const double t = std::min(duration, static_cast<double>(k) * spacing);
    active.rest.sample(t, sample_);
    for (std::size_t i = 0; i < active.axes.size(); ++i)
      q[active.axes[i]] = sample_.position[static_cast<Eigen::Index>(i)];
    CollisionVerdict verdict = scene_verdict(static_cast<std::size_t>(k), q);
    if (verdict.free) verdict = world_.check_people(q);
    const double ahead = std::max(0.0, std::abs(t - active.time) / speed);
    const RobotApproach at = other_robots_.approach(q, T_world_base_, ahead);
    if (verdict.free && at.distance < allowed)
      verdict = {false, "link " + at.link, "robot " + at.robot, at.robot};
    sample_at(q, ahead, forecast);
    if (!verdict.free) {
      forecast.collides = true;
      forecast.time_to_collision = ahead;
      forecast.reason = contact(verdict);
      break;
    }
    if (k == end) break;
  }
  return forecast;
}

StateVerdict check_states(const RobotModel& robot, CollisionWorld& world, const StateQuery& query) {
  StateVerdict verdict;
  verdict.id = query.id;
  verdict.clearance = kInfinity;
  if (query.states.empty()) verdict.reason = "the query has no states";
  world.set_attachment(query.attachment, query.allowed_contacts);
  for (const Vector& q : query.states) {
    CollisionVerdict one;
    std::string why;
    if (q.size() != robot.dof()) {
      why = "a state has " + std::to_string(q.size()) + " axes, the robot has " +
            std::to_string(robot.dof());
    } else if (one = world.check(q); !one.free) {
      why = contact(one);
    }
    verdict.free.push_back(why.empty() ? 1 : 0);
    if (verdict.reason.empty()) verdict.reason = why;
    if (why.empty())
      verdict.clearance =
          std::min({verdict.clearance, world.distance_to_people(q),
                    world.distance_to_scene(q, std::min(kMaxClearance, verdict.clearance))});
  }
  return verdict;
}

}  // namespace handsel::collision_checker
