#include "components/grasp_planner/list/pinch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace handsel::grasp_planner {
namespace {

constexpr int kGrid = 5;  // rays along each side of a pad
constexpr double kPatch =
    0.0005;  // [m] what is nearer than this to a pad's plane touches: so far it yields
constexpr double kInside = 0.0003;        // [m] what stands out farther keeps the pad off
constexpr double kBackOff = 0.004;        // [m] the rays start this far behind the pad's plane
constexpr double kFlat = 0.94;            // cosine: the surface faces the pad
constexpr double kParallel = 0.985;       // cosine: the pads face each other
constexpr double kLeastThickness = 1e-3;  // [m]
constexpr double kGolden = 0.6180339887498949;

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
  object_.triangles().hits(place.position - kLeastThickness * place.normal, -place.normal,
                           motion_.widest(), exits);
  std::erase_if(exits, [&](const SurfaceHit& h) { return -h.normal.dot(place.normal) < kFlat; });
  why = FrameReason::nothing_opposite;
  for (auto exit = exits.rbegin(); exit != exits.rend();
       ++exit)  // the whole thickness first, then a wall
    if (auto found = across(place, along, exit->along + kLeastThickness, counters, why)) {
      found->grasp.id = id;
      return found;
    }
  return std::nullopt;
}

std::optional<PinchSearch::Found> PinchSearch::across(const SurfacePoint& place,
                                                      const Vector3& along, double thickness,
                                                      GraspList& counters, FrameReason& why) {
  ++counters.finger_solutions;
  const auto closed = motion_.at_gap(thickness);
  const auto opened = motion_.at_gap(std::min(motion_.widest(), thickness + 2 * settings_.opening));
  if (!closed || !opened || motion_.gap(*opened) < thickness + 2 * settings_.open_clearance)
    return std::nullopt;
  hand_geometry_.forward(*closed, T_closed_);
  hand_geometry_.forward(*opened, T_open_);
  const Pose T_hand_first = motion_.T_hand_pad(0, T_closed_[0]),
             T_hand_second = motion_.T_hand_pad(1, T_closed_[1]);
  if (-T_hand_first.linear().col(2).dot(T_hand_second.linear().col(2)) < kParallel)
    return std::nullopt;
  Pose T_object_first = Pose::Identity();
  T_object_first.linear() << along, -place.normal.cross(along), -place.normal;
  T_object_first.translation() = place.position;
  Found found;
  Grasp& g = found.grasp;
  g.T_object_hand = T_object_first * T_hand_first.inverse();
  why = FrameReason::pad_off_surface;
  if (!touch(0, T_object_first, found)) return std::nullopt;
  const std::size_t on_first = g.contacts.size();
  if (!touch(1, g.T_object_hand * T_hand_second, found)) return std::nullopt;
  ++counters.touch_tests;
  why = FrameReason::palm_in_object;
  if (hand_geometry_.shape.palm_touches(object_, g.T_object_hand)) return std::nullopt;
  why = FrameReason::fingers_collide;
  if (fingers_touch(T_closed_, g.T_object_hand, -settings_.depth, counters)) return std::nullopt;
  if (fingers_touch(T_open_, g.T_object_hand, settings_.open_clearance, counters))
    return std::nullopt;
  g.hand_joints = *closed;
  g.pregrasp_joints = *opened;
  found.force /= static_cast<double>(g.contacts.size());
  grip(found, std::max(on_first, g.contacts.size() - on_first));
  why = FrameReason::not_closed;
  if (!(g.margin > 0)) return std::nullopt;  // pads would slip
  return found;
}

/// Where the object meets a pad; of the places that touch, those farthest toward the pad's corners
/// are its contacts.
bool PinchSearch::touch(std::uint32_t finger, const Pose& T_object_pad, Found& found) {
  const Pad& pad = *hand_geometry_.hand.fingers()[finger].pad;
  const Vector3 z = T_object_pad.linear().col(2);
  struct Place {
    Eigen::Vector2d on_pad;
    SurfaceHit hit;
  };
  std::vector<Place> places;
  for (int i = 0; i < kGrid; ++i) {
    for (int k = 0; k < kGrid; ++k) {
      const Eigen::Vector2d p((static_cast<double>(i) / (kGrid - 1) - 0.5) * pad.width,
                              (static_cast<double>(k) / (kGrid - 1) - 0.5) * pad.height);
      object_.triangles().hits(T_object_pad * Vector3(p.x(), p.y(), -kBackOff), z,
                               kBackOff + kPatch, hits_);
      const auto first = std::find_if(hits_.begin(), hits_.end(),
                                      [&z](const SurfaceHit& h) { return h.normal.dot(z) < 0; });
      if (first == hits_.end()) continue;
      if (first->along < kBackOff - kInside) return false;
      if (-first->normal.dot(z) >= kFlat) places.push_back({p, *first});
    }
  }
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
  return !corners.empty();
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
