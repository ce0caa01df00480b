#include "components/trajectory_controller/supervise/stop/stop_proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/segments.hpp"
#include "common/trajectory/stop.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kRounding = 1e-9;    // [rad, m]
constexpr double kBoundSlack = 1e-6;  // [rad, m] by which trajectories may touch a bound
constexpr double kMinLever = 0.1;     // [m] per radian, to count sliding axes with turning ones

/// Sum of a value over axes.
double rate(const std::vector<Lever>& axes, const std::vector<double>& by_axis) noexcept {
  double out = 0.0;
  for (const Lever& lever : axes) out += by_axis[static_cast<std::size_t>(lever.axis)];
  return out;
}

double fastest_finger(const ChainCapsule& capsule, const std::vector<double>& by_axis) noexcept {
  double most = 0.0;
  for (const std::vector<Lever>& finger : capsule.fingers) most = std::max(most, rate(finger, by_axis));
  return most;
}

/// Half of the mass that the axes move (ISO/TS 15066:2016, A.3.4) [kg].
double half_moving_mass(const RobotModel& robot) {
  std::vector<char> moves(robot.links().size(), 0);
  double mass = 0.0;
  for (const Joint& joint : robot.joints()) {
    const auto child = static_cast<std::size_t>(joint.child);
    moves[child] = moves[static_cast<std::size_t>(joint.parent)] || (joint.kind != JointKind::fixed && joint.dof >= 0);
    if (moves[child]) mass += robot.links()[child].mass;
  }
  return 0.5 * mass;
}

}  // namespace

StopProof::StopProof(const StopProofSettings& settings, const RobotModel& robot, const std::vector<LinkCapsule>& capsules)
    : settings_(settings),
      limits_(robot.stop_limits()),
      chain_(robot, capsules),
      moving_mass_(half_moving_mass(robot)),
      paired_(chain_.capsules().size(), 0),
      all_frames_(chain_.frames().size(), 1),
      needed_frames_(chain_.frames().size(), 0),
      position_(Vector::Zero(robot.dof())),
      velocity_(Vector::Zero(robot.dof())),
      motions_(chain_.frames().size()) {
  for (std::vector<double>* by_axis : {&travel_, &other_travel_, &speed_, &turning_, &jerk_, &moved_, &now_, &time_})
    by_axis->resize(static_cast<std::size_t>(robot.dof()));
  for (const Axis& axis : robot.axes()) {
    lower_.push_back(axis.lower);
    upper_.push_back(axis.upper);
  }
  for (const ChainCapsule& capsule : chain_.capsules()) finger_mass_ = std::max(finger_mass_, capsule.finger_mass);
  finger_mass_ = std::max(finger_mass_, settings_.min_finger_mass);
  pairs_.reserve(kMaxPairs);
  max_travel_.resize(paired_.size());
  max_carried_.resize(paired_.size());
  max_inner_.resize(paired_.size());
  room_.resize(paired_.size());
  room_position_ = position_;
  for (auto& of_time : samples_) of_time.resize(chain_.capsules().size());
  for (auto& of_time : speeds_) of_time.resize(static_cast<std::size_t>(robot.dof()));
}

double StopProof::max_speed_at(BodyRegion region, double payload) const noexcept {
  return max_contact_speed(settings_.contact[static_cast<std::size_t>(region)],
                           std::max(settings_.min_robot_mass, moving_mass_ + std::max(0.0, payload)));
}

double StopProof::finger_ratio_at(BodyRegion region, double payload) const noexcept {
  const ContactLimit& limit = settings_.contact[static_cast<std::size_t>(region)];
  const double arm_mass = std::max(settings_.min_robot_mass, moving_mass_ + std::max(0.0, payload));
  return std::sqrt(reduced_mass(limit, finger_mass_) / reduced_mass(limit, arm_mass));
}

/// Returns the speed of the arm whose contact has the energy of the arm's and the fingers' together: these are light.
double StopProof::contact_speed(double carried, double inner, std::size_t region) const noexcept {
  return inner == 0.0 ? carried : std::hypot(carried, finger_ratio_[region] * inner);
}

AxisState StopProof::AxisStop::at(double t) const noexcept {
  if (t < delay) return advanced(start, t, 0.0);
  AxisState s = advanced(start, delay, 0.0);
  t -= delay;
  for (int k = 0; k < profile.count; ++k) {
    const Segment& segment = profile.segments[static_cast<std::size_t>(k)];
    if (t < segment.duration) return advanced(s, t, segment.jerk);
    s = advanced(s, segment.duration, segment.jerk);
    t -= segment.duration;
  }
  return {s.position, 0.0, 0.0};
}

