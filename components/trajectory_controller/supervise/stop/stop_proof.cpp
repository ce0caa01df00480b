// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/stop/stop_proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/segments.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kMinLever =
    0.1;  // lever that converts the speed of a sliding axis to a turning rate [m/rad]
constexpr int kIntervals = StopSamples::kIntervals;

/// Returns the sum of a value over the axes.
double rate(const std::vector<Lever>& axes, const std::vector<double>& by_axis) noexcept {
  double out = 0.0;
  for (const Lever& lever : axes) out += by_axis[static_cast<std::size_t>(lever.axis)];
  return out;
}

double fastest_finger(const ChainCapsule& capsule, const std::vector<double>& by_axis) noexcept {
  double fastest = 0.0;
  for (const std::vector<Lever>& finger : capsule.fingers)
    fastest = std::max(fastest, rate(finger, by_axis));
  return fastest;
}

/// Returns the mass of the heaviest finger, at least `min_mass` [kg].
double finger_mass(const MovingChain& chain, double min_mass) {
  double mass = min_mass;
  for (const ChainCapsule& capsule : chain.capsules()) mass = std::max(mass, capsule.finger_mass);
  return mass;
}

/// Returns the distance between a link and a part of a person [m].
double distance_between(const CapsuleSample& link, double radius,
                        const PersonCapsule& part) noexcept {
  Vector3 on_robot, on_person;
  const double apart2 = nearest_points(link.a, link.b, part.a, part.b, on_robot, on_person);
  return std::sqrt(apart2) - radius - part.radius;
}

}  // namespace

StopProof::StopProof(const StopProofSettings& settings, const RobotModel& robot,
                     const std::vector<LinkCapsule>& capsules)
    : settings_(settings),
      limits_(robot.stop_limits()),
      chain_(robot, capsules),
      contact_(settings.contact, robot, settings.min_robot_mass,
               finger_mass(chain_, settings.min_finger_mass)),
      at_once_(robot, chain_.sliding()),
      robot_side_(robot, chain_.sliding()),
      bounds_(chain_, robot.dof()),
      free_space_(chain_, robot.dof()),
      samples_(chain_, robot.dof()),
      all_frames_(chain_.frames().size(), 1),
      motions_(chain_.frames().size()),
      at_rest_(Vector::Zero(robot.dof())),
      speed_(static_cast<std::size_t>(robot.dof())),
      turning_(speed_),
      jerk_(speed_) {
  pairs_.reserve(kMaxPairs);
}

/// Collects the links and parts that could touch faster than allowed, and computes the free space
/// of every capsule; false if there are too many to check.
bool StopProof::find_pairs(const PersonCapsules& people, const Pose& T_world_base,
                           double duration) noexcept {
  pairs_.clear();
  samples_.clear();
  const double margin = settings_.tracker_error + settings_.robot_error;
  PartReaches reach;
  reach_of_parts(people, duration, settings_.speed_error, settings_.people, reach);
  double max_person_speed = 0.0;
  for (const RegionMotion& region : settings_.people)
    max_person_speed = std::max(max_person_speed, region.speed);
  for (const PersonCapsule& part : people.capsules)
    max_person_speed = std::max(max_person_speed, part.fastest + settings_.speed_error);
  free_space_.set_max_person_speed(max_person_speed);
  for (std::size_t c = 0; c < chain_.capsules().size(); ++c) {
    const ChainCapsule& capsule = chain_.capsules()[c];
    const CapsuleSample at = placed(capsule, motions_, T_world_base);
    const Vector3 centre = 0.5 * (at.a + at.b);
    const double size = 0.5 * (at.b - at.a).norm() + capsule.radius, travel = bounds_.travel(c);
    double space = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < reach.count; ++p) {
      const PersonCapsule& part = people.capsules[p];
      const auto region = static_cast<std::size_t>(part.region);
      const double reached = margin + reach.distance[p];
      const double free = (part.centre - centre).norm() - reached - size - part.reach;
      space = std::min(space, free);
      if (free >= travel) continue;
      const double contact = contact_.of(bounds_.carried(c), bounds_.inner(c), region);
      if (contact <= contact_.max_speed(region)) continue;
      if (distance_between(at, capsule.radius, part) > reached + travel) continue;
      if (pairs_.size() >= kMaxPairs) return false;
      pairs_.push_back({static_cast<std::uint16_t>(c), static_cast<std::uint16_t>(p)});
      samples_.need(c);
    }
    free_space_.set(c, space);
  }
  return true;
}

