// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/supervise/reach_limit.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/segments.hpp"

namespace handsel::trajectory_controller {

namespace {

/// Returns the stop time [s], interpolated linearly between the factors of the table.
double time_at(const StopTable& stop, double factor) noexcept {
  const double place = std::clamp(factor, 0.0, 1.0) * kStopGrid;
  const auto k = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(kStopGrid - 1));
  const double rest = place - static_cast<double>(k);
  return (1.0 - rest) * stop.time[k] + rest * stop.time[k + 1];
}

double gained(const FrameMotion& change, const ChainCapsule& link) noexcept {
  const Vector3 a = change.linear + change.angular.cross(change.R * link.a),
                b = change.linear + change.angular.cross(change.R * link.b);
  return std::sqrt(std::max(a.squaredNorm(), b.squaredNorm())) +
         change.angular.norm() * link.radius;
}

std::array<double, kBodyRegions> allowed_speeds(const StopProof& proof, double payload) noexcept {
  std::array<double, kBodyRegions> out{};
  for (std::size_t r = 0; r < kBodyRegions; ++r)
    out[r] = proof.settings().limit_ratio *
             proof.contact_speeds().max_speed_at(static_cast<BodyRegion>(r), payload);
  return out;
}

/// Terms common to all links and parts.
struct LimitTerms {
  const StopTable& stop;
  double reaction, margin;  ///< [s], [m]
  bool backward;
};

/// A link at full speed, world frame.
struct LinkAtSpeed {
  double radius;
  const Vector3 &a, &b, &va, &vb;  ///< ends of its axis and their velocities
  double extra, inner, speed;      ///< [m/s]
};

/// A part of a person that a link approaches.
struct PartApproach {
  const PersonCapsule& part;
  const RegionMotion& bounds;
  double contact_now, from, late;  ///< [m/s], [m/s], [s]
};

/// Returns the limit so far, lowered to the max factor at which the link is slow enough in time.
double lowered_limit(const LinkAtSpeed& link, const PartApproach& person, const LimitTerms& terms,
                     double limit) noexcept {
  const auto needed = [&](double factor, double closing) {
    const double slowing = time_at(terms.stop, factor - person.contact_now / link.speed);
    return reach_after(person.late + slowing, person.from, person.bounds) +
           (factor * closing + link.inner) * (terms.reaction + 0.5 * slowing) + terms.margin;
  };
  Vector3 on_robot, on_person;
  const double axes_apart =
      std::sqrt(nearest_points(link.a, link.b, person.part.a, person.part.b, on_robot, on_person));
  const double distance = axes_apart - link.radius - person.part.radius;
  const Vector3 toward =
      axes_apart > 1e-9 ? Vector3((on_person - on_robot) / axes_apart) : Vector3(Vector3::UnitZ());
  const double ahead = std::max(link.va.dot(toward), link.vb.dot(toward)),
               behind = std::max(-link.va.dot(toward), -link.vb.dot(toward));
  const double closing = std::max(0.0, terms.backward ? behind : ahead) + link.extra;
  if (needed(limit, closing) <= distance) return limit;
  // The needed distance grows with the factor: bisection between contact speed, which is always
  // allowed, and the limit so far.
  double low = std::min(limit, person.contact_now / link.speed), high = limit;
  for (int k = 0; k < 8; ++k) {
    const double middle = 0.5 * (low + high);
    (needed(middle, closing) <= distance ? low : high) = middle;
  }
  return low;
}

}  // namespace

ReachLimit::ReachLimit(const StopProof& proof)
    : proof_(proof),
      all_frames_(proof.chain().frames().size(), 1),
      motions_(all_frames_.size()),
      changes_(motions_),
      gain_(Vector::Zero(static_cast<Eigen::Index>(proof.chain().sliding().size()))),
      finger_speeds_(proof.chain().sliding().size()) {}

