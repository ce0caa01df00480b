// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/hand/hand_shape.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/segments.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kShrink = 0.001;  // [m] max penetration of the mesh or box of a finger in contact

const Pose& step_pose(const std::vector<Pose>& T, int step) {
  static const Pose identity = Pose::Identity();
  return step < 0 ? identity : T[static_cast<std::size_t>(step)];
}

MeshPtr shrink(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3& v : mesh.vertices) box.extend(v);
  const Vector3 half = (0.5 * box.sizes()).cwiseMax(1e-6);
  auto out = std::make_shared<TriangleMesh>(mesh);
  for (Vector3& v : out->vertices) {
    const Vector3 scale = (half.array() - kShrink).max(0.0) / half.array();
    v = box.center() + scale.cwiseProduct(v - box.center());
  }
  return out;
}

}  // namespace

HandShape::Solid HandShape::make_solid(int link, int step, const Pose& T_step_link,
                                       const PlacedShape& placed) {
  Solid s;
  s.link = link;
  s.step = step;
  s.T_step_shape = T_step_link * placed.T_parent_shape;
  const auto capsule = [&s](double radius, double length) {
    s.capsule = true;
    s.radius = radius;
    s.a = s.T_step_shape * Vector3(0, 0, -0.5 * length);
    s.b = s.T_step_shape * Vector3(0, 0, 0.5 * length);
  };
  if (const auto* sphere = std::get_if<Sphere>(&placed.shape)) capsule(sphere->radius, 0.0);
  if (const auto* round = std::get_if<Capsule>(&placed.shape))
    capsule(round->radius, round->length);
  const auto* cylinder = std::get_if<Cylinder>(&placed.shape);
  if (cylinder != nullptr && cylinder->length >= 2 * cylinder->radius)
    capsule(cylinder->radius, cylinder->length);
  s.shape = CollisionShape::make(placed.shape);
  s.shrunk = s.shape;
  if (const auto* box = std::get_if<Box>(&placed.shape))
    s.shrunk = CollisionShape::make(Box{(box->size.array() - 2 * kShrink).max(1e-6).matrix()});
  if (const auto* mesh = std::get_if<MeshPtr>(&placed.shape))
    s.shrunk = CollisionShape::make(shrink(**mesh));
  return s;
}

HandShape::HandShape(const HandModel& hand, const std::vector<FingerChain>& chains)
    : fingers_(chains.size()) {
  const RobotModel& model = hand.model();
  links_ = static_cast<int>(model.links().size());
  std::vector<bool> carried(model.links().size(), false);
  for (std::size_t f = 0; f < chains.size(); ++f) {
    for (const FingerChain::Carried& c : chains[f].carried()) {
      if (carried[static_cast<std::size_t>(c.link)]) continue;
      carried[static_cast<std::size_t>(c.link)] = true;
      for (const PlacedShape& p : model.links()[static_cast<std::size_t>(c.link)].collision) {
        fingers_[f].push_back(make_solid(c.link, c.step, c.T_step_link, p));
      }
    }
  }
  std::vector<Pose> T_hand_link;
  model.forward(hand.rest(), T_hand_link);
  for (int l = 0; l < links_; ++l) {
    if (carried[static_cast<std::size_t>(l)]) continue;
    for (const PlacedShape& p : model.links()[static_cast<std::size_t>(l)].collision) {
      palm_.push_back(make_solid(l, -1, T_hand_link[static_cast<std::size_t>(l)], p));
    }
  }
  disabled_.assign(pair(links_, 0), false);
  const auto disable = [this](int a, int b) {
    disabled_[pair(a, b)] = disabled_[pair(b, a)] = true;
  };
  for (int a = 0; a < links_; ++a) {
    for (int b = 0; b < links_; ++b) {
      if (a == b || model.pair_disabled(a, b)) disable(a, b);
    }
  }
  const Vector middle = 0.5 * (hand.rest() + hand.pregrasp());
  for (const Vector& q : {hand.rest(), middle, hand.pregrasp()}) {
    std::vector<std::vector<Pose>> T(chains.size());
    for (std::size_t f = 0; f < chains.size(); ++f) chains[f].forward(q, T[f]);
    const auto mark = [&](const std::vector<Solid>& x, const std::vector<Pose>& Tx,
                          const std::vector<Solid>& y, const std::vector<Pose>& Ty) {
      for (const Solid& s : x) {
        for (const Solid& t : y) {
          if (!disabled(s.link, t.link) &&
              solids_touch(s, step_pose(Tx, s.step), t, step_pose(Ty, t.step)))
            disable(s.link, t.link);
        }
      }
    };
    for (std::size_t f = 0; f < fingers_.size(); ++f) {
      mark(fingers_[f], T[f], palm_, {});
      for (std::size_t g = 0; g < f; ++g) mark(fingers_[f], T[f], fingers_[g], T[g]);
    }
  }
}

