// SPDX-License-Identifier: Apache-2.0
// What a collision world holds, and the exact and the SIMD check of one state or line. Functions
// are in the class: they are inner loops.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/collision/batch_world.hpp"
#include "common/collision/collision_world.hpp"
#include "common/collision/enclosing.hpp"
#include "common/collision/scene_bodies.hpp"
#include "common/collision/simd_capsules.hpp"
#include "common/model/manipulator.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {

struct CollisionWorld::Impl {
  static constexpr int kSweepFrom = 64;  // lines of more states are checked in stretches first

  struct RobotBody {
    int link{};
    CollisionShapePtr shape;
    Pose T_link_shape;
    bool moves{};             ///< some axis moves it
    int hand{-1};             ///< whose palm it is rigid with, or beyond; -1: no hand's
    CollisionShapePtr wider;  ///< for what the moving axes move; null: as it is
    Pose T_link_wider{Pose::Identity()};
  };

  /// Two robot bodies that can touch, with the axes that change their relative pose.
  struct SelfPair {
    int a{}, b{};
    std::vector<int> axes;
  };

  /// A part of a person or of another robot.
  struct MovingBody {
    std::string id;
    bool is_robot{};
    bool arm{};  ///< forearm or hand
    CollisionShapePtr shape;
    Pose T_world_shape;
    Vector3 a, b;
    double radius{};
    Vector3 middle;
    double reach{};       ///< of the whole capsule from its middle [m]
    bool obstacle{true};  ///< as set_people asked
    bool allowed{};
  };

  const RobotModel& robot;
  SceneBodies made;
  Pose T_world_base{Pose::Identity()};
  std::vector<RobotBody> bodies;  // links; what the hand holds is appended
  std::size_t link_bodies{};
  std::vector<SelfPair> link_pairs, held_pairs;
  std::vector<SceneBody> scene, obstacles;
  std::vector<SceneBody>
      in_peoples_hands;  // by their solid parts: no hand reaches into an offered cup
  std::vector<MovingBody> people, other_robots;
  Scene last_scene;
  Attachment attachment;
  std::set<std::string> allowed;
  std::vector<LinkCapsule> capsules;  // links, then what is held
  std::size_t link_capsules{};
  std::vector<Manipulator> hands;
  std::vector<int> hand_link;  // of each link the hand it belongs to, or -1
  std::vector<char> at_held;   // of each hand: it holds the object, or is there for it
  std::vector<std::set<int>> joints_above;
  std::uint64_t checks{}, exact_checks{};
  double turning_margin{};

  std::unique_ptr<BatchWorld> batch;  // null: exact only
  std::vector<int> moving;
  std::vector<char> moves_axis;
  Vector folded_at;  // empty when the batch robot is to be made anew
  bool solids_stale{true}, rest_touches{};
  std::vector<int> order;
  std::vector<char> open;
  std::vector<std::pair<Vector3, Vector3>> capsule_ends;
  std::vector<detail::SimdCapsule> simd_capsules;
  std::vector<float> capsule_distances;
  std::vector<double> at;

  std::vector<Pose> T_root_link, T_world_body;
  Vector self_free;  // configuration last found free of self collision, empty if none
  std::vector<bool> changed;

  Impl(const RobotModel& model, ObjectLibrary objects) : robot(model), made(std::move(objects)) {
    const auto& links = robot.links();
    joints_above.resize(links.size());
    for (std::size_t i = 0; i < links.size(); ++i) {
      const int joint = links[i].parent_joint;
      if (joint < 0) continue;
      joints_above[i] = joints_above[robot.joints()[joint].parent];
      if (robot.joints()[joint].dof >= 0) joints_above[i].insert(joint);
    }
    hand_link.assign(links.size(), -1);
    hands = hands_of(robot);
    at_held.assign(hands.size(), 0);
    for (std::size_t h = 0; h < hands.size(); ++h) {
      if (hands[h].palm < 0) continue;
      const std::set<int>& tool = joints_above[hands[h].palm];
      for (std::size_t i = 0; i < links.size(); ++i)
        if (std::includes(joints_above[i].begin(), joints_above[i].end(), tool.begin(), tool.end()))
          hand_link[i] = static_cast<int>(h);
    }
    for (std::size_t i = 0; i < links.size(); ++i)
      for (const PlacedShape& placed : links[i].collision)
        bodies.push_back({static_cast<int>(i),
                          CollisionShape::make(placed.shape),
                          placed.T_parent_shape,
                          !joints_above[i].empty(),
                          hand_link[i],
                          nullptr,
                          {}});
    link_bodies = bodies.size();
    for (std::size_t i = 0; i < link_bodies; ++i)
      for (std::size_t j = i + 1; j < link_bodies; ++j)
        if (bodies[i].link != bodies[j].link &&
            !robot.pair_disabled(bodies[i].link, bodies[j].link))
          add_pair(i, j, link_pairs);
    capsules = robot_capsules(robot);
    link_capsules = capsules.size();
    changed.assign(robot.dof(), true);
  }

