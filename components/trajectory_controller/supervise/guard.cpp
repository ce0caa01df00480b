// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/guard.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/segments.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kStill = 1e-4;  // max closing speed that counts as none [m/s]

/// Returns the max speed of a part of a person in any direction [m/s].
double fastest(const PersonCapsule& c, const GuardSettings& s) noexcept {
  return c.joints == 0 ? s.speed_unknown
                       : std::clamp(c.fastest + s.speed_uncertainty, s.speed_floor, s.speed_max);
}

/// Returns the smallest step of a StopTable whose factor is at least `factor`.
int step_above(double factor) noexcept {
  return static_cast<int>(std::ceil(factor * kStopGrid - 1e-9));
}

/// One evaluation of guard(): the current limits while links are compared with people and walls.
class Evaluation {
 public:
  Evaluation(const GuardSettings& settings, const GuardQuery& query) noexcept
      : settings_(settings),
        query_(query),
        reaction_(settings.reaction + std::max(0.0, query.age)),
        margin_(settings.intrusion + settings.uncertainty_human + settings.uncertainty_robot),
        present_(std::clamp(step_above(std::abs(query.factor)), 0, kStopGrid)) {
    for (const PersonCapsule& part : query.people.capsules) {
      max_person_speed_ = std::max(max_person_speed_, fastest(part, settings));
      max_age_ = std::max(max_age_, part.age);
    }
  }

  GuardVerdict run() noexcept {
    for (const LinkCapsule& link : query_.robot) check_link(link);
    verdict_.separation = forward_ < 1.0 || backward_ < 1.0;
    for (const Wall& wall : query_.walls) check_wall(wall);
    if (!query_.people.covered) {
      verdict_.uncovered = true;
      forward_ = std::min(forward_, settings_.uncovered_factor);
      backward_ = std::min(backward_, settings_.uncovered_factor);
    }
    verdict_.forward = forward_;
    verdict_.backward = -backward_;
    return verdict_;
  }

 private:
  /// A link of the robot with the values that all comparisons use.
  struct Link {
    int index{};
    MovingCapsule capsule;
    Vector3 axis, centre;
    double length2{};
    double reach{};      // half the length and the radius [m]
    double max_speed{};  // max speed of an end [m/s]
  };
  /// The nearest points of a link and a part of a person.
  struct Approach {
    Vector3 toward{Vector3::UnitZ()};  // from the link to the person, unit
    double distance{};                 // [m]
    double closing{};                  // speed of the link toward the person at factor 1 [m/s]
  };

  /// Returns the distance that a stop from step `g` of the factors needs [m].
  double needed(double v_h, double closing, int g, double T_r, double extra) const noexcept {
    const auto k = static_cast<std::size_t>(g);
    const double v_r = closing * g / kStopGrid;
    return v_h * (T_r + query_.stop.time[k]) + v_r * (T_r + query_.stop.distance[k]) + extra;
  }

