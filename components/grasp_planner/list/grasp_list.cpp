// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/list/grasp_list.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/geometry/segments.hpp"
#include "components/grasp_planner/list/epsilon.hpp"
#include "components/grasp_planner/list/frame_search.hpp"

#include "components/grasp_planner/list/pinch.hpp"
#include "components/grasp_planner/list/so3_grid.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr std::size_t kMinContacts = 3;
constexpr std::size_t kScoredCombinations = 64;

/// Which contact each finger uses; -1: none, the finger rests.
using Combination = std::vector<int>;

}  // namespace

const char* reason_text(FrameReason reason) {
  switch (reason) {
    case FrameReason::grasped:
      return "grasp found";
    case FrameReason::thumb_out_of_reach:
      return "no surface in the workspace of the thumb";
    case FrameReason::fingers_out_of_reach:
      return "surface in the workspaces of fewer than two fingers besides the thumb";
    case FrameReason::palm_in_object:
      return "the palm collides with the object";
    case FrameReason::thumb_without_contact:
      return "the thumb finds no contact it can reach, push into and open from without collision";
    case FrameReason::fingers_without_contact:
      return "fewer than two fingers besides the thumb find such a contact";
    case FrameReason::fingers_collide:
      return "fingers collide with each other or, at rest, with the object";
    case FrameReason::not_closed:
      return "no combination of contacts is force-closed";
    case FrameReason::nothing_opposite:
      return "no surface opposite within the opening of the hand";
    case FrameReason::pad_off_surface:
      return "a pad would not lie on the surface";
    case FrameReason::count:
      break;
  }
  return "unknown";
}

Refusals GraspList::refusals() const {
  Refusals out;
  for (std::size_t r = 1; r < reasons.size(); ++r) {
    if (reasons[r] > 0)
      out.push_back(
          {std::to_string(reasons[r]) + " frames", reason_text(static_cast<FrameReason>(r))});
  }
  return out;
}

struct GraspLister::Impl {
  Impl(std::shared_ptr<const HandGeometry> k, std::shared_ptr<const FingerWorkspaces> w,
       std::shared_ptr<const Graspable> o, const GraspListSettings& s)
      : hand_geometry(std::move(k)),
        workspaces(std::move(w)),
        object(std::move(o)),
        settings(s),
        search(*hand_geometry, *workspaces, *object, settings) {
    positions = uniform_positions(object->box(), position_count(object->box(), settings));
    orientations = so3_sequence(settings.orientations);
    out.hand = hand_geometry->hand.name();
    out.object = object->name();
    out.min_margin = settings.min_margin;
    if (hand_geometry->hand.pinches()) pinch.emplace(*hand_geometry, *object, settings);
    hand_geometry->forward(hand_geometry->hand.rest(), T_rest);
    hand_geometry->forward(hand_geometry->hand.pregrasp(), T_pregrasp);
  }

  std::uint64_t frames() const {
    return pinch ? pinch->frames() : positions.size() * orientations.size();
  }

  FrameReason frame(std::uint64_t id) {
    if (pinch) return pinch_frame(id);
    const Pose T_object_grasp =
        make_pose(positions[id % positions.size()], orientations[id / positions.size()]);
    const Pose T_object_hand = T_object_grasp * hand_geometry->hand.T_hand_grasp().inverse();
    const std::size_t fingers = hand_geometry->chains.size();
    points.resize(fingers);
    search.candidates(0, T_object_hand, points[0]);
    if (points[0].empty()) return FrameReason::thumb_out_of_reach;
    std::size_t reached = 0;
    for (std::size_t f = 1; f < fingers; ++f) {
      search.candidates(static_cast<int>(f), T_object_hand, points[f]);
      reached += !points[f].empty();
    }
    if (reached + 1 < kMinContacts) return FrameReason::fingers_out_of_reach;
    ++out.touch_tests;
    if (hand_geometry->shape.palm_touches(*object, T_object_hand))
      return FrameReason::palm_in_object;
    contacts.assign(fingers, {});
    contacts[0] = search.contacts(0, T_object_hand, points[0], out);
    if (contacts[0].empty()) return FrameReason::thumb_without_contact;
    std::size_t touching = 0;
    for (std::size_t f = 1; f < fingers; ++f) {
      if (touching + (fingers - f) + 1 < kMinContacts) return FrameReason::fingers_without_contact;
      contacts[f] = search.contacts(static_cast<int>(f), T_object_hand, points[f], out);
      touching += !contacts[f].empty();
    }
    if (touching + 1 < kMinContacts) return FrameReason::fingers_without_contact;
    return combine(id, T_object_hand);
  }

