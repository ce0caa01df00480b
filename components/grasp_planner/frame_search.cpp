#include "components/grasp_planner/frame_search.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace handsel::grasp_planner {
namespace {

constexpr double kFromBehind = 0.6;    // cosine: a fingertip pointing out along the normal would come through the object
constexpr double kLeastPush = 0.25;    // cosine between the way the pad faces and into the surface: no contact on the back of a finger
constexpr double kLeastBackOff = 0.4;  // share of the opening below which a finger counts as unable to open

double force_alignment(const Eigen::Matrix3Xd& J, const Vector3& normal) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(Eigen::Matrix3d(J * J.transpose()));
  return std::abs(normal.dot(axes.eigenvectors().col(0)));
}

// Does the fingertip come from outside, its pad toward the surface?
bool plausible(const FingerWorkspace::Seed& seed, const Vector3& normal) {
  return normal.dot(seed.tip_direction) <= kFromBehind && -normal.dot(seed.closing_direction) >= kLeastPush;
}

}  // namespace

FrameSearch::FrameSearch(const HandKit& kit, const FingerWorkspaces& workspaces, const Graspable& object, const GraspListSettings& settings)
    : kit_(kit), workspaces_(workspaces), object_(object), settings_(settings), seen_(object.points().size(), 0) {}

void FrameSearch::candidates(int finger, const Pose& T_object_hand, std::vector<std::uint32_t>& points) {
  points.clear();
  ++query_;
  for (const WorkspaceSphere& s : workspaces_[static_cast<std::size_t>(finger)].spheres()) {
    hits_.clear();
    object_.tip_centres().inside_ball(T_object_hand * s.centre, s.radius, hits_);
    for (const std::uint32_t i : hits_) {
      if (seen_[i] == query_) continue;
      seen_[i] = query_;
      points.push_back(i);
    }
  }
}

bool FrameSearch::judge(int finger, const Pose& T_object_hand, std::uint32_t point, GraspList& counters, FingerContact& out) {
  const FingerChain& chain = kit_.chains[static_cast<std::size_t>(finger)];
  const HandModel& hand = kit_.hand;
  const Pose T_hand_object = T_object_hand.inverse();
  const Vector3 p_hand_tip = T_hand_object * object_.tip_centre(point);
  const Vector3 normal = T_hand_object.linear() * object_.points()[point].normal;
  for (const FingerWorkspace::Seed& seed : workspaces_[static_cast<std::size_t>(finger)].seeds(p_hand_tip)) {
    if (!plausible(seed, normal)) continue;
    out.q = hand.pregrasp();
    for (std::size_t k = 0; k < chain.axes().size(); ++k) out.q[chain.axes()[k]] = seed.q[static_cast<Eigen::Index>(k)];
    ++counters.finger_solutions;
    if (!chain.inverse(p_hand_tip, hand.lower_contact(), hand.upper_contact(), out.q)) continue;
    chain.forward(out.q, out.T_hand_step);
    const Eigen::Matrix3Xd J = chain.jacobian(out.T_hand_step);
    ++counters.touch_tests;
    if (kit_.shape.finger_touches(finger, out.T_hand_step, object_, T_object_hand, -settings_.depth)) continue;
    if (kit_.shape.finger_touches_palm(finger, out.T_hand_step)) continue;
    // Back off along the normal, as far as the joints allow, and stay clear of the object there.
    Vector lower = hand.lower_contact(), upper = hand.upper_contact();
    for (const int a : chain.axes()) {
      lower[a] = hand.model().axes()[static_cast<std::size_t>(a)].lower;
      upper[a] = hand.model().axes()[static_cast<std::size_t>(a)].upper;
    }
    out.q_open = out.q;
    ++counters.finger_solutions;
    chain.inverse(p_hand_tip + settings_.opening * normal, lower, upper, out.q_open, 2e-4, 15);
    chain.forward(out.q_open, T_);
    if ((chain.tip(T_) - p_hand_tip).dot(normal) < kLeastBackOff * settings_.opening) continue;
    ++counters.touch_tests;
    if (kit_.shape.finger_touches(finger, T_, object_, T_object_hand, settings_.open_clearance)) continue;
    if (kit_.shape.finger_touches_palm(finger, T_)) continue;
    out.point = point;
    out.force = force_alignment(J, normal);
    return true;
  }
  return false;
}

std::vector<FingerContact> FrameSearch::contacts(int finger, const Pose& T_object_hand, const std::vector<std::uint32_t>& points,
                                                 GraspList& counters) {
  std::vector<FingerContact> found;
  std::uint32_t tries = 0;
  const Pose T_hand_object = T_object_hand.inverse();
  const double apart = 1.2 * kit_.tip_radius();
  FingerContact contact;
  for (const std::uint32_t i : points) {
    if (found.size() >= settings_.contacts_per_finger || tries >= settings_.tries_per_finger) break;
    const SurfacePoint& p = object_.points()[i];
    const bool known = std::any_of(found.begin(), found.end(), [&](const FingerContact& f) {
      const SurfacePoint& o = object_.points()[f.point];
      return (o.position - p.position).squaredNorm() < apart * apart && o.normal.dot(p.normal) > 0.8;
    });
    if (known) continue;
    const auto& seeds = workspaces_[static_cast<std::size_t>(finger)].seeds(T_hand_object * object_.tip_centre(i));
    const Vector3 normal = T_hand_object.linear() * p.normal;
    if (std::none_of(seeds.begin(), seeds.end(), [&](const auto& seed) { return plausible(seed, normal); })) continue;
    ++tries;
    if (judge(finger, T_object_hand, i, counters, contact)) found.push_back(contact);
  }
  return found;
}

}  // namespace handsel::grasp_planner
