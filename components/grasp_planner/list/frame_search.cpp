// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/list/frame_search.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace handsel::grasp_planner {
namespace {

// Max cosine of fingertip direction and surface normal: above it the finger passes through the
// object.
constexpr double kFromBehind = 0.6;
// Min cosine of pad direction and inward normal: excludes contacts on the back of a finger.
constexpr double kMinPush = 0.25;
constexpr double kOnFace = 0.94;   // min cosine of a contact on the face of a triangle, not an edge
constexpr double kClosed = 1e-4;   // [m] max gap of a closed fingertip to the surface
constexpr int kClosingSteps = 60;  // max steps of a closing finger
constexpr int kInnerPlaces = 8;    // values tried for the inner axis of a two-axis finger
// Min fraction of the wanted opening that a finger must reach.
constexpr double kMinBackOff = 0.4;

double force_alignment(const Eigen::Matrix3Xd& J, const Vector3& normal) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(Eigen::Matrix3d(J * J.transpose()));
  return std::abs(normal.dot(axes.eigenvectors().col(0)));
}

// Returns whether the fingertip comes from outside with its pad toward the surface.
bool plausible(const FingerWorkspace::Seed& seed, const Vector3& normal) {
  return normal.dot(seed.tip_direction) <= kFromBehind &&
         -normal.dot(seed.closing_direction) >= kMinPush;
}

}  // namespace

FrameSearch::FrameSearch(const HandGeometry& hand_geometry, const FingerWorkspaces& workspaces,
                         const Graspable& object, const GraspListSettings& settings)
    : hand_geometry_(hand_geometry),
      workspaces_(workspaces),
      object_(object),
      settings_(settings),
      seen_(object.points().size(), 0) {}

void FrameSearch::candidates(int finger, const Pose& T_object_hand,
                             std::vector<std::uint32_t>& points) {
  points.clear();
  ++query_;
  const FingerWorkspace& workspace = workspaces_[static_cast<std::size_t>(finger)];
  // A workspace that is a line or a sheet passes between the points.
  const double wider =
      workspace.has_volume()
          ? 0.0
          : settings_.step_fraction *
                hand_geometry_.chains[static_cast<std::size_t>(finger)].tip_radius();
  for (const WorkspaceSphere& s : workspace.spheres()) {
    hits_.clear();
    object_.tip_centres().inside_ball(T_object_hand * s.centre, s.radius + wider, hits_);
    for (const std::uint32_t i : hits_) {
      if (seen_[i] == query_) continue;
      seen_[i] = query_;
      points.push_back(i);
    }
  }
}

bool FrameSearch::holds(int finger, const Pose& T_object_hand, const SurfacePoint& place,
                        GraspList& counters, FingerContact& out) {
  const FingerChain& chain = hand_geometry_.chains[static_cast<std::size_t>(finger)];
  const HandModel& hand = hand_geometry_.hand;
  const Vector3 normal = T_object_hand.linear().transpose() * place.normal;
  chain.forward(out.q, out.T_hand_step);
  const Vector3 p_hand_tip = chain.tip(out.T_hand_step);
  ++counters.touch_tests;
  if (hand_geometry_.shape.finger_touches(finger, out.T_hand_step, object_, T_object_hand,
                                          -settings_.depth))
    return false;
  if (hand_geometry_.shape.finger_touches_palm(finger, out.T_hand_step)) return false;
  // The finger must open along the normal within its joint limits, clear of the object. An axis
  // shared with another finger keeps its value.
  Vector lower = hand.lower_contact(), upper = hand.upper_contact();
  for (const int a : chain.axes()) {
    lower[a] = hand_geometry_.shared(a) ? out.q[a]
                                        : hand.model().axes()[static_cast<std::size_t>(a)].lower;
    upper[a] = hand_geometry_.shared(a) ? out.q[a]
                                        : hand.model().axes()[static_cast<std::size_t>(a)].upper;
  }
  out.q_open = out.q;
  ++counters.finger_solutions;
  chain.inverse(p_hand_tip + settings_.opening * normal, lower, upper, out.q_open, 2e-4, 15);
  chain.forward(out.q_open, T_);
  if ((chain.tip(T_) - p_hand_tip).dot(normal) < kMinBackOff * settings_.opening) return false;
  ++counters.touch_tests;
  if (hand_geometry_.shape.finger_touches(finger, T_, object_, T_object_hand,
                                          settings_.open_clearance))
    return false;
  if (hand_geometry_.shape.finger_touches_palm(finger, T_)) return false;
  out.place = place;
  out.force = force_alignment(chain.jacobian(out.T_hand_step), normal);
  return true;
}