  /// Posture of a finger without contact: rest, else pre-grasp; -1 when both collide with the
  /// object.
  int idle_configuration(std::size_t f, const Pose& T_object_hand) {
    ++out.touch_tests;
    if (!hand_geometry->shape.finger_touches(static_cast<int>(f), T_rest[f], *object, T_object_hand,
                                             0.002))
      return 0;
    if (!hand_geometry->shape.finger_touches(static_cast<int>(f), T_pregrasp[f], *object,
                                             T_object_hand, 0.002))
      return 1;
    return -1;
  }

  const std::vector<Pose>& poses(std::size_t f, int choice) const {
    if (choice >= 0) return contacts[f][static_cast<std::size_t>(choice)].T_hand_step;
    return idle[f] == 1 ? T_pregrasp[f] : T_rest[f];
  }

  FrameReason pinch_frame(std::uint64_t id) {
    FrameReason why{};
    auto found = pinch->frame(id, out, why);
    if (!found) return why;
    const WrenchMatrix w =
        contact_wrenches(found->contacts, settings.cone_edges, object->com(), 1 / object->radius());
    ++out.closure_tests;
    if (!force_closure(w)) return FrameReason::not_closed;
    Grasp& g = found->grasp;
    g.epsilon = epsilon(w);
    if (!(g.epsilon > 0)) return FrameReason::not_closed;
    GraspScores s;
    Vector3 mean = Vector3::Zero();
    const auto n = static_cast<double>(g.contacts.size());
    for (const Contact& c : g.contacts) {
      mean += c.position / n;
      s.curvature += (1 - c.curvature) / n;
    }
    s.force = found->force;
    s.centre = std::clamp(1 - (mean - object->com()).norm() / object->radius(), 0.0, 1.0);
    s.stability = std::clamp(g.epsilon / settings.full_epsilon, 0.0, 1.0);
    g.quality = quality(s);
    const double free = room(g);
    out.grasps.push_back({std::move(g), s, free});
    return FrameReason::grasped;
  }

  // Enumerates all combinations depth first; a colliding pair of finger configurations prunes its
  // branch.
  void enumerate(std::size_t f, Combination& chosen, std::size_t used,
                 std::vector<Combination>& found) {
    const std::size_t fingers = contacts.size();
    if (f == fingers) {
      if (used >= kMinContacts) found.push_back(chosen);
      return;
    }
    for (int choice = static_cast<int>(contacts[f].size()) - 1; choice >= -1; --choice) {
      if (choice < 0 && (f == 0 || idle[f] < 0 || used + (fingers - f - 1) < kMinContacts))
        continue;
      bool free = true;
      for (std::size_t g = 0; g < f && free; ++g) free = !clash(g, chosen[g], f, choice);
      if (!free) continue;
      chosen[f] = choice;
      enumerate(f + 1, chosen, used + (choice >= 0), found);
    }
  }

  bool clash(std::size_t g, int a, std::size_t f, int b) {
    signed char& known =
        clashes[((g * contacts.size() + f) * width + static_cast<std::size_t>(a + 1)) * width +
                static_cast<std::size_t>(b + 1)];
    if (known < 0)
      known = pull_apart(g, a, f, b) ||
              hand_geometry->shape.fingers_touch(static_cast<int>(g), poses(g, a),
                                                 static_cast<int>(f), poses(f, b));
    return known != 0;
  }