/// Within a segment of constant jerk the speed is largest at an end, or where the acceleration changes its sign.
double StopProof::AxisStop::max_speed_between(double from, double to) const noexcept {
  double most = 0.0, begin = 0.0;
  AxisState s = start;
  const auto look = [&](double length, double jerk) {
    const double first = std::clamp(from - begin, 0.0, length), last = std::clamp(to - begin, 0.0, length);
    if (first < last) {
      most = std::max({most, std::abs(advanced(s, first, jerk).velocity), std::abs(advanced(s, last, jerk).velocity)});
      const double turn = jerk == 0.0 ? -1.0 : -s.acceleration / jerk;
      if (turn > first && turn < last) most = std::max(most, std::abs(advanced(s, turn, jerk).velocity));
    }
    s = advanced(s, length, jerk);
    begin += length;
  };
  if (delay > 0.0) look(delay, 0.0);
  for (int k = 0; k < profile.count; ++k) {
    const Segment& segment = profile.segments[static_cast<std::size_t>(k)];
    look(segment.duration, segment.jerk);
  }
  return most;
}

void StopProof::position_at(bool robot_side, double time, Vector& position) const noexcept {
  const Stop& stop = robot_side ? robot_side_ : at_once_;
  for (int k = 0; k < stop.count; ++k) {
    const AxisStop& axis = stop.axes[static_cast<std::size_t>(k)];
    position[axis.axis] = axis.at(time).position;
  }
}

/// Every axis goes on with its acceleration for `delay`, then stops by itself.
void StopProof::plan(const MotionState3& state, double delay, Stop& stop) const noexcept {
  stop.count = 0;
  stop.inside = true;
  stop.duration = 0.0;
  const int dof = std::min<int>(static_cast<int>(state.position.size()), kMaxAxes);
  for (int i = 0; i < dof; ++i) {
    if (state.velocity[i] == 0.0 && state.acceleration[i] == 0.0) continue;
    AxisStop& axis = stop.axes[static_cast<std::size_t>(stop.count++)];
    axis.axis = i;
    axis.sliding = chain_.sliding()[static_cast<std::size_t>(i)];
    axis.start = {state.position[i], state.velocity[i], state.acceleration[i]};
    axis.delay = delay;
    AxisState s = advanced(axis.start, delay, 0.0);
    // Bounds: within a segment of constant jerk the speed is largest at an end, or less than |a| t / 2 beyond it.
    axis.max_speed = std::max(std::abs(axis.start.velocity), std::abs(s.velocity));
    axis.travel = axis.max_speed * delay;
    critical_movement(s.velocity, s.acceleration, 0.0, 0.0, limits_.acceleration[i], limits_.jerk[i], axis.profile);
    axis.duration = delay;
    for (int k = 0; k < axis.profile.count; ++k) {
      const Segment& segment = axis.profile.segments[static_cast<std::size_t>(k)];
      const AxisState next = advanced(s, segment.duration, segment.jerk);
      double fastest = std::max(std::abs(s.velocity), std::abs(next.velocity));
      if (s.acceleration * next.acceleration < 0.0)
        fastest = std::max(fastest, std::abs(s.velocity - 0.5 * s.acceleration * s.acceleration / segment.jerk));
      axis.max_speed = std::max(axis.max_speed, fastest);
      axis.travel += fastest * segment.duration;
      axis.duration += segment.duration;
      s = next;
    }
    stop.duration = std::max(stop.duration, axis.duration);
    stop.inside = stop.inside && ends_inside(i, axis.start.position, s.position);
  }
}

/// Whether an axis that is inside its bounds comes to rest inside them.
bool StopProof::ends_inside(int axis, double start, double end) const noexcept {
  const double low = lower_[static_cast<std::size_t>(axis)], high = upper_[static_cast<std::size_t>(axis)];
  if (!(low < high) || start < low - kBoundSlack || start > high + kBoundSlack) return true;
  return end >= low - kBoundSlack - kRounding && end <= high + kBoundSlack + kRounding;
}

StopProof::Sample StopProof::placed(const ChainCapsule& capsule, const Pose& T_world_base) const noexcept {
  const FrameMotion& frame = motions_[static_cast<std::size_t>(capsule.frame)];
  return {T_world_base * (frame.p + frame.R * capsule.a), T_world_base * (frame.p + frame.R * capsule.b), 0.0};
}