bool FrameSearch::touches_at(int finger, const Pose& T_object_hand, Vector q,
                             FingerContact& out) const {
  const FingerChain& chain = hand_geometry_.chains[static_cast<std::size_t>(finger)];
  const int closing = chain.axes().back();
  const double from = chain.closing_sign() > 0 ? hand_geometry_.hand.lower_contact()[closing]
                                               : hand_geometry_.hand.upper_contact()[closing];
  const double to = chain.closing_sign() > 0 ? hand_geometry_.hand.upper_contact()[closing]
                                             : hand_geometry_.hand.lower_contact()[closing];
  // The tip moves at most lever * angle, so steps of distance / lever never pass through the
  // surface.
  double lever = 0;
  for (const double ratio : {0.0, 0.5, 1.0}) {
    q[closing] = from + ratio * (to - from);
    chain.forward(q, T_closing_);
    lever = std::max(lever, 1.2 * chain.jacobian(T_closing_).rightCols<1>().norm());
  }
  double travel = 0;
  const double length = std::abs(to - from), sign = to > from ? 1.0 : -1.0;
  for (int i = 0; i < kClosingSteps && travel <= length; ++i) {
    q[closing] = from + sign * travel;
    chain.forward(q, T_closing_);
    const Vector3 tip = T_object_hand * chain.tip(T_closing_);
    const SurfaceHit hit = object_.triangles().nearest(tip);
    const double gap = hit.along - chain.tip_radius();
    if (gap < -kClosed) return false;
    if (gap < kClosed) {
      const Vector3 push = T_object_hand.linear() * chain.closing_direction(T_closing_);
      if ((tip - hit.position).dot(hit.normal) < kOnFace * hit.along ||
          -push.dot(hit.normal) < kMinPush)
        return false;
      out.q = q;
      out.place = {hit.position, hit.normal, hit.triangle, hit.barycentric,
                   object_.curvature_near(hit.position, hit.normal)};
      return true;
    }
    travel += std::max(gap, kClosed) / lever;
  }
  return false;
}

std::vector<FingerContact> FrameSearch::close(int finger, const Pose& T_object_hand,
                                              GraspList& counters) {
  const FingerChain& chain = hand_geometry_.chains[static_cast<std::size_t>(finger)];
  const int places = chain.axes().size() > 1 ? kInnerPlaces : 1;
  std::vector<FingerContact> found;
  FingerContact contact;
  for (int k = 0; k < places; ++k) {
    Vector q = hand_geometry_.hand.pregrasp();
    if (places > 1) {
      const int inner = chain.axes().front();
      q[inner] = hand_geometry_.hand.lower_contact()[inner] +
                 (k + 0.5) / places *
                     (hand_geometry_.hand.upper_contact()[inner] -
                      hand_geometry_.hand.lower_contact()[inner]);
    }
    ++counters.finger_solutions;
    if (touches_at(finger, T_object_hand, q, contact) &&
        holds(finger, T_object_hand, contact.place, counters, contact))
      found.push_back(contact);
  }
  return found;
}

bool FrameSearch::check(int finger, const Pose& T_object_hand, std::uint32_t point,
                        GraspList& counters, FingerContact& out) {
  const FingerChain& chain = hand_geometry_.chains[static_cast<std::size_t>(finger)];
  const HandModel& hand = hand_geometry_.hand;
  const Pose T_hand_object = T_object_hand.inverse();
  const Vector3 p_hand_tip = T_hand_object * object_.tip_centre(point);
  const Vector3 normal = T_hand_object.linear() * object_.points()[point].normal;
  for (const FingerWorkspace::Seed& seed :
       workspaces_[static_cast<std::size_t>(finger)].seeds(p_hand_tip)) {
    if (!plausible(seed, normal)) continue;
    out.q = hand.pregrasp();
    for (std::size_t k = 0; k < chain.axes().size(); ++k)
      out.q[chain.axes()[k]] = seed.q[static_cast<Eigen::Index>(k)];
    ++counters.finger_solutions;
    if (!chain.inverse(p_hand_tip, hand.lower_contact(), hand.upper_contact(), out.q)) continue;
    if (holds(finger, T_object_hand, object_.points()[point], counters, out)) return true;
  }
  return false;
}

std::vector<FingerContact> FrameSearch::contacts(int finger, const Pose& T_object_hand,
                                                 const std::vector<std::uint32_t>& points,
                                                 GraspList& counters) {
  if (!workspaces_[static_cast<std::size_t>(finger)].has_volume())
    return close(finger, T_object_hand, counters);
  std::vector<FingerContact> found;
  std::uint32_t tries = 0;
  const Pose T_hand_object = T_object_hand.inverse();
  const double apart = 1.2 * hand_geometry_.tip_radius();
  FingerContact contact;
  for (const std::uint32_t i : points) {
    if (found.size() >= settings_.contacts_per_finger || tries >= settings_.tries_per_finger) break;
    const SurfacePoint& p = object_.points()[i];
    const bool known = std::any_of(found.begin(), found.end(), [&](const FingerContact& f) {
      return (f.place.position - p.position).squaredNorm() < apart * apart &&
             f.place.normal.dot(p.normal) > 0.8;
    });
    if (known) continue;
    const auto& seeds =
        workspaces_[static_cast<std::size_t>(finger)].seeds(T_hand_object * object_.tip_centre(i));
    const Vector3 normal = T_hand_object.linear() * p.normal;
    if (std::none_of(seeds.begin(), seeds.end(),
                     [&](const auto& seed) { return plausible(seed, normal); }))
      continue;
    ++tries;
    if (check(finger, T_object_hand, i, counters, contact)) found.push_back(contact);
  }
  return found;
}

}  // namespace handsel::grasp_planner