  /// Returns whether two fingers conflict on a shared axis: both need the same value, and a finger
  /// without contact conflicts with one in contact.
  bool pull_apart(std::size_t g, int a, std::size_t f, int b) const {
    if (a < 0 && b < 0) return false;
    for (const int axis : hand_geometry->hand.fingers()[g].axes) {
      if (std::find(hand_geometry->hand.fingers()[f].axes.begin(),
                    hand_geometry->hand.fingers()[f].axes.end(),
                    axis) == hand_geometry->hand.fingers()[f].axes.end())
        continue;
      if (a < 0 || b < 0) return true;
      const double differ = contacts[g][static_cast<std::size_t>(a)].q[axis] -
                            contacts[f][static_cast<std::size_t>(b)].q[axis];
      if (std::abs(differ) > 1e-6) return true;
    }
    return false;
  }

  std::vector<PointContact> point_contacts(const Combination& c) const {
    std::vector<PointContact> out_contacts;
    for (std::size_t f = 0; f < c.size(); ++f) {
      if (c[f] < 0) continue;
      const SurfacePoint& p = contacts[f][static_cast<std::size_t>(c[f])].place;
      out_contacts.push_back({p.position, -p.normal, friction()});
    }
    return out_contacts;
  }

  double friction() const { return settings.friction > 0 ? settings.friction : object->friction(); }

  // Returns the scores that need no force-closure computation.
  GraspScores cheap_scores(const Combination& c) const {
    GraspScores s;
    Vector3 mean = Vector3::Zero();
    double n = 0;
    for (std::size_t f = 0; f < c.size(); ++f) {
      if (c[f] < 0) continue;
      const FingerContact& contact = contacts[f][static_cast<std::size_t>(c[f])];
      mean += contact.place.position;
      s.force += contact.force;
      s.curvature += 1 - contact.place.curvature;
      n += 1;
    }
    s.force /= n;
    s.curvature /= n;
    s.centre = std::clamp(1 - (mean / n - object->com()).norm() / object->radius(), 0.0, 1.0);
    return s;
  }

  double quality(const GraspScores& s) const {
    const QualityWeights& w = settings.weights;
    const double sum = w.stability + w.centre + w.force + w.curvature;
    return (w.stability * s.stability + w.centre * s.centre + w.force * s.force +
            w.curvature * s.curvature) /
           sum;
  }

