// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/list/pinch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace handsel::grasp_planner {
namespace {

constexpr int kGrid = 5;                // rays along each side of a pad
constexpr double kPatch = 0.0005;       // [m] compliance of a pad: nearer surface touches it
constexpr double kInside = 0.0003;      // [m] max protrusion into the plane of a pad
constexpr double kBeside = 0.001;       // [m] min extent of the contact on each side of the middle
constexpr double kBackOff = 0.004;      // [m] from the start of a ray to the plane of the pad
constexpr double kFlat = 0.94;          // min cosine of a surface that faces the pad
constexpr double kParallel = 0.985;     // min cosine of pads that face each other
constexpr double kMinThickness = 1e-3;  // [m] of the object between the pads
constexpr double kGolden = 0.6180339887498949;  // golden ratio - 1

/// Returns whether an area extends to both sides of the middle of a pad on both axes.
bool is_around_middle(const Eigen::AlignedBox2d& on_pad) {
  return !on_pad.isEmpty() && (on_pad.min().array() < -kBeside).all() &&
         (on_pad.max().array() > kBeside).all();
}

}  // namespace

PinchMotion::PinchMotion(const HandGeometry& hand_geometry) : hand_geometry_(hand_geometry) {
  const Vector &lower = hand_geometry.hand.lower_contact(),
               &upper = hand_geometry.hand.upper_contact();
  const Vector middle = 0.5 * (lower + upper);
  open_ = closed_ = middle;
  for (Eigen::Index a = 0; a < middle.size(); ++a) {
    Vector low = middle, high = middle;
    low[a] = lower[a];
    high[a] = upper[a];
    const bool opens_high = gap(high) >= gap(low);
    open_[a] = opens_high ? upper[a] : lower[a];
    closed_[a] = opens_high ? lower[a] : upper[a];
  }
  widest_ = gap(open_);
}

Pose PinchMotion::T_hand_pad(std::size_t finger, const std::vector<Pose>& T_hand_step) const {
  return hand_geometry_.chains[finger].tip_pose(T_hand_step) *
         hand_geometry_.hand.fingers()[finger].pad->T_tip_pad;
}

double PinchMotion::gap(const Vector& q) const {
  std::vector<std::vector<Pose>> T;
  hand_geometry_.forward(q, T);
  const Pose first = T_hand_pad(0, T[0]), second = T_hand_pad(1, T[1]);
  return (second.translation() - first.translation()).dot(first.linear().col(2));
}

std::optional<Vector> PinchMotion::at_gap(double wanted) const {
  double open = 0, closed = 1;
  if (wanted > widest_ || wanted < gap(configuration_at(closed))) return std::nullopt;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (open + closed);
    (gap(configuration_at(middle)) >= wanted ? open : closed) = middle;
  }
  return configuration_at(0.5 * (open + closed));
}

PinchSearch::PinchSearch(const HandGeometry& hand_geometry, const Graspable& object,
                         const GraspListSettings& settings)
    : hand_geometry_(hand_geometry), object_(object), settings_(settings), motion_(hand_geometry) {
  const std::uint64_t all = object.points().size();
  places_ = std::clamp<std::uint64_t>(
      std::uint64_t{position_count(object.box(), settings)} * settings.orientations / kTurns, 1,
      all);
  stride_ =
      std::max<std::uint64_t>(1, static_cast<std::uint64_t>(kGolden * static_cast<double>(all)));
  while (std::gcd(stride_, all) != 1) ++stride_;
}

std::optional<PinchSearch::Found> PinchSearch::frame(std::uint64_t id, GraspList& counters,
                                                     FrameReason& why) {
  const SurfacePoint& place = object_.points()[id / kTurns * stride_ % object_.points().size()];
  const double turn =
      2 * std::numbers::pi * std::fmod(static_cast<double>(id % kTurns) * kGolden, 1.0);
  const Vector3 u = place.normal.unitOrthogonal();
  const Vector3 along = std::cos(turn) * u + std::sin(turn) * place.normal.cross(u);
  std::vector<SurfaceHit> exits;
  object_.triangles().hits(place.position - kMinThickness * place.normal, -place.normal,
                           motion_.widest(), exits);
  std::erase_if(exits, [&](const SurfaceHit& h) {
    return -h.normal.dot(place.normal) < kFlat || object_.is_filled(h.position);
  });
  why = FrameReason::nothing_opposite;
  for (auto exit = exits.rbegin(); exit != exits.rend();
       ++exit)  // the whole thickness first, then one wall
    if (auto found = across(place, along, exit->along + kMinThickness, counters, why)) {
      found->grasp.id = id;
      return found;
    }
  return std::nullopt;
}

