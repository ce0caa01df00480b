#include "components/trajectory_controller/guard.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/segments.hpp"
#include "common/model/body_motion.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr int kGrid = 16;

/// Stop of the axes that move along the path, for factors on a grid of [0, 1].
struct StopTable {
  std::array<double, kGrid + 1> time{}, way{};  // way: per unit of speed at the factor
};

StopTable make_stop_table(const PathMotion& motion, const KinematicLimits& limits) noexcept {
  StopTable table;
  const Eigen::Index n = motion.velocity->size();
  for (int g = 0; g <= kGrid; ++g) {
    const double factor = static_cast<double>(g) / kGrid;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double v = factor * std::abs((*motion.velocity)[i]);
      if (v < 1e-9) continue;
      const double a = std::min(factor * factor * std::max(0.0, (*motion.acceleration)[i] * ((*motion.velocity)[i] < 0 ? -1.0 : 1.0)),
                                limits.acceleration[i]);
      const double ease = a / limits.jerk[i];
      const double peak = v + 0.5 * a * ease;
      const double rest = stop_time(peak, limits.acceleration[i], limits.jerk[i]);
      const auto k = static_cast<std::size_t>(g);
      table.time[k] = std::max(table.time[k], ease + rest);
      table.way[k] = std::max(table.way[k], peak / v * (ease + 0.5 * rest));
    }
  }
  return table;
}

double directed_speed(const CrowdCapsule& c, const Vector3& toward_robot, const GuardSettings& s) noexcept {
  if (c.unknown || c.joints == 0) return s.speed_unknown;
  double v = -1e9;
  for (int j = 0; j < c.joints; ++j) v = std::max(v, c.velocities[static_cast<std::size_t>(j)].dot(toward_robot));
  return std::clamp(v + s.speed_uncertainty, s.speed_floor, s.speed_max);
}

}  // namespace

double stop_time(double v, double acceleration_limit, double jerk_limit) noexcept {
  const double x = std::abs(v);
  return x * jerk_limit < acceleration_limit * acceleration_limit ? 2.0 * std::sqrt(x / jerk_limit)
                                                                  : x / acceleration_limit + acceleration_limit / jerk_limit;
}

double reference_speed(double separation, double v_h, double reaction, double deceleration, double margin) noexcept {
  const double at = deceleration * reaction;
  const double root = v_h * v_h + at * at + 2.0 * deceleration * (separation - margin);
  return root <= 0.0 ? 0.0 : std::max(0.0, std::sqrt(root) - at - v_h);
}

void prepare(const HumanState& people, const Exception& exception, double unknown_after, Crowd& out) {
  out.capsules.clear();
  out.covered = people.covered;
  for (const Person& person : people.people) {
    const bool exchanging = !exception.person.empty() && person.id == exception.person;
    for (const BodyCapsule& body : body_capsules(person)) {
      CrowdCapsule c;
      c.a = body.a;
      c.b = body.b;
      c.radius = body.radius;
      c.unknown = person.age > unknown_after || person.joints.size() != kBodyJoints.size();
      if (!c.unknown)
        for (int j : joints_of(body.part))
          c.velocities[static_cast<std::size_t>(c.joints++)] = person.joints[static_cast<std::size_t>(j)].velocity;
      const bool left = body.part == BodyPart::forearm_left || body.part == BodyPart::hand_left;
      const bool right = body.part == BodyPart::forearm_right || body.part == BodyPart::hand_right;
      c.excepted = exchanging && ((left && (exception.both_sides || exception.side == Side::left)) ||
                                  (right && (exception.both_sides || exception.side == Side::right)));
      out.capsules.push_back(c);
    }
  }
}

