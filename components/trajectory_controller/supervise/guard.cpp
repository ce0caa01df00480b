#include "components/trajectory_controller/supervise/guard.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/segments.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kSideways = 0.05;  // share of a link's speed
constexpr double kAway = 0.5;       // likewise
constexpr double kStill = 1e-4;     // [m/s] closing more slowly counts as not closing

/// No direction gives more.
double fastest(const PersonCapsule& c, const GuardSettings& s) noexcept {
  return c.joints == 0 ? s.speed_unknown : std::clamp(c.fastest + s.speed_uncertainty, s.speed_floor, s.speed_max);
}

double directed_speed(const PersonCapsule& c, const Vector3& toward_robot, const GuardSettings& s) noexcept {
  if (c.joints == 0) return s.speed_unknown;
  double v = -s.speed_max;
  for (int j = 0; j < c.joints; ++j) v = std::max(v, c.velocities[static_cast<std::size_t>(j)].dot(toward_robot));
  return std::clamp(v + s.speed_uncertainty, s.speed_floor, s.speed_max);
}

}  // namespace

double reference_speed(double separation, double v_h, double reaction, double deceleration, double margin) noexcept {
  const double at = deceleration * reaction;
  const double root = v_h * v_h + at * at + 2.0 * deceleration * (separation - margin);
  return root <= 0.0 ? 0.0 : std::max(0.0, std::sqrt(root) - at - v_h);
}