/// Sets the configurations of the hand closed on this thickness and opened before; false when the
/// hand does not open so far.
bool PinchSearch::close_on(double thickness, Grasp& g) {
  const auto closed = motion_.at_gap(thickness);
  const auto opened = motion_.at_gap(std::min(motion_.widest(), thickness + 2 * settings_.opening));
  if (!closed || !opened || motion_.gap(*opened) < thickness + 2 * settings_.open_clearance)
    return false;
  hand_geometry_.forward(*closed, T_closed_);
  hand_geometry_.forward(*opened, T_open_);
  g.hand_joints = *closed;
  g.pregrasp_joints = *opened;
  return true;
}

std::optional<PinchSearch::Found> PinchSearch::across(const SurfacePoint& place,
                                                      const Vector3& along, double thickness,
                                                      GraspList& counters, FrameReason& why) {
  ++counters.finger_solutions;
  Found found;
  Grasp& g = found.grasp;
  if (!close_on(thickness, g)) return std::nullopt;
  if (-motion_.T_hand_pad(0, T_closed_[0])
           .linear()
           .col(2)
           .dot(motion_.T_hand_pad(1, T_closed_[1]).linear().col(2)) < kParallel)
    return std::nullopt;
  Pose T_object_first = Pose::Identity();
  T_object_first.linear() << along, -place.normal.cross(along), -place.normal;
  T_object_first.translation() = place.position;
  why = FrameReason::pad_off_surface;
  const auto back = settle(0, T_object_first, found);
  if (!back) return std::nullopt;
  T_object_first.translation() += *back * place.normal;
  if (*back > 0 && !close_on(thickness += *back, g)) return std::nullopt;
  const std::size_t on_first = g.contacts.size();
  g.T_object_hand = T_object_first * motion_.T_hand_pad(0, T_closed_[0]).inverse();
  const auto apart = settle(1, g.T_object_hand * motion_.T_hand_pad(1, T_closed_[1]), found);
  if (!apart) return std::nullopt;
  if (*apart > 0) {
    if (!close_on(thickness + *apart, g)) return std::nullopt;
    g.T_object_hand = T_object_first * motion_.T_hand_pad(0, T_closed_[0]).inverse();
  }
  ++counters.touch_tests;
  why = FrameReason::palm_in_object;
  if (hand_geometry_.shape.palm_touches(object_, g.T_object_hand)) return std::nullopt;
  why = FrameReason::fingers_collide;
  if (fingers_touch(T_closed_, g.T_object_hand, -settings_.depth, counters)) return std::nullopt;
  if (fingers_touch(T_open_, g.T_object_hand, settings_.open_clearance, counters))
    return std::nullopt;
  found.force /= static_cast<double>(g.contacts.size());
  grip(found, std::max(on_first, g.contacts.size() - on_first));
  why = FrameReason::not_closed;
  if (!(g.margin > 0)) return std::nullopt;  // pads would slip
  return found;
}

/// Adds the first hits of the rays from behind a pad through its area.
void PinchSearch::sample(const Pad& pad, const Pose& T_object_pad, std::vector<Place>& places) {
  const Vector3 z = T_object_pad.linear().col(2);
  for (int i = 0; i < kGrid; ++i) {
    for (int k = 0; k < kGrid; ++k) {
      const Eigen::Vector2d p((static_cast<double>(i) / (kGrid - 1) - 0.5) * pad.width,
                              (static_cast<double>(k) / (kGrid - 1) - 0.5) * pad.height);
      object_.triangles().hits(T_object_pad * Vector3(p.x(), p.y(), -kBackOff), z,
                               kBackOff + kPatch, hits_);
      const auto first = std::find_if(hits_.begin(), hits_.end(),
                                      [&z](const SurfaceHit& h) { return h.normal.dot(z) < 0; });
      if (first != hits_.end()) places.push_back({p, *first});
    }
  }
}