GuardVerdict guard(const GuardSettings& settings, const std::vector<LinkCapsule>& robot, const PathMotion& motion, const Pose& T_world_base,
                   const KinematicLimits& stop_limits, const Crowd& crowd, double age, double factor) noexcept {
  GuardVerdict verdict;
  if (!crowd.covered) {
    verdict.uncovered = true;
    verdict.forward = settings.uncovered_factor;
    verdict.backward = -settings.uncovered_factor;
  }
  if (crowd.capsules.empty()) return verdict;

  const StopTable stop = make_stop_table(motion, stop_limits);
  const double reaction = settings.reaction + std::max(0.0, age);
  const double margin = settings.intrusion + settings.uncertainty_human + settings.uncertainty_robot;
  const auto needed = [&](double v_h, double closing, int g, double T_r, double extra) {
    const auto k = static_cast<std::size_t>(g);
    const double v_r = closing * g / kGrid;
    return v_h * (T_r + stop.time[k]) + v_r * (T_r + stop.way[k]) + extra;
  };
  // Largest factor whose need fits into the distance; exact on the grid, linear between.
  const auto allowed = [&](double distance, double v_h, double closing, double best) {
    int low = 0, high = static_cast<int>(std::ceil(best * kGrid - 1e-9));
    if (needed(v_h, closing, high, reaction, margin) <= distance) return best;
    if (needed(v_h, closing, 0, reaction, margin) >= distance) return 0.0;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (needed(v_h, closing, middle, reaction, margin) <= distance ? low : high) = middle;
    }
    const double n0 = needed(v_h, closing, low, reaction, margin), n1 = needed(v_h, closing, high, reaction, margin);
    return std::min(best, (low + (distance - n0) / (n1 - n0)) / kGrid);
  };

  const int present = std::clamp(static_cast<int>(std::ceil(std::abs(factor) * kGrid - 1e-9)), 0, kGrid);
  double forward = 1.0, backward = 1.0;
  for (const LinkCapsule& link : robot) {
    const Pose& T = (*motion.links)[static_cast<std::size_t>(link.link)];
    const Pose& T_ahead = (*motion.links_ahead)[static_cast<std::size_t>(link.link)];
    const Vector3 a = T_world_base * (T * link.a), b = T_world_base * (T * link.b);
    const Vector3 va = (T_world_base * (T_ahead * link.a) - a) / motion.look, vb = (T_world_base * (T_ahead * link.b) - b) / motion.look;
    const double length2 = (b - a).squaredNorm();
    for (const CrowdCapsule& part : crowd.capsules) {
      Vector3 on_robot, on_person;
      const double axes_apart = std::sqrt(nearest_points(a, b, part.a, part.b, on_robot, on_person));
      const double distance = axes_apart - link.radius - part.radius;
      const Vector3 toward = axes_apart > 1e-9 ? Vector3((on_person - on_robot) / axes_apart) : Vector3(Vector3::UnitZ());
      const double share = length2 > 1e-12 ? std::clamp((on_robot - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
      const double closing = (va + share * (vb - va)).dot(toward);  // at factor 1; backwards it is the negative
      if (part.excepted) {
        if (distance < settings.exchange_range) {
          verdict.exchange_clear = false;
          const double cap = std::abs(closing) > settings.exchange_speed ? settings.exchange_speed / std::abs(closing) : 1.0;
          (closing > 0 ? forward : backward) = std::min(closing > 0 ? forward : backward, cap);
        }
        continue;
      }
      verdict.distance = std::min(verdict.distance, distance);
      if (std::abs(closing) < 1e-4) continue;
      const double v_h = directed_speed(part, -toward, settings);
      double& best = closing > 0 ? forward : backward;
      best = allowed(distance, v_h, std::abs(closing), best);
      const bool closes_now = closing * factor > 0.05;
      if (closes_now && needed(v_h, std::abs(closing), present, 0.0, settings.uncertainty_human) > distance) verdict.too_near = true;
    }
  }
  verdict.separation = forward < 1.0 || backward < 1.0;
  verdict.forward = std::min(verdict.forward, forward);
  verdict.backward = std::max(verdict.backward, -backward);
  return verdict;
}

}  // namespace handsel::trajectory_controller