bool HandShape::solid_touches(const Solid& s, const Pose& T_hand_step, const Graspable& object,
                              const Pose& T_object_hand, double clearance) const {
  const Pose T_object_step = T_object_hand * T_hand_step;
  if (s.capsule)
    return object.triangles().nearer_than(T_object_step * s.a, T_object_step * s.b,
                                          std::max(1e-6, s.radius + clearance));
  const CollisionShape& shape = clearance < 0 ? *s.shrunk : *s.shape;
  return touch(shape, T_object_step * s.T_step_shape, *object.shape(), Pose::Identity());
}

bool HandShape::palm_touches(const Graspable& object, const Pose& T_object_hand,
                             double clearance) const {
  for (const Solid& s : palm_) {
    if (solid_touches(s, Pose::Identity(), object, T_object_hand, clearance)) return true;
    const Vector3 middle =
        s.capsule ? Vector3(0.5 * (s.a + s.b)) : Vector3(s.T_step_shape * s.shape->box_center());
    if (object.triangles().contains(T_object_hand * middle)) return true;
  }
  return false;
}

bool HandShape::finger_touches(int finger, const std::vector<Pose>& T_hand_step,
                               const Graspable& object, const Pose& T_object_hand,
                               double clearance) const {
  for (const Solid& s : fingers_[static_cast<std::size_t>(finger)]) {
    if (solid_touches(s, step_pose(T_hand_step, s.step), object, T_object_hand, clearance))
      return true;
  }
  return false;
}

bool HandShape::solids_touch(const Solid& s, const Pose& T_hand_s, const Solid& t,
                             const Pose& T_hand_t) {
  if (s.capsule && t.capsule) {
    const double reach = s.radius + t.radius;
    Vector3 p, q;
    return nearest_points(T_hand_s * s.a, T_hand_s * s.b, T_hand_t * t.a, T_hand_t * t.b, p, q) <
           reach * reach;
  }
  return touch(*s.shape, T_hand_s * s.T_step_shape, *t.shape, T_hand_t * t.T_step_shape);
}

bool HandShape::groups_touch(const std::vector<Solid>& a, const std::vector<Pose>& T_a,
                             const std::vector<Solid>& b, const std::vector<Pose>& T_b) const {
  for (const Solid& s : a) {
    for (const Solid& t : b) {
      if (!disabled(s.link, t.link) &&
          solids_touch(s, step_pose(T_a, s.step), t, step_pose(T_b, t.step)))
        return true;
    }
  }
  return false;
}

bool HandShape::finger_touches_palm(int finger, const std::vector<Pose>& T_hand_step) const {
  return groups_touch(fingers_[static_cast<std::size_t>(finger)], T_hand_step, palm_, {});
}

bool HandShape::fingers_touch(int a, const std::vector<Pose>& T_hand_step_a, int b,
                              const std::vector<Pose>& T_hand_step_b) const {
  return groups_touch(fingers_[static_cast<std::size_t>(a)], T_hand_step_a,
                      fingers_[static_cast<std::size_t>(b)], T_hand_step_b);
}

bool HandShape::touches(const std::vector<std::vector<Pose>>& T_hand_step, const Graspable& object,
                        const Pose& T_object_hand, double clearance) const {
  if (palm_touches(object, T_object_hand, clearance)) return true;
  for (std::size_t f = 0; f < fingers_.size(); ++f) {
    if (finger_touches(static_cast<int>(f), T_hand_step[f], object, T_object_hand, clearance))
      return true;
  }
  return false;
}