/// Samples both stops until everything in a pair is at rest. Between two samples a link moves at
/// most at the faster speed of the two, plus the max change of speeds and levers within the
/// interval, and at most at the max axis speeds there times the levers, a tighter bound as axes
/// come to rest.
bool StopProof::check_stop(const StopPlan& stop, const Vector& position,
                           const PersonCapsules& people, const Pose& T_world_base,
                           double age) noexcept {
  if (!samples_.take(stop, position, T_world_base)) return true;
  for (std::vector<double>* by_axis : {&speed_, &turning_, &jerk_})
    std::fill(by_axis->begin(), by_axis->end(), 0.0);
  for (int k = 0; k < stop.count(); ++k) {
    const AxisStop& axis = stop[k];
    const auto i = static_cast<std::size_t>(axis.axis);
    speed_[i] = axis.max_speed;
    turning_[i] = axis.max_speed / (axis.sliding ? kMinLever : 1.0);
    jerk_[i] = limits_.jerk[axis.axis];
  }
  std::size_t last = chain_.capsules().size();
  Bend bend;
  for (const Pair& pair : pairs_) {
    if (pair.capsule != last) bend = bend_of(pair.capsule);
    last = pair.capsule;
    if (!check_pair(stop, pair, bend, people.capsules[pair.part], age)) return false;
  }
  return true;
}

StopProof::Bend StopProof::bend_of(std::size_t capsule) const noexcept {
  const ChainCapsule& link = chain_.capsules()[capsule];
  const double interval = samples_.interval();
  const double turning = rate(link.carried, turning_);
  const double inner_turning = fastest_finger(link, turning_);
  Bend bend;
  bend.inner_travel = bounds_.inner_travel(capsule);
  bend.carried = link.carried_bound(jerk_) * interval * interval / 8.0 +
                 link.carried_bound(speed_) * turning * interval / 2.0;
  bend.inner = link.inner_bound(jerk_) * interval * interval / 8.0 +
               link.inner_bound(speed_) * (turning + inner_turning) * interval / 2.0;
  return bend;
}

/// Returns whether a part of a person can be as near to a link as `needed` [m].
bool StopProof::is_within(const CapsuleSample& link, double radius, const PersonCapsule& part,
                          double needed) noexcept {
  const double apart = needed + radius + part.reach + 0.5 * (link.b - link.a).norm();
  if ((0.5 * (link.a + link.b) - part.centre).squaredNorm() > apart * apart) return false;
  refutation_.distance = distance_between(link, radius, part);
  return refutation_.distance <= needed;
}

bool StopProof::check_pair(const StopPlan& stop, const Pair& pair, const Bend& bend,
                           const PersonCapsule& part, double age) noexcept {
  const ChainCapsule& link = chain_.capsules()[pair.capsule];
  const auto region = static_cast<std::size_t>(part.region);
  const RegionMotion& bounds = settings_.people[region];
  const double margin = settings_.tracker_error + settings_.robot_error;
  const double from = start_speed(part, settings_.speed_error, bounds);
  const double interval = samples_.interval(), allowed = contact_.max_speed(region);
  for (int slot = 0; slot < kIntervals; ++slot) {
    const CapsuleSample& first = samples_.at(slot, pair.capsule);
    const CapsuleSample& second = samples_.at(slot + 1, pair.capsule);
    double carried = std::max(first.carried, second.carried) + bend.carried;
    double inner = std::max(first.inner, second.inner);
    if (inner > 0.0) inner += bend.inner;
    if (contact_.of(carried, inner, region) <= allowed) continue;
    const std::vector<double>& speeds = samples_.speeds(stop, slot);
    carried = std::min(carried, link.carried_bound(speeds));
    inner = std::min(inner, link.inner_bound(speeds));
    const double contact = contact_.of(carried, inner, region);
    if (contact <= allowed) continue;
    // Within the interval the link stays within half of its max travel of its position at one of
    // the two ends.
    const double time = (slot + 1) * interval + settings_.latency + age + part.age;
    const double needed = (carried + inner) * interval / 2.0 + bend.inner_travel + margin +
                          reach_after(time, from, bounds);
    if (!is_within(first, link.radius, part, needed) &&
        !is_within(second, link.radius, part, needed))
      continue;
    const double distance = refutation_.distance;
    refutation_ = {link.link, slot * interval, contact, allowed, distance, needed};
    return false;
  }
  return true;
}

bool StopProof::check(const MotionState3& state, const PersonCapsules& people,
                      const Pose& T_world_base, double age, double payload) noexcept {
  at_once_.plan(state, 0.0);
  if (at_once_.count() == 0) return true;
  robot_side_.plan(state, settings_.robot_side_delay);
  bounds_.set(at_once_, robot_side_);
  refutation_ = {};
  if (!settings_.enabled) return true;
  if (!at_once_.inside()) return false;
  if (people.capsules.empty()) return true;
  contact_.set_payload(payload);
  const double stop_time = std::max(at_once_.duration(), robot_side_.duration());
  const double duration = stop_time + settings_.latency + age;
  if (free_space_.is_of(people.revision, T_world_base) &&
      free_space_.suffices(bounds_, state.position, duration, contact_.min_speed()))
    return true;
  chain_.enclose_hands(state.position);
  chain_.move(state.position, at_rest_, all_frames_, motions_);
  free_space_.begin(people.revision, T_world_base, state.position, duration);
  if (!find_pairs(people, T_world_base, duration)) return false;
  if (pairs_.empty()) return true;
  return check_stop(at_once_, state.position, people, T_world_base, age) &&
         check_stop(robot_side_, state.position, people, T_world_base, age);
}

}  // namespace handsel::trajectory_controller