  FrameReason combine(std::uint64_t id, const Pose& T_object_hand) {
    idle.assign(contacts.size(), 0);
    for (std::size_t f = 1; f < contacts.size(); ++f)
      idle[f] = idle_configuration(f, T_object_hand);
    width = 1;
    for (const auto& of_finger : contacts) width = std::max(width, of_finger.size() + 1);
    clashes.assign(contacts.size() * contacts.size() * width * width, -1);
    std::vector<Combination> found;
    Combination chosen(contacts.size(), -1);
    enumerate(0, chosen, 0, found);
    if (found.empty()) return FrameReason::fingers_collide;

    struct Rated {
      double rank;
      std::size_t index;
      GraspScores scores;
    };
    std::vector<Rated> rated;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const GraspScores s = cheap_scores(found[i]);
      const auto used = static_cast<double>(
          std::count_if(found[i].begin(), found[i].end(), [](int k) { return k >= 0; }));
      rated.push_back({quality(s) + 0.05 * used, i, s});
    }
    std::stable_sort(rated.begin(), rated.end(),
                     [](const Rated& a, const Rated& b) { return a.rank > b.rank; });
    const double scale = 1 / object->radius();
    double best = -std::numeric_limits<double>::infinity(), winner_epsilon = 0;
    Rated winner{};
    std::size_t closed = 0;
    for (Rated& r : rated) {
      if (closed >= kScoredCombinations) break;
      const WrenchMatrix w = contact_wrenches(point_contacts(found[r.index]), settings.cone_edges,
                                              object->com(), scale);
      ++out.closure_tests;
      if (!force_closure(w)) continue;
      const double e = epsilon(w);
      if (!(e > 0)) continue;
      ++closed;
      r.scores.stability = std::clamp(e / settings.full_epsilon, 0.0, 1.0);
      const double value = quality(r.scores) + settings.weight_grip * sturdiness(found[r.index]);
      if (value <= best) continue;
      best = value;
      winner = r;
      winner_epsilon = e;
    }
    if (closed == 0) return FrameReason::not_closed;
    const Grasp grasp =
        make_grasp(id, T_object_hand, found[winner.index], winner_epsilon, quality(winner.scores));
    out.grasps.push_back({grasp, winner.scores, room(grasp)});
    return FrameReason::grasped;
  }

  double room(const Grasp& g) const {
    std::vector<std::vector<Pose>> T_hand_step;
    hand_geometry->forward(g.hand_joints, T_hand_step);
    std::vector<HandShape::Round> rounds = hand_geometry->shape.rounds(T_hand_step);
    for (HandShape::Round& r : rounds) {
      r.a = g.T_object_hand * r.a;
      r.b = g.T_object_hand * r.b;
    }
    std::size_t free = 0;
    for (const SurfacePoint& p : object->points()) {
      free += std::all_of(rounds.begin(), rounds.end(), [&](const HandShape::Round& r) {
        const double reach = r.radius + settings.free_distance;
        const double ball = reach + 0.5 * (r.b - r.a).norm();  // around the round and its margin
        if ((p.position - 0.5 * (r.a + r.b)).squaredNorm() > ball * ball) return true;
        Vector3 on_round, on_point;
        return nearest_points(r.a, r.b, p.position, p.position, on_round, on_point) > reach * reach;
      });
    }
    return static_cast<double>(free) / static_cast<double>(object->points().size());
  }

  Grasp make_grasp(std::uint64_t id, const Pose& T_object_hand, const Combination& c,
                   double grasp_epsilon, double grasp_quality) const {
    Grasp g;
    g.id = id;
    g.T_object_hand = T_object_hand;
    g.hand_joints = hand_geometry->hand.rest();
    g.pregrasp_joints = hand_geometry->hand.rest();
    g.epsilon = grasp_epsilon;
    g.quality = grasp_quality;
    for (std::size_t f = 0; f < c.size(); ++f) {
      const FingerContact* contact =
          c[f] >= 0 ? &contacts[f][static_cast<std::size_t>(c[f])] : nullptr;
      const Vector& idle_q =
          idle[f] == 1 ? hand_geometry->hand.pregrasp() : hand_geometry->hand.rest();
      for (const int a : hand_geometry->hand.fingers()[f].axes) {
        g.hand_joints[a] = contact != nullptr ? contact->q[a] : idle_q[a];
        g.pregrasp_joints[a] = contact != nullptr ? contact->q_open[a] : idle_q[a];
      }
      if (contact == nullptr) continue;
      const SurfacePoint& p = contact->place;
      g.contacts.push_back({static_cast<std::uint32_t>(f), p.position, p.normal, p.triangle,
                            p.barycentric, friction(), p.curvature});
    }
    grip(c, g);
    return g;
  }

  /// Returns the grip of a combination, the friction cones narrowed by the angle that the normal
  /// turns within the creep of the fingertip (own method).
  GripForces grip_of(const Combination& c) const {
    std::vector<PointContact> narrowed = point_contacts(c);
    std::size_t k = 0;
    for (std::size_t f = 0; f < c.size(); ++f) {
      if (c[f] < 0) continue;
      const double curvature = contacts[f][static_cast<std::size_t>(c[f])].place.curvature;
      const double turn = settings.creep * curvature / hand_geometry->chains[f].tip_radius();
      narrowed[k++].friction = std::tan(std::max(0.0, std::atan(friction()) - turn));
    }
    return grip_forces(narrowed, object->com(), object->mass(),
                       limits_of(hand_geometry->hand, settings.grip));
  }

  /// Grip margin / sturdy_margin, -2 to 1; 0 where it has no weight.
  double sturdiness(const Combination& c) const {
    if (!(settings.weight_grip > 0)) return 0;
    return std::clamp(grip_of(c).margin / settings.sturdy_margin, -2.0, 1.0);
  }

  void grip(const Combination& c, Grasp& g) const {
    const GripForces grip = grip_of(c);
    g.margin = grip.margin;
    g.hand_effort = Vector::Zero(g.hand_joints.size());
    const Pose T_hand_object = g.T_object_hand.inverse();
    for (std::size_t k = 0; k < grip.forces.size(); ++k) {
      const std::size_t f = g.contacts[k].finger;
      hand_geometry->chains[f].add_effort(contacts[f][static_cast<std::size_t>(c[f])].T_hand_step,
                                          T_hand_object, g.contacts[k].position, grip.forces[k],
                                          g.hand_effort);
    }
  }

  std::shared_ptr<const HandGeometry> hand_geometry;
  std::shared_ptr<const FingerWorkspaces> workspaces;
  std::shared_ptr<const Graspable> object;
  GraspListSettings settings;
  FrameSearch search;
  std::optional<PinchSearch> pinch;
  std::vector<Vector3> positions;
  std::vector<Eigen::Quaterniond> orientations;
  std::vector<std::vector<Pose>> T_rest, T_pregrasp;
  std::vector<std::vector<std::uint32_t>> points;
  std::vector<std::vector<FingerContact>> contacts;
  std::vector<int> idle;
  std::vector<signed char> clashes;  // of finger, finger, choice, choice: -1 not known
  std::size_t width{};               // max choices of a finger
  GraspList out;
};