std::vector<HandShape::Low> HandShape::lows(const std::vector<std::vector<Pose>>& T_hand_step,
                                            const Pose& T_world_hand) const {
  std::vector<Low> out;
  const auto add = [&](const Solid& s, const Pose& T_hand_s) {
    const Pose T_world_s = T_world_hand * T_hand_s;
    if (s.capsule) {
      const Vector3 a = T_world_s * s.a, b = T_world_s * s.b;
      out.push_back({0.5 * (a + b), std::min(a.z(), b.z()) - s.radius});
      return;
    }
    const Pose T_world_shape = T_world_s * s.T_step_shape;
    const Vector3 middle = T_world_shape * s.shape->box_center();
    if (const auto* mesh = std::get_if<MeshPtr>(&s.shape->shape())) {
      double low = middle.z();
      for (const Vector3& v : (*mesh)->vertices) low = std::min(low, (T_world_shape * v).z());
      out.push_back({middle, low});
    } else if (const auto* c = std::get_if<Cylinder>(&s.shape->shape())) {
      const double along = std::abs(T_world_shape.linear()(2, 2));
      out.push_back({middle, middle.z() - 0.5 * c->length * along -
                                 c->radius * std::sqrt(std::max(0.0, 1 - along * along))});
    } else {
      out.push_back(
          {middle, middle.z() - T_world_shape.linear().row(2).cwiseAbs().dot(s.shape->box_half())});
    }
  };
  for (const Solid& s : palm_) add(s, Pose::Identity());
  for (std::size_t f = 0; f < fingers_.size(); ++f) {
    for (const Solid& s : fingers_[f]) add(s, step_pose(T_hand_step[f], s.step));
  }
  return out;
}

std::vector<HandShape::Round> HandShape::rounds(
    const std::vector<std::vector<Pose>>& T_hand_step) const {
  std::vector<Round> out;
  const auto add = [&out](const Solid& s, const Pose& T) {
    if (s.capsule) {
      out.push_back({T * s.a, T * s.b, s.radius});
    } else {
      const Vector3 centre = T * (s.T_step_shape * s.shape->sphere_center());
      out.push_back({centre, centre, s.shape->sphere_radius()});
    }
  };
  for (const Solid& s : palm_) add(s, Pose::Identity());
  for (std::size_t f = 0; f < fingers_.size(); ++f) {
    for (const Solid& s : fingers_[f]) add(s, step_pose(T_hand_step[f], s.step));
  }
  return out;
}

HandShape::PlacedHand HandShape::placed(const std::vector<std::vector<Pose>>& T_hand_step,
                                        const Pose& T_frame_hand) const {
  PlacedHand out;
  const auto add = [&](const Solid& s, const Pose& T_hand_s) {
    const Pose T_frame_s = T_frame_hand * T_hand_s;
    Placed p;
    p.capsule = s.capsule;
    p.palm = s.step < 0;
    p.a = T_frame_s * s.a;
    p.b = T_frame_s * s.b;
    p.radius = s.radius;
    p.shape = s.shape;
    p.T_frame_shape = T_frame_s * s.T_step_shape;
    if (!s.shape->is_mesh()) p.core = convex_core(s.shape->shape(), p.T_frame_shape);
    p.middle = s.capsule ? Vector3(0.5 * (p.a + p.b))
                         : Vector3(p.T_frame_shape * s.shape->sphere_center());
    p.bound = s.capsule ? 0.5 * (p.b - p.a).norm() + s.radius : s.shape->sphere_radius();
    out.box.extend(Vector3(p.middle.array() - p.bound));
    out.box.extend(Vector3(p.middle.array() + p.bound));
    out.solids.push_back(std::move(p));
  };
  for (const Solid& s : palm_) add(s, Pose::Identity());
  for (std::size_t f = 0; f < fingers_.size(); ++f) {
    for (const Solid& s : fingers_[f]) add(s, step_pose(T_hand_step[f], s.step));
  }
  return out;
}

bool HandShape::nearer(const Placed& s, const Placed& t, double clearance) {
  const double bound = s.bound + t.bound + clearance;
  if ((s.middle - t.middle).squaredNorm() > bound * bound) return false;
  if (s.capsule && t.capsule) {
    const double reach = s.radius + t.radius + clearance;
    Vector3 p, q;
    return nearest_points(s.a, s.b, t.a, t.b, p, q) < reach * reach;
  }
  if (!s.shape->is_mesh() && !t.shape->is_mesh()) {
    ConvexCore grown = s.core;
    grown.margin += clearance;
    return convex_touch(grown, t.core);
  }
  if (clearance > 0) return gap(*s.shape, s.T_frame_shape, *t.shape, t.T_frame_shape) <= clearance;
  return touch(*s.shape, s.T_frame_shape, *t.shape, t.T_frame_shape);
}

bool HandShape::hands_touch(const PlacedHand& a, const PlacedHand& b, double clearance,
                            double palm_clearance) {
  const double larger = std::max(clearance, palm_clearance);
  if (a.box.squaredExteriorDistance(b.box) > larger * larger) return false;
  for (const Placed& s : a.solids) {
    for (const Placed& t : b.solids) {
      if (nearer(s, t, s.palm || t.palm ? larger : clearance)) return true;
    }
  }
  return false;
}

}  // namespace handsel::grasp_planner