  void add_pair(std::size_t i, std::size_t j, std::vector<SelfPair>& pairs) const {
    const std::set<int>&above = joints_above[bodies[i].link], &below = joints_above[bodies[j].link];
    std::vector<int> between;
    std::set_symmetric_difference(above.begin(), above.end(), below.begin(), below.end(),
                                  std::back_inserter(between));
    std::set<int> axes;
    for (int joint : between) axes.insert(robot.joints()[joint].dof);
    if (!axes.empty())
      pairs.push_back({static_cast<int>(i), static_cast<int>(j), {axes.begin(), axes.end()}});
  }

  void rebuild_scene() {
    in_peoples_hands.clear();
    scene = made.bodies(last_scene, attachment.object, allowed, scene, in_peoples_hands);
  }

  bool may_touch_held(int hand) const {
    return hand >= 0 && at_held[static_cast<std::size_t>(hand)] != 0;
  }

  /// Fingers may lean on each other around what they hold.
  bool lean(const SelfPair& pair) const {
    return bodies[pair.a].hand == bodies[pair.b].hand && may_touch_held(bodies[pair.a].hand);
  }

  void rebuild_held() {
    bodies.resize(link_bodies);
    capsules.resize(link_capsules);
    held_pairs.clear();
    const int hand = attachment.object.empty() ? -1 : hand_index(hands, attachment.hand),
              palm = hand < 0 ? -1 : hands[hand].palm;
    at_held.assign(hands.size(), hand >= 0 && allowed.count(attachment.object) > 0);
    if (hand >= 0) at_held[hand] = 1;
    if (palm >= 0) {
      SceneObject held;
      held.model = attachment.object;
      for (const SceneObject& object : last_scene.objects)
        if (object.id == attachment.object) held = object;
      if (CollisionShapePtr shape = made.shape_of(held)) {
        LinkCapsule capsule = enclosing_capsule(
            shape->is_mesh() ? std::get<MeshPtr>(shape->shape())->vertices : corners_of(held));
        capsule.link = palm;
        capsule.a = attachment.T_tool_object * capsule.a;
        capsule.b = attachment.T_tool_object * capsule.b;
        capsules.push_back(capsule);
        bodies.push_back({palm, shape, attachment.T_tool_object, true, hand, nullptr, {}});
        for (std::size_t i = 0; i < link_bodies; ++i)
          if (!may_touch_held(bodies[i].hand)) add_pair(i, link_bodies, held_pairs);
      }
    }
    self_free.resize(0);
  }