GraspLister::GraspLister(std::shared_ptr<const HandGeometry> hand_geometry,
                         std::shared_ptr<const FingerWorkspaces> workspaces,
                         std::shared_ptr<const Graspable> object, const GraspListSettings& settings,
                         GraspList begun)
    : impl_(std::make_unique<Impl>(std::move(hand_geometry), std::move(workspaces),
                                   std::move(object), settings)) {
  if (begun.frames > 0) impl_->out = std::move(begun);
}
GraspLister::~GraspLister() = default;
GraspLister::GraspLister(GraspLister&&) noexcept = default;

std::uint64_t GraspLister::frames() const { return impl_->frames(); }

std::size_t GraspLister::found() const { return impl_->out.grasps.size(); }

void GraspLister::test(std::uint64_t first, std::uint64_t count) {
  const std::uint64_t end = std::min(frames(), first + count);
  for (std::uint64_t id = first; id < end; ++id) {
    ++impl_->out.reasons[static_cast<std::size_t>(impl_->frame(id))];
    ++impl_->out.frames;
  }
}

bool GraspLister::advance(std::uint64_t count) {
  test(impl_->out.frames, count);
  return impl_->out.frames < frames();
}

GraspList GraspLister::list() const { return merged({impl_->out}); }

std::uint64_t frame_count(const HandGeometry& hand_geometry, const Graspable& object,
                          const GraspListSettings& settings) {
  if (hand_geometry.hand.pinches()) return PinchSearch(hand_geometry, object, settings).frames();
  return uniform_positions(object.box(), position_count(object.box(), settings)).size() *
         std::uint64_t{settings.orientations};
}

GraspList merged(std::vector<GraspList> parts) {
  GraspList out = std::move(parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) {
    std::move(parts[i].grasps.begin(), parts[i].grasps.end(), std::back_inserter(out.grasps));
    for (std::size_t r = 0; r < out.reasons.size(); ++r) out.reasons[r] += parts[i].reasons[r];
    out.frames += parts[i].frames;
    out.finger_solutions += parts[i].finger_solutions;
    out.touch_tests += parts[i].touch_tests;
    out.closure_tests += parts[i].closure_tests;
  }
  std::sort(out.grasps.begin(), out.grasps.end(), [&](const ListedGrasp& a, const ListedGrasp& b) {
    const bool a_bears = out.bears(a.grasp), b_bears = out.bears(b.grasp);
    if (a_bears != b_bears) return a_bears;
    return a.grasp.quality != b.grasp.quality ? a.grasp.quality > b.grasp.quality
                                              : a.grasp.id < b.grasp.id;
  });
  return out;
}

GraspList list_grasps(std::shared_ptr<const HandGeometry> hand_geometry,
                      std::shared_ptr<const FingerWorkspaces> workspaces,
                      std::shared_ptr<const Graspable> object, const GraspListSettings& settings,
                      const std::function<bool()>& cancelled, GraspList begun) {
  GraspLister lister(std::move(hand_geometry), std::move(workspaces), std::move(object), settings,
                     std::move(begun));
  while (lister.advance(64)) {
    if (cancelled && cancelled()) break;
  }
  return lister.list();
}

}  // namespace handsel::grasp_planner