double ReachLimit::factor(const ReachQuery& query, const PersonCapsules& people,
                          bool backward) noexcept {
  const StopProofSettings& s = proof_.settings();
  if (!s.enabled || people.capsules.empty()) return 1.0;
  const StopTable& stop = query.stop;
  const std::array<double, kBodyRegions> contact = allowed_speeds(proof_, query.payload);
  const double min_contact = *std::min_element(contact.begin(), contact.end());
  const double reaction = s.latency + s.robot_side_delay + query.ease,
               margin = s.tracker_error + s.robot_error + s.limit_margin;
  const LimitTerms terms{stop, reaction, margin, backward};
  PartReaches reach;  // at the end of the whole stop
  reach_of_parts(people, reaction + query.age + stop.time[kStopGrid], s.speed_error, s.people,
                 reach);
  for (std::size_t i = 0; i < finger_speeds_.size(); ++i)
    finger_speeds_[i] = query.finger_speeds[static_cast<Eigen::Index>(i)];
  proof_.chain().move(query.position, query.velocity, all_frames_, motions_);
  const bool faster = query.ease > 0.0;
  if (faster) {
    gain_ = (s.robot_side_delay + 0.5 * query.ease) * query.acceleration;
    proof_.chain().move(query.position, gain_, all_frames_, changes_);
  }
  double limit = 1.0;
  for (const ChainCapsule& link : proof_.chain().capsules()) {
    const FrameMotion& frame = motions_[static_cast<std::size_t>(link.frame)];
    const Vector3 ra = frame.R * link.a, rb = frame.R * link.b;
    const Vector3 va = query.T_world_base.linear() * (frame.linear + frame.angular.cross(ra));
    const Vector3 vb = query.T_world_base.linear() * (frame.linear + frame.angular.cross(rb));
    const double extra = frame.angular.norm() * link.radius;
    const double inner = link.fingers.empty()
                             ? 0.0
                             : link.inner_bound(finger_speeds_);  // does not depend on the factor
    const double speed = std::sqrt(std::max(va.squaredNorm(), vb.squaredNorm())) + extra;
    const double gain = faster ? gained(changes_[static_cast<std::size_t>(link.frame)], link) : 0.0;
    if (inner == 0.0 && speed * limit + gain <= min_contact) continue;
    const Vector3 a = query.T_world_base * (frame.p + ra), b = query.T_world_base * (frame.p + rb);
    const LinkAtSpeed at_speed{link.radius, a, b, va, vb, extra, inner, speed};
    const Vector3 centre = 0.5 * (a + b);
    const double size = 0.5 * (b - a).norm() + link.radius;
    const double travel =
        (limit * speed + inner) * (reaction + 0.5 * stop.time[kStopGrid]) + margin + size;
    for (std::size_t p = 0; p < reach.count; ++p) {
      const PersonCapsule& part = people.capsules[p];
      const double rough = travel + part.reach + reach.distance[p];
      if ((part.centre - centre).squaredNorm() > rough * rough) continue;
      const auto region = static_cast<std::size_t>(part.region);
      // The fingers use part of the allowed contact energy; the rest is for the arm.
      const double of_fingers = inner == 0.0 ? 0.0
                                             : inner * proof_.contact_speeds().finger_ratio_at(
                                                           part.region, query.payload);
      const double of_arm =
          std::sqrt(std::max(0.0, contact[region] * contact[region] - of_fingers * of_fingers));
      if (speed * limit + gain <= of_arm) continue;
      const RegionMotion& bounds = s.people[region];
      // The speed that the present acceleration adds before a stop begins counts, but never forbids
      // all motion.
      const double contact_now = std::max(of_arm - gain, s.min_contact_ratio * contact[region]);
      const PartApproach approach{part, bounds, contact_now,
                                  start_speed(part, s.speed_error, bounds),
                                  reaction + query.age + part.age};
      limit = lowered_limit(at_speed, approach, terms, limit);
    }
  }
  return limit;
}

}  // namespace handsel::trajectory_controller
