#include "components/trajectory_controller/supervise/guard.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/segments.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kStill = 1e-4;  // [m/s] closing more slowly counts as not closing

/// No direction gives more.
double fastest(const PersonCapsule& c, const GuardSettings& s) noexcept {
  return c.joints == 0 ? s.speed_unknown
                       : std::clamp(c.fastest + s.speed_uncertainty, s.speed_floor, s.speed_max);
}

/// Smallest step of a StopTable whose factor is at least `factor`.
int step_above(double factor) noexcept {
  return static_cast<int>(std::ceil(factor * kStopGrid - 1e-9));
}

/// One evaluation of guard(): the limits so far, while links are compared with people and walls.
class Evaluation {
 public:
  Evaluation(const GuardSettings& settings, const GuardQuery& query) noexcept
      : settings_(settings),
        query_(query),
        reaction_(settings.reaction + std::max(0.0, query.age)),
        margin_(settings.intrusion + settings.uncertainty_human + settings.uncertainty_robot),
        present_(std::clamp(step_above(std::abs(query.factor)), 0, kStopGrid)) {
    for (const PersonCapsule& part : query.people.capsules) {
      quickest_person_ = std::max(quickest_person_, fastest(part, settings));
      oldest_ = std::max(oldest_, part.age);
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
  /// A link that is compared.
  struct Link {
    int index{};
    MovingCapsule capsule;
    Vector3 axis, centre;
    double length2{};
    double reach{};     // half the length and the radius [m]
    double quickest{};  // largest speed of an end [m/s]
  };
  /// A link and a part of a person, where they are nearest to each other.
  struct Approach {
    Vector3 toward{Vector3::UnitZ()};  // from the link to the person, unit
    double distance{};                 // [m]
    double closing{};                  // speed of the link toward the person at factor 1 [m/s]
  };

  /// Distance that a stop from step `g` of the factors needs [m].
  double needed(double v_h, double closing, int g, double T_r, double extra) const noexcept {
    const auto k = static_cast<std::size_t>(g);
    const double v_r = closing * g / kStopGrid;
    return v_h * (T_r + query_.stop.time[k]) + v_r * (T_r + query_.stop.distance[k]) + extra;
  }

  /// Largest factor whose need fits into the distance; exact on the grid, linear between.
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
    l.quickest = std::sqrt(std::max(r.va.squaredNorm(), r.vb.squaredNorm()));
    const double need = needed(quickest_person_, l.quickest, high_, reaction_ + oldest_, margin_);
    const double farthest = std::max(settings_.handover_range, need) + l.reach;  // that may matter
    for (const PersonCapsule& part : query_.people.capsules) check_part(l, farthest, part);
  }

  /// What is farther than `farthest` changes nothing: rough first, then exactly.
  void check_part(const Link& link, double farthest, const PersonCapsule& part) noexcept {
    const double apart2 = (part.centre - link.centre).squaredNorm();
    const double far = std::max(farthest, verdict_.distance + link.reach) + part.reach;
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
    const double place = (on_robot - r.a).dot(link.axis) / link.length2;
    const double ratio = link.length2 > 1e-12 ? std::clamp(place, 0.0, 1.0) : 0.0;
    at.closing = (r.va + ratio * (r.vb - r.va)).dot(at.toward);
    if (nearest) {
      note_nearest(link, part, at);
      verdict_.on_robot = on_robot;
      verdict_.on_person = on_person;
    }
    if (at.distance >= matters) return;
    if (part.excepted)
      limit_exempt(at);
    else if (link.quickest >= kStill)
      limit_separation(link, part, at);
  }

  /// Distance within which the part matters to the link [m].
  double range(const Link& link, const PersonCapsule& part) const noexcept {
    if (part.excepted) return settings_.handover_range;
    if (link.quickest < kStill) return 0.0;
    const double v_h = fastest(part, settings_);
    return needed(v_h, link.quickest, high_, reaction_ + part.age, margin_);
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
    // The person may have come that much nearer since.
    const double left = at.distance - v_h * part.age;
    // What does not clearly lead away counts as closing both ways: until they meet the direction
    // between them may turn.
    const double sideways = std::max(kStill, settings_.sideways_ratio * link.quickest);
    const double away = settings_.away_ratio * link.quickest;
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
  double reaction_, margin_;             // [s], [m]
  int present_;                          // step of the factor in force
  int high_{kStopGrid};                  // largest step still in question
  double quickest_person_{}, oldest_{};  // [m/s], [s]
  double forward_{1.0}, backward_{1.0};  // largest factors so far
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