GuardVerdict guard(const GuardSettings& settings, const std::vector<LinkCapsule>& robot, const PathMotion& motion, const Pose& T_world_base,
                   const StopTable& stop, const PersonCapsules& people, const std::vector<Wall>& walls, double age,
                   double factor) noexcept {
  GuardVerdict verdict;
  double forward = 1.0, backward = 1.0;

  const double reaction = settings.reaction + std::max(0.0, age);
  const double margin = settings.intrusion + settings.uncertainty_human + settings.uncertainty_robot;
  const auto needed = [&](double v_h, double closing, int g, double T_r, double extra) {
    const auto k = static_cast<std::size_t>(g);
    const double v_r = closing * g / kStopGrid;
    return v_h * (T_r + stop.time[k]) + v_r * (T_r + stop.way[k]) + extra;
  };
  // Largest factor whose need fits into the distance; exact on the grid, linear between.
  const auto allowed = [&](double distance, double v_h, double closing, double extra, double best) {
    int low = 0, high = static_cast<int>(std::ceil(best * kStopGrid - 1e-9));
    if (needed(v_h, closing, high, reaction, extra) <= distance) return best;
    if (needed(v_h, closing, 0, reaction, extra) >= distance) return 0.0;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (needed(v_h, closing, middle, reaction, extra) <= distance ? low : high) = middle;
    }
    const double n0 = needed(v_h, closing, low, reaction, extra), n1 = needed(v_h, closing, high, reaction, extra);
    return std::min(best, (low + (distance - n0) / (n1 - n0)) / kStopGrid);
  };

  const int present = std::clamp(static_cast<int>(std::ceil(std::abs(factor) * kStopGrid - 1e-9)), 0, kStopGrid);
  int high = kStopGrid;  // of the factors still in question
  double quickest_person = 0.0, oldest = 0.0;
  for (const PersonCapsule& part : people.capsules) {
    quickest_person = std::max(quickest_person, fastest(part, settings));
    oldest = std::max(oldest, part.age);
  }
  for (const LinkCapsule& link : robot) {
    const MovingCapsule r = placed(link, motion, T_world_base);
    const Vector3 way = r.b - r.a, centre = 0.5 * (r.a + r.b);
    const double length2 = way.squaredNorm(), reach = 0.5 * std::sqrt(length2) + r.radius;
    const double quickest = std::sqrt(std::max(r.va.squaredNorm(), r.vb.squaredNorm()));
    const double farthest =
        std::max(settings.exchange_range, needed(quickest_person, quickest, high, reaction + oldest, margin)) + reach;  // that may matter
    for (const PersonCapsule& part : people.capsules) {
      // What is farther than this changes nothing: rough first, then exactly.
      const double apart2 = (part.centre - centre).squaredNorm(), far = std::max(farthest, verdict.distance + reach) + part.reach;
      if (apart2 > far * far) continue;
      const double matters = part.excepted       ? settings.exchange_range
                             : quickest < kStill ? 0.0
                                                 : needed(fastest(part, settings), quickest, high, reaction + part.age, margin);
      const double rough = (part.excepted ? matters : std::max(matters, verdict.distance)) + reach + part.reach;
      if (apart2 > rough * rough) continue;
      Vector3 on_robot, on_person;
      const double axes_apart = std::sqrt(nearest_points(r.a, r.b, part.a, part.b, on_robot, on_person));
      const double distance = axes_apart - r.radius - part.radius;
      const bool nearest = !part.excepted && distance < verdict.distance;
      if (!nearest && distance >= matters) continue;
      const Vector3 toward = axes_apart > 1e-9 ? Vector3((on_person - on_robot) / axes_apart) : Vector3(Vector3::UnitZ());
      const double share = length2 > 1e-12 ? std::clamp((on_robot - r.a).dot(way) / length2, 0.0, 1.0) : 0.0;
      const double closing = (r.va + share * (r.vb - r.va)).dot(toward);  // at factor 1; backwards it is the negative
      if (nearest) {
        verdict.distance = distance;
        verdict.link = link.link;
        verdict.on_robot = on_robot;
        verdict.on_person = on_person;
        verdict.needed = needed(directed_speed(part, -toward, settings), std::max(0.0, std::copysign(closing, closing * factor)), present,
                                reaction + part.age, margin);
      }
      if (distance >= matters) continue;
      if (part.excepted) {
        verdict.exchange_clear = false;
        double& best = closing > 0 ? forward : backward;
        if (std::abs(closing) > settings.exchange_speed) best = std::min(best, settings.exchange_speed / std::abs(closing));
        continue;
      }
      if (quickest < kStill) continue;
      const double v_h = directed_speed(part, -toward, settings);
      const double left = distance - v_h * part.age;  // the person may have come that much nearer since
      // What does not clearly lead away counts as closing both ways: until they meet the direction between them may turn.
      const double sideways = std::max(kStill, kSideways * quickest), away = kAway * quickest;
      if (closing > -away) forward = allowed(left, v_h, std::max(closing, sideways), margin, forward);
      if (closing < away) backward = allowed(left, v_h, std::max(-closing, sideways), margin, backward);
      high = std::max(present, static_cast<int>(std::ceil(std::max(forward, backward) * kStopGrid - 1e-9)));
      const bool closes_now = closing * factor > 0.05;
      if (closes_now && needed(v_h, std::abs(closing), present, 0.0, settings.uncertainty_human) > left) verdict.too_near = true;
    }
  }
  verdict.separation = forward < 1.0 || backward < 1.0;
  for (const Wall& wall : walls) {
    for (const LinkCapsule& link : robot) {
      const MovingCapsule r = placed(link, motion, T_world_base);
      for (const bool first : {true, false}) {
        const double closing = -wall.normal.dot(first ? r.va : r.vb);
        const double distance = wall.normal.dot(first ? r.a : r.b) - wall.offset - r.radius;
        if (std::abs(closing) < kStill) continue;
        double& best = closing > 0 ? forward : backward;
        const double before = best;
        best = allowed(distance, 0.0, std::abs(closing), settings.uncertainty_robot, best);
        if (best < before) verdict.wall = true;
      }
    }
  }
  if (!people.covered) {
    verdict.uncovered = true;
    forward = std::min(forward, settings.uncovered_factor);
    backward = std::min(backward, settings.uncovered_factor);
  }
  verdict.forward = forward;
  verdict.backward = -backward;
  return verdict;
}

}  // namespace handsel::trajectory_controller