  void place(const Vector& q) {
    robot.forward(q, T_root_link);
    T_world_body.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i)
      T_world_body[i] = T_world_base * (T_root_link[bodies[i].link] * bodies[i].T_link_shape);
  }

  std::string name_of(std::size_t body) const {
    return body < link_bodies ? "link " + robot.links()[bodies[body].link].name
                              : "object " + attachment.object;
  }

  bool touch_pair(const SelfPair& pair) const {
    const RobotBody &a = bodies[pair.a], &b = bodies[pair.b];
    if (!a.wider && !b.wider)
      return touch(*a.shape, T_world_body[pair.a], *b.shape, T_world_body[pair.b]);
    const auto pose = [this](const RobotBody& body) {
      return T_world_base * (T_root_link[body.link] * body.T_link_wider);
    };
    return touch(a.wider ? *a.wider : *a.shape, a.wider ? pose(a) : T_world_body[pair.a],
                 b.wider ? *b.wider : *b.shape, b.wider ? pose(b) : T_world_body[pair.b]);
  }

  bool moved(int link) const {
    return std::any_of(joints_above[link].begin(), joints_above[link].end(),
                       [this](int joint) { return moves_axis[robot.joints()[joint].dof] != 0; });
  }

  void rebuild_wider() {
    for (std::size_t i = 0; i < link_bodies; ++i) {
      RobotBody& body = bodies[i];
      body.wider = nullptr;
      if (!(turning_margin > 0) || moving.empty() || !body.moves || moved(body.link)) continue;
      body.T_link_wider = body.T_link_shape;
      body.wider = widened(body.shape, turning_margin, body.T_link_wider);
    }
    self_free.resize(0);
    folded_at.resize(0);
  }

  bool self_touch(const std::vector<SelfPair>& pairs, CollisionVerdict* verdict) const {
    for (const SelfPair& pair : pairs) {
      if (lean(pair) || (!moving.empty() && !changes(pair))) continue;
      if (std::none_of(pair.axes.begin(), pair.axes.end(),
                       [this](int axis) { return changed[axis]; }))
        continue;
      if (!touch_pair(pair)) continue;
      if (verdict) *verdict = {false, name_of(pair.a), name_of(pair.b), ""};
      return true;
    }
    return false;
  }

  bool scene_touch(std::size_t i, const std::vector<SceneBody>& things,
                   CollisionVerdict* verdict) const {
    const bool held = i >= link_bodies;
    for (const SceneBody& thing : things) {
      if (thing.allowed && bodies[i].hand >= 0) continue;
      const bool lowered = held && thing.lowered;
      const CollisionShape& shape = lowered ? *thing.lowered : *thing.shape;
      if (!touch(*bodies[i].shape, T_world_body[i], shape,
                 lowered ? thing.T_world_lowered : thing.T_world_shape))
        continue;
      if (verdict)
        *verdict = {false, name_of(i), (thing.is_object ? "object " : "box ") + thing.id, thing.id};
      return true;
    }
    return false;
  }

  bool moving_touch(std::size_t i, CollisionVerdict* verdict) const {
    for (const auto* list : {&people, &other_robots})
      for (const MovingBody& body : *list) {
        if (!body.obstacle || (body.allowed && body.arm)) continue;
        if (!touch(*bodies[i].shape, T_world_body[i], *body.shape, body.T_world_shape)) continue;
        const char* kind = body.is_robot ? "robot " : "person ";
        if (verdict) *verdict = {false, name_of(i), kind + body.id, body.id};
        return true;
      }
    return false;
  }

  /// Whether a capsule around the robot touches one of a person or another robot that is an
  /// obstacle: the capsules hold the links.
  bool near_moving_bodies() const {
    for (const LinkCapsule& capsule : capsules) {
      const Pose& T_root = T_root_link[capsule.link];
      const Vector3 a = T_world_base * (T_root * capsule.a),
                    b = T_world_base * (T_root * capsule.b), middle = 0.5 * (a + b);
      const double reach = 0.5 * (b - a).norm() + capsule.radius;
      for (const auto* list : {&people, &other_robots})
        for (const MovingBody& body : *list) {
          if (!body.obstacle || (body.allowed && body.arm)) continue;
          const double bound = reach + body.reach;
          if ((middle - body.middle).squaredNorm() > bound * bound) continue;
          if (segment_distance(a, b, body.a, body.b) <= capsule.radius + body.radius) return true;
        }
    }
    return false;
  }

  bool things_touch(const std::vector<SceneBody>& things, CollisionVerdict* verdict) const {
    for (std::size_t i = 0; !things.empty() && i < bodies.size(); ++i)
      if (bodies[i].moves && scene_touch(i, things, verdict)) return true;
    return false;
  }

  /// What they hold belongs to them: it moves as they do.
  bool people_touch(CollisionVerdict* verdict) const {
    if (things_touch(in_peoples_hands, verdict)) return true;
    if (!near_moving_bodies()) return false;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (bodies[i].moves && moving_touch(i, verdict)) return true;
    return false;
  }

  /// Makes the batch world agree with this one. False when the exact check has to check everything:
  /// there is none, or what the moving axes do not move touches something.
  bool batch_ready(const Vector& q) {
    if (!batch) return false;
    bool same = folded_at.size() == q.size();
    for (int axis = 0; same && axis < robot.dof(); ++axis)
      same = moves_axis[axis] || folded_at[axis] == q[axis];
    if (same && !solids_stale) return !rest_touches;
    place(q);
    rest_touches = false;
    if (!same) fold(q);
    std::vector<BatchWorld::Solid> solids;
    for (const auto* things : {&scene, &obstacles, &in_peoples_hands})
      for (const SceneBody& thing : *things) {
        const std::uint8_t all = thing.allowed ? kArmPart : kArmPart | kHandPart | kHeldPart;
        add_solid(*thing.shape, thing.T_world_shape, thing.lowered ? all & ~kHeldPart : all,
                  solids);
        if (thing.lowered)
          add_solid(*thing.lowered, thing.T_world_lowered, all & kHeldPart, solids);
      }
    for (const auto* list : {&people, &other_robots})
      for (const MovingBody& body : *list)
        if (body.obstacle && !(body.allowed && body.arm))
          add_solid(*body.shape, body.T_world_shape, kArmPart | kHandPart | kHeldPart, solids);
    batch->set_solids(solids, T_world_base);
    for (std::size_t i = 0; i < bodies.size() && !rest_touches; ++i)
      rest_touches = bodies[i].moves && !moved(bodies[i].link) &&
                     (scene_touch(i, scene, nullptr) || scene_touch(i, obstacles, nullptr) ||
                      scene_touch(i, in_peoples_hands, nullptr) || moving_touch(i, nullptr));
    solids_stale = false;
    return !rest_touches;
  }

  bool moves_only(const Vector& from, const Vector& to) const {
    for (int axis = 0; axis < robot.dof(); ++axis)
      if (!moves_axis[axis] && from[axis] != to[axis]) return false;
    return true;
  }

  static void add_solid(const CollisionShape& shape, const Pose& T, int against,
                        std::vector<BatchWorld::Solid>& solids) {
    if (against == 0) return;
    solids.push_back({shape.shape(), shape.is_mesh() ? shape.cover() : nullptr, T,
                      static_cast<std::uint8_t>(against)});
  }

  bool changes(const SelfPair& pair) const {
    return std::any_of(pair.axes.begin(), pair.axes.end(),
                       [this](int axis) { return moves_axis[axis] != 0; });
  }

  void fold(const Vector& q) {
    std::vector<BatchWorld::Body> batch_bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const RobotBody& body = bodies[i];
      const CollisionShape& shape = body.wider ? *body.wider : *body.shape;
      const bool covered = moved(body.link) || shape.is_mesh();
      batch_bodies.push_back({body.link, covered ? shape.cover() : nullptr, shape.shape(),
                              body.wider ? body.T_link_wider : body.T_link_shape,
                              static_cast<std::uint8_t>(i >= link_bodies ? kHeldPart
                                                        : body.hand >= 0 ? kHandPart
                                                                         : kArmPart)});
    }
    std::vector<std::pair<int, int>> batch_pairs;
    for (const auto* pairs : {&link_pairs, &held_pairs})
      for (const SelfPair& pair : *pairs)
        if (!lean(pair) && changes(pair)) batch_pairs.emplace_back(pair.a, pair.b);
    batch->set_robot(batch_bodies, batch_pairs, moving, q);
    folded_at = q;
  }

  /// check_motion through the batch check: the same states in the same order, with the same counts.
  bool check_line(const Vector& from, const Vector& to, int last, CollisionVerdict* verdict) {
    order.clear();
    order.push_back(0);
    if (last > 0) order.push_back(last);
    int stride = 1;
    while (stride < last) stride *= 2;
    for (; stride > 1; stride /= 2)
      for (int i = stride / 2; i < last; i += stride) order.push_back(i);
    open.assign(static_cast<std::size_t>(last) + 1, 1);
    if (last >= kSweepFrom) {
      open.assign(open.size(), 0);
      open.front() = open.back() = 1;
      for (const auto& [low, high] :
           batch->unclear_stretches(from, to, 2.0 / last, 1 + last / kSweepFrom))
        for (int i = std::max(0, static_cast<int>(low * last) - 1);
             i <= std::min(last, static_cast<int>(high * last) + 1); ++i)
          open[static_cast<std::size_t>(i)] = 1;
    }
    for (std::size_t next = 0; next < order.size();) {
      at.clear();
      std::size_t end = next;
      for (; end < order.size() && at.size() < static_cast<std::size_t>(BatchWorld::kStates); ++end)
        if (open[static_cast<std::size_t>(order[end])])
          at.push_back(static_cast<double>(order[end]) / std::max(1, last));
      std::uint32_t unclear =
          at.empty() ? 0 : batch->unclear_on_line(from, to, at.data(), static_cast<int>(at.size()));
      for (; next < end; ++next) {
        const int i = order[next];
        const bool asks = open[static_cast<std::size_t>(i)] && (unclear & 1) != 0;
        if (open[static_cast<std::size_t>(i)]) unclear >>= 1;
        if (!asks) {
          ++checks;
          continue;
        }
        const bool free =
            i == 0 ? check_state(from, verdict)
            : i == last
                ? check_state(to, verdict)
                : check_state(from + (to - from) * (static_cast<double>(i) / last), verdict);
        if (!free) return false;
      }
    }
    return true;
  }

  bool check_state(const Vector& q, CollisionVerdict* verdict, bool with_people = true) {
    ++checks;
    ++exact_checks;
    place(q);
    if (things_touch(scene, verdict) || things_touch(obstacles, verdict)) return false;
    if (with_people && people_touch(verdict)) return false;
    const bool known = self_free.size() == q.size();
    for (int axis = 0; axis < robot.dof(); ++axis)
      changed[axis] = !known || self_free[axis] != q[axis];
    if (self_touch(link_pairs, verdict) || self_touch(held_pairs, verdict)) return false;
    self_free = q;
    return true;
  }
};

}  // namespace handsel