void StopProof::set_speeds(const ChainCapsule& capsule, Sample& sample) const noexcept {
  const FrameMotion& frame = motions_[static_cast<std::size_t>(capsule.frame)];
  const Vector3 a = frame.linear + frame.angular.cross(frame.R * capsule.a), b = frame.linear + frame.angular.cross(frame.R * capsule.b);
  sample.carried = std::sqrt(std::max(a.squaredNorm(), b.squaredNorm())) + frame.angular.norm() * capsule.radius;
  sample.inner = capsule.fingers.empty() ? 0.0 : capsule.inner_bound(now_);
}

void StopProof::sample(const Stop& stop, double time, const Pose& T_world_base, int slot) noexcept {
  for (int k = 0; k < stop.count; ++k) {
    const AxisStop& axis = stop.axes[static_cast<std::size_t>(k)];
    const AxisState s = axis.at(time);
    position_[axis.axis] = s.position;
    velocity_[axis.axis] = s.velocity;
    now_[static_cast<std::size_t>(axis.axis)] = std::abs(s.velocity);
  }
  chain_.move(position_, velocity_, needed_frames_, motions_);
  std::vector<Sample>& out = samples_[static_cast<std::size_t>(slot)];
  for (std::size_t c = 0; c < paired_.size(); ++c)
    if (paired_[c]) {
      out[c] = placed(chain_.capsules()[c], T_world_base);
      set_speeds(chain_.capsules()[c], out[c]);
    }
}

/// Returns when everything that is in a pair is at rest. Axes that carry none of it, as those of the head, may take longer.
double StopProof::time_until_rest(const Stop& stop) noexcept {
  std::fill(time_.begin(), time_.end(), 0.0);
  for (int k = 0; k < stop.count; ++k) {
    const AxisStop& axis = stop.axes[static_cast<std::size_t>(k)];
    time_[static_cast<std::size_t>(axis.axis)] = axis.duration;
  }
  double longest = 0.0;
  const auto look = [&](const std::vector<Lever>& levers) {
    for (const Lever& lever : levers) longest = std::max(longest, time_[static_cast<std::size_t>(lever.axis)]);
  };
  for (std::size_t c = 0; c < paired_.size(); ++c) {
    if (!paired_[c]) continue;
    look(chain_.capsules()[c].carried);
    for (const std::vector<Lever>& finger : chain_.capsules()[c].fingers) look(finger);
  }
  return longest;
}

/// Returns the largest speed of every axis between a sample and the next.
const std::vector<double>& StopProof::speeds_between(const Stop& stop, int slot, double interval) noexcept {
  const auto k = static_cast<std::size_t>(slot);
  if (speeds_known_[k]) return speeds_[k];
  speeds_known_[k] = true;
  std::fill(speeds_[k].begin(), speeds_[k].end(), 0.0);
  for (int i = 0; i < stop.count; ++i) {
    const AxisStop& axis = stop.axes[static_cast<std::size_t>(i)];
    speeds_[k][static_cast<std::size_t>(axis.axis)] = axis.max_speed_between(slot * interval, (slot + 1) * interval);
  }
  return speeds_[k];
}

/// Marks a frame and those that carry it.
void StopProof::need(int frame) noexcept {
  for (; frame >= 0 && !needed_frames_[static_cast<std::size_t>(frame)]; frame = chain_.frames()[static_cast<std::size_t>(frame)].parent)
    needed_frames_[static_cast<std::size_t>(frame)] = 1;
}

/// Bounds of the travel and the speed of every capsule during both stops.
void StopProof::bound_motion() noexcept {
  for (std::vector<double>* by_axis : {&travel_, &other_travel_, &speed_}) std::fill(by_axis->begin(), by_axis->end(), 0.0);
  for (int k = 0; k < at_once_.count; ++k) {
    const AxisStop &a = at_once_.axes[static_cast<std::size_t>(k)], &b = robot_side_.axes[static_cast<std::size_t>(k)];
    const auto axis = static_cast<std::size_t>(a.axis);
    travel_[axis] = a.travel;
    other_travel_[axis] = b.travel;
    speed_[axis] = std::max(a.max_speed, b.max_speed);
  }
  for (std::size_t c = 0; c < paired_.size(); ++c) {
    const ChainCapsule& capsule = chain_.capsules()[c];
    max_travel_[c] = std::max(capsule.bound(travel_), capsule.bound(other_travel_));
    max_carried_[c] = capsule.carried_bound(speed_);
    max_inner_[c] = capsule.inner_bound(speed_);
  }
}