/// Returns the distance [m] of a pad from the surface, 0 where it lies flat; nullopt where the pad
/// finds no support or rests on one side of its middle only. The touching places nearest to the
/// pad's corners become its contacts.
std::optional<double> PinchSearch::settle(std::uint32_t finger, const Pose& T_object_pad,
                                          Found& found) {
  const Pad& pad = *hand_geometry_.hand.fingers()[finger].pad;
  const Vector3 z = T_object_pad.linear().col(2);
  std::vector<Place> places;
  sample(pad, T_object_pad, places);
  double nearest = kBackOff;
  Eigen::AlignedBox2d out, resting;  // areas on the pad: protruding, supporting
  for (const Place& p : places) {
    nearest = std::min(nearest, p.hit.along);
    if (p.hit.along < kBackOff - kInside) out.extend(p.on_pad);
  }
  const bool hollow = !out.isEmpty();
  if (hollow && nearest < kBackOff - settings_.pad_hollow) return std::nullopt;
  const double plane = hollow ? nearest : kBackOff;
  std::erase_if(places, [&](const Place& p) {
    return p.hit.along > plane + kPatch || -p.hit.normal.dot(z) < kFlat;
  });
  double inward = 0;  // the surface of a hollow faces its middle
  for (const Place& p : places) {
    resting.extend(p.on_pad);
    inward -= p.on_pad.dot((T_object_pad.linear().transpose() * p.hit.normal).head<2>());
  }
  if (hollow && !(inward > 0 && is_around_middle(out) && is_around_middle(resting)))
    return std::nullopt;
  std::vector<const Place*> corners;
  for (const Eigen::Vector2d& toward : {Eigen::Vector2d(1, 1), Eigen::Vector2d(-1, 1),
                                        Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, -1)}) {
    const auto far =
        std::max_element(places.begin(), places.end(), [&](const Place& a, const Place& b) {
          return a.on_pad.dot(toward) < b.on_pad.dot(toward);
        });
    if (far != places.end() && std::find(corners.begin(), corners.end(), &*far) == corners.end())
      corners.push_back(&*far);
  }
  const double mu = settings_.friction > 0 ? settings_.friction : object_.friction();
  for (const Place* c : corners) {
    found.grasp.contacts.push_back({finger, c->hit.position, c->hit.normal, c->hit.triangle,
                                    c->hit.barycentric, mu,
                                    object_.curvature_near(c->hit.position, c->hit.normal)});
    found.contacts.push_back({c->hit.position, -c->hit.normal, mu});
    found.force -= c->hit.normal.dot(z);
  }
  if (corners.empty()) return std::nullopt;
  return kBackOff - plane;
}

bool PinchSearch::fingers_touch(const std::vector<std::vector<Pose>>& T_hand_step,
                                const Pose& T_object_hand, double clearance,
                                GraspList& counters) const {
  for (int f = 0; f < 2; ++f) {
    ++counters.touch_tests;
    if (hand_geometry_.shape.finger_touches(f, T_hand_step[static_cast<std::size_t>(f)], object_,
                                            T_object_hand, clearance))
      return true;
  }
  return false;
}

void PinchSearch::grip(Found& found, std::size_t max_on_a_pad) const {
  Grasp& g = found.grasp;
  GripForceSettings limits = limits_of(hand_geometry_.hand, settings_.grip);
  limits.max_normal /= static_cast<double>(max_on_a_pad);
  const GripForces grip = grip_forces(found.contacts, object_.com(), object_.mass(), limits);
  g.margin = grip.margin;
  g.hand_effort = Vector::Zero(g.hand_joints.size());
  const Pose T_hand_object = g.T_object_hand.inverse();
  for (std::size_t k = 0; k < grip.forces.size(); ++k) {
    const std::uint32_t f = g.contacts[k].finger;
    hand_geometry_.chains[f].add_effort(T_closed_[f], T_hand_object, g.contacts[k].position,
                                        grip.forces[k], g.hand_effort);
  }
}

}  // namespace handsel::grasp_planner