  /// Returns the max factor whose stop fits into the distance: exact on the grid, linear between.
  double allowed(double distance, double v_h, double closing, double extra,
                 double best) const noexcept {
    const auto need = [&](int g) { return needed(v_h, closing, g, reaction_, extra); };
    int low = 0, high = step_above(best);
    if (need(high) <= distance) return best;
    if (need(0) >= distance) return 0.0;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (need(middle) <= distance ? low : high) = middle;
    }
    const double n0 = need(low), n1 = need(high);
    return std::min(best, (low + (distance - n0) / (n1 - n0)) / kStopGrid);
  }

  void check_link(const LinkCapsule& link) noexcept {
    Link l;
    l.index = link.link;
    l.capsule = placed(link, query_.motion, query_.T_world_base);
    const MovingCapsule& r = l.capsule;
    l.axis = r.b - r.a;
    l.centre = 0.5 * (r.a + r.b);
    l.length2 = l.axis.squaredNorm();
    l.reach = 0.5 * std::sqrt(l.length2) + r.radius;
    l.max_speed = std::sqrt(std::max(r.va.squaredNorm(), r.vb.squaredNorm()));
    const double need =
        needed(max_person_speed_, l.max_speed, high_, reaction_ + max_age_, margin_);
    const double max_distance = std::max(settings_.handover_range, need) + l.reach;
    for (const PersonCapsule& part : query_.people.capsules) check_part(l, max_distance, part);
  }

  /// Skips parts farther than `max_distance` [m]: first by bounding spheres, then exactly.
  void check_part(const Link& link, double max_distance, const PersonCapsule& part) noexcept {
    const double apart2 = (part.centre - link.centre).squaredNorm();
    const double far = std::max(max_distance, verdict_.distance + link.reach) + part.reach;
    if (apart2 > far * far) return;
    const double matters = range(link, part);
    const double near = part.excepted ? matters : std::max(matters, verdict_.distance);
    const double rough = near + link.reach + part.reach;
    if (apart2 > rough * rough) return;
    const MovingCapsule& r = link.capsule;
    Vector3 on_robot, on_person;
    const double axes_apart =
        std::sqrt(nearest_points(r.a, r.b, part.a, part.b, on_robot, on_person));
    Approach at;
    at.distance = axes_apart - r.radius - part.radius;
    const bool nearest = !part.excepted && at.distance < verdict_.distance;
    if (!nearest && at.distance >= matters) return;
    if (axes_apart > 1e-9) at.toward = (on_person - on_robot) / axes_apart;
    const double along = (on_robot - r.a).dot(link.axis);  // [m^2]
    const double ratio = link.length2 > 1e-12 ? std::clamp(along / link.length2, 0.0, 1.0) : 0.0;
    at.closing = (r.va + ratio * (r.vb - r.va)).dot(at.toward);
    if (nearest) {
      note_nearest(link, part, at);
      verdict_.on_robot = on_robot;
      verdict_.on_person = on_person;
    }
    if (at.distance >= matters) return;
    if (part.excepted)
      limit_exempt(at);
    else if (link.max_speed >= kStill)
      limit_separation(link, part, at);
  }

  /// Returns the max distance at which the part limits the link [m].
  double range(const Link& link, const PersonCapsule& part) const noexcept {
    if (part.excepted) return settings_.handover_range;
    if (link.max_speed < kStill) return 0.0;
    const double v_h = fastest(part, settings_);
    return needed(v_h, link.max_speed, high_, reaction_ + part.age, margin_);
  }

  void note_nearest(const Link& link, const PersonCapsule& part, const Approach& at) noexcept {
    const double v_h = directed_speed(part, -at.toward, settings_);
    const double closing = std::max(0.0, std::copysign(at.closing, at.closing * query_.factor));
    verdict_.distance = at.distance;
    verdict_.link = link.index;
    verdict_.needed = needed(v_h, closing, present_, reaction_ + part.age, margin_);
  }

  /// Limits the speed toward an exempt part.
  void limit_exempt(const Approach& at) noexcept {
    verdict_.handover_clear = false;
    double& best = at.closing > 0 ? forward_ : backward_;
    const double closing = std::abs(at.closing);
    if (closing > settings_.handover_speed)
      best = std::min(best, settings_.handover_speed / closing);
  }

  /// Limits the speed so that a stop fits into the distance.
  void limit_separation(const Link& link, const PersonCapsule& part, const Approach& at) noexcept {
    const double v_h = directed_speed(part, -at.toward, settings_), closing = at.closing;
    // The person may have approached by this much since the observation.
    const double left = at.distance - v_h * part.age;
    // A motion that does not clearly lead away counts as closing in both directions: the direction
    // between link and person may turn until they meet.
    const double sideways = std::max(kStill, settings_.sideways_ratio * link.max_speed);
    const double away = settings_.away_ratio * link.max_speed;
    if (closing > -away)
      forward_ = allowed(left, v_h, std::max(closing, sideways), margin_, forward_);
    if (closing < away)
      backward_ = allowed(left, v_h, std::max(-closing, sideways), margin_, backward_);
    high_ = std::max(present_, step_above(std::max(forward_, backward_)));
    if (!(closing * query_.factor > 0.05)) return;
    const double need = needed(v_h, std::abs(closing), present_, 0.0, settings_.uncertainty_human);
    if (need > left) verdict_.too_near = true;
  }

  void check_wall(const Wall& wall) noexcept {
    for (const LinkCapsule& link : query_.robot) {
      const MovingCapsule r = placed(link, query_.motion, query_.T_world_base);
      for (const bool first : {true, false}) {
        const double closing = -wall.normal.dot(first ? r.va : r.vb);
        const double distance = wall.normal.dot(first ? r.a : r.b) - wall.offset - r.radius;
        if (std::abs(closing) < kStill) continue;
        double& best = closing > 0 ? forward_ : backward_;
        const double before = best;
        best = allowed(distance, 0.0, std::abs(closing), settings_.uncertainty_robot, best);
        if (best < before) verdict_.wall = true;
      }
    }
  }

  const GuardSettings& settings_;
  const GuardQuery& query_;
  double reaction_, margin_;               // [s], [m]
  int present_;                            // step of the current factor
  int high_{kStopGrid};                    // max step that may still be allowed
  double max_person_speed_{}, max_age_{};  // [m/s], [s]
  double forward_{1.0}, backward_{1.0};    // max factors so far
  GuardVerdict verdict_;
};

}  // namespace

double directed_speed(const PersonCapsule& c, const Vector3& toward_robot,
                      const GuardSettings& s) noexcept {
  if (c.joints == 0) return s.speed_unknown;
  double v = -s.speed_max;
  for (int j = 0; j < c.joints; ++j)
    v = std::max(v, c.velocities[static_cast<std::size_t>(j)].dot(toward_robot));
  return std::clamp(v + s.speed_uncertainty, s.speed_floor, s.speed_max);
}

double reference_speed(double separation, double v_h, double reaction, double deceleration,
                       double margin) noexcept {
  const double at = deceleration * reaction;
  const double root = v_h * v_h + at * at + 2.0 * deceleration * (separation - margin);
  return root <= 0.0 ? 0.0 : std::max(0.0, std::sqrt(root) - at - v_h);
}

GuardVerdict guard(const GuardSettings& settings, const GuardQuery& query) noexcept {
  return Evaluation(settings, query).run();
}

}  // namespace handsel::trajectory_controller