/// Whether every capsule is still so far from everybody that nobody reaches it: how far each was when rooms were last measured, less how
/// far it has come since.
bool StopProof::far_from_everybody(const MotionState3& state, double duration) noexcept {
  const double grown = std::max(0.0, duration - room_duration_) * max_person_speed_;
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    moved_[i] = std::abs(state.position[k] - room_position_[k]);
  }
  for (std::size_t c = 0; c < paired_.size(); ++c) {
    if (max_carried_[c] + max_inner_[c] <= min_contact_speed_) continue;
    if (!(max_travel_[c] + chain_.capsules()[c].bound(moved_) + grown <= room_[c])) return false;
  }
  return true;
}

/// Collects the links and parts that could touch faster than allowed, and measures the room of every capsule; false when there are too many
/// to check.
bool StopProof::find_pairs(const PersonCapsules& people, const Pose& T_world_base, double duration) noexcept {
  pairs_.clear();
  std::fill(paired_.begin(), paired_.end(), 0);
  std::fill(needed_frames_.begin(), needed_frames_.end(), 0);
  const double margin = settings_.tracker_error + settings_.robot_error;
  PartReaches reach;
  reach_of_parts(people, duration, settings_.speed_error, settings_.people, reach);
  max_person_speed_ = 0.0;
  for (const RegionMotion& region : settings_.people) max_person_speed_ = std::max(max_person_speed_, region.speed);
  for (const PersonCapsule& part : people.capsules) max_person_speed_ = std::max(max_person_speed_, part.fastest + settings_.speed_error);
  for (std::size_t c = 0; c < paired_.size(); ++c) {
    const ChainCapsule& capsule = chain_.capsules()[c];
    const Sample at = placed(capsule, T_world_base);
    const Vector3 centre = 0.5 * (at.a + at.b);
    const double size = 0.5 * (at.b - at.a).norm() + capsule.radius, travel = max_travel_[c];
    double room = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < reach.count; ++p) {
      const PersonCapsule& part = people.capsules[p];
      const double reached = margin + reach.distance[p];
      const double free = (part.centre - centre).norm() - reached - size - part.reach;
      room = std::min(room, free);
      if (free >= travel || contact_speed(max_carried_[c], max_inner_[c], static_cast<std::size_t>(part.region)) <=
                                max_contact_speed_[static_cast<std::size_t>(part.region)])
        continue;
      Vector3 on_robot, on_person;
      const double distance = std::sqrt(nearest_points(at.a, at.b, part.a, part.b, on_robot, on_person)) - capsule.radius - part.radius;
      if (distance > reached + travel) continue;
      if (pairs_.size() >= kMaxPairs) return false;
      pairs_.push_back({static_cast<std::uint16_t>(c), static_cast<std::uint16_t>(p)});
      paired_[c] = 1;
      need(capsule.frame);
    }
    room_[c] = room;
  }
  return true;
}

/// Samples both until everything in a pair is at rest. Between two samples a link moves no faster than the faster of them, but for how much
/// speeds and levers may bend within the interval; nor faster than the largest speeds of its axes there at their levers, which says more
/// where axes come to rest.
bool StopProof::check_stop(const Stop& stop, const Vector& position, const PersonCapsules& people, const Pose& T_world_base,
                           double age) noexcept {
  const double until_rest = time_until_rest(stop);
  if (until_rest == 0.0) return true;
  const double interval = until_rest / kIntervals;
  position_ = position;
  velocity_.setZero();
  std::fill(now_.begin(), now_.end(), 0.0);
  for (int slot = 0; slot <= kIntervals; ++slot) sample(stop, slot * interval, T_world_base, slot);
  const double margin = settings_.tracker_error + settings_.robot_error;
  for (std::vector<double>* by_axis : {&speed_, &turning_, &jerk_}) std::fill(by_axis->begin(), by_axis->end(), 0.0);
  for (int k = 0; k < stop.count; ++k) {
    const AxisStop& axis = stop.axes[static_cast<std::size_t>(k)];
    const auto i = static_cast<std::size_t>(axis.axis);
    speed_[i] = axis.max_speed;
    turning_[i] = axis.max_speed / (axis.sliding ? kMinLever : 1.0);
    jerk_[i] = limits_.jerk[axis.axis];
  }
  std::size_t last = paired_.size();
  speeds_known_.fill(false);
  double bend = 0.0, inner_bend = 0.0, inner_travel = 0.0;  // inner: of the fingers, whose sphere is that of the start
  for (const Pair& pair : pairs_) {
    const ChainCapsule& link = chain_.capsules()[pair.capsule];
    if (pair.capsule != last) {
      last = pair.capsule;
      const double turning = rate(link.carried, turning_), inner_turning = fastest_finger(link, turning_);
      inner_travel = std::max(link.inner_bound(travel_), link.inner_bound(other_travel_));
      bend = link.carried_bound(jerk_) * interval * interval / 8.0 + link.carried_bound(speed_) * turning * interval / 2.0;
      inner_bend =
          link.inner_bound(jerk_) * interval * interval / 8.0 + link.inner_bound(speed_) * (turning + inner_turning) * interval / 2.0;
    }
    const PersonCapsule& part = people.capsules[pair.part];
    const auto region = static_cast<std::size_t>(part.region);
    const RegionMotion& bounds = settings_.people[region];
    const double from = start_speed(part, settings_.speed_error, bounds);
    const auto within = [&](const Sample& at, double needed) {
      const double apart = needed + link.radius + part.reach + 0.5 * (at.b - at.a).norm();
      if ((0.5 * (at.a + at.b) - part.centre).squaredNorm() > apart * apart) return false;
      Vector3 on_robot, on_person;
      const double distance = std::sqrt(nearest_points(at.a, at.b, part.a, part.b, on_robot, on_person)) - link.radius - part.radius;
      refutation_.distance = distance;
      return distance <= needed;
    };
    for (int slot = 0; slot < kIntervals; ++slot) {
      const Sample& first = samples_[static_cast<std::size_t>(slot)][pair.capsule];
      const Sample& second = samples_[static_cast<std::size_t>(slot) + 1][pair.capsule];
      double carried = std::max(first.carried, second.carried) + bend, inner = std::max(first.inner, second.inner);
      if (inner > 0.0) inner += inner_bend;
      if (contact_speed(carried, inner, region) <= max_contact_speed_[region]) continue;
      const std::vector<double>& speeds = speeds_between(stop, slot, interval);
      carried = std::min(carried, link.carried_bound(speeds));
      inner = std::min(inner, link.inner_bound(speeds));
      const double contact = contact_speed(carried, inner, region);
      if (contact <= max_contact_speed_[region]) continue;
      // Within the interval the link is no farther from where it is at one of its ends than it goes in half of it.
      const double needed = (carried + inner) * interval / 2.0 + inner_travel + margin +
                            reach_after((slot + 1) * interval + settings_.latency + age + part.age, from, bounds);
      if (!within(first, needed) && !within(second, needed)) continue;
      refutation_ = {link.link, slot * interval, contact, max_contact_speed_[region], refutation_.distance, needed};
      return false;
    }
  }
  return true;
}

bool StopProof::check(const MotionState3& state, const PersonCapsules& people, const Pose& T_world_base, double age,
                      double payload) noexcept {
  plan(state, 0.0, at_once_);
  if (at_once_.count == 0) return true;
  plan(state, settings_.robot_side_delay, robot_side_);
  bound_motion();
  refutation_ = {};
  if (!settings_.enabled) return true;
  if (!at_once_.inside) return false;
  if (people.capsules.empty()) return true;
  for (std::size_t r = 0; r < kBodyRegions; ++r) {
    max_contact_speed_[r] = max_speed_at(static_cast<BodyRegion>(r), payload);
    finger_ratio_[r] = finger_ratio_at(static_cast<BodyRegion>(r), 0.0);
  }
  min_contact_speed_ = *std::min_element(max_contact_speed_.begin(), max_contact_speed_.end());
  const double duration = std::max(at_once_.duration, robot_side_.duration) + settings_.latency + age;
  const bool rooms_hold = room_of_ == people.revision && (T_world_base.matrix() - room_base_.matrix()).isZero(0.0);
  if (rooms_hold && far_from_everybody(state, duration)) return true;
  velocity_.setZero();
  chain_.enclose_hands(state.position);
  chain_.move(state.position, velocity_, all_frames_, motions_);
  room_of_ = people.revision;
  room_base_ = T_world_base;
  room_position_ = state.position;
  room_duration_ = duration;
  if (!find_pairs(people, T_world_base, duration)) return false;
  if (pairs_.empty()) return true;
  return check_stop(at_once_, state.position, people, T_world_base, age) &&
         check_stop(robot_side_, state.position, people, T_world_base, age);
}

}  // namespace handsel::trajectory_controller
