// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/regrasp/step_check.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/model/arm_reach.hpp"
#include "components/grasp_planner/list/so3_grid.hpp"
#include "components/grasp_planner/pair/retreat.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kMotionStep = 0.04;  // [rad] between two checked states

using FingerPoses = std::vector<std::vector<Pose>>;

}  // namespace

StepCheck::StepCheck(const RobotModel& robot, std::vector<RegraspArm> arms, const Graspable& object,
                     ObjectLibrary library, const Scene& scene, const std::string& object_id)
    : robot_(robot),
      arms_(std::move(arms)),
      object_(object),
      T_root_world_(scene.T_world_base.inverse()),
      world_(robot, std::move(library)) {
  if (arms_.empty() || arms_.size() > 2)
    throw ConfigError("a regrasp needs one or two arms, not " + std::to_string(arms_.size()));
  Scene around = scene;
  std::erase_if(around.objects, [&](const SceneObject& x) { return x.id == object_id; });
  world_.set_base(scene.T_world_base);
  world_.set_scene(around);
  boxes_ = scene.boxes;
  T_world_base_ = scene.T_world_base;
  hand_of_.assign(robot_.links().size(), -1);
  for (std::size_t l = 0; l < robot_.links().size(); ++l) {
    const int joint = robot_.links()[l].parent_joint;
    if (joint >= 0)
      hand_of_[l] = hand_of_[static_cast<std::size_t>(
          robot_.joints()[static_cast<std::size_t>(joint)].parent)];
    for (std::size_t k = 0; k < arms_.size(); ++k)
      if (static_cast<int>(l) == arms_[k].arm.palm) hand_of_[l] = static_cast<int>(k);
    for (const PlacedShape& p : robot_.links()[l].collision)
      shapes_.push_back({static_cast<int>(l), CollisionShape::make(p.shape), p.T_parent_shape});
  }
  retreats_.reserve(arms_.size());
  for (const RegraspArm& x : arms_) {
    retreats_.push_back(retreat_directions(x.hand_geometry->hand));
    p_shoulders_.push_back(shoulder(static_cast<int>(p_shoulders_.size())));
    lengths_.push_back(arm_reach(robot_, x.arm.arm, x.arm.palm).length - kObjectBeyondTool);
  }
}

const Grasp& StepCheck::grasp(int arm, std::size_t i) const {
  return arms_[static_cast<std::size_t>(arm)].list->grasps[i].grasp;
}

Vector StepCheck::with(const Vector& q, int arm, const Vector& arm_q, const Vector& hand_q) const {
  const Manipulator& m = arms_[static_cast<std::size_t>(arm)].arm;
  return RobotModel::with(RobotModel::with(q, *m.arm, arm_q), *m.fingers, hand_q);
}

std::optional<Vector> StepCheck::reach(int arm, const Pose& T_world_hand, const Vector& seed,
                                       int restarts) const {
  IkOptions options;
  options.max_iterations = 80;
  options.restarts = restarts;
  return robot_.inverse(*arms_[static_cast<std::size_t>(arm)].arm.arm, T_root_world_ * T_world_hand,
                        seed, options);
}

bool StepCheck::clear_of_object(const Vector& q, const Pose& T_world_object, int holding,
                                int other) {
  robot_.forward(q, T_root_link_);
  for (const auto& [link, shape, T_link_shape] : shapes_) {
    const int hand = hand_of_[static_cast<std::size_t>(link)];
    if (hand >= 0 && (hand == holding || hand == other)) continue;
    if (touch(*shape, T_world_base_ * T_root_link_[static_cast<std::size_t>(link)] * T_link_shape,
              *object_.shape(), T_world_object))
      return false;
  }
  return true;
}

bool StepCheck::object_in_furniture(const Pose& T_world_object) const {
  return std::any_of(boxes_.begin(), boxes_.end(), [&](const SceneBox& b) {
    return touch(*CollisionShape::make(Box{b.size}), b.T_world_box, *object_.shape(),
                 T_world_object);
  });
}

/// Returns the axes with the hand, opened, at its stand-off along `direction` before the grasp, if
/// the straight path from there is free; the other axes as in `q`.
std::optional<Vector> StepCheck::straight(int arm, std::size_t i, const Pose& T_world_object,
                                          const Vector& q, const Vector& arm_q,
                                          const Vector3& direction) {
  Pose T = T_world_object * grasp(arm, i).T_object_hand;
  T.translate(Vector3(settings_.stand_off * direction));
  const auto off = reach(arm, T, q, 0);
  if (!off || (*off - arm_q).cwiseAbs().maxCoeff() > settings_.max_turn) return std::nullopt;
  const Vector opened = grasp(arm, i).pregrasp_joints, from = with(q, arm, *off, opened),
               to = with(q, arm, arm_q, opened);
  if (!world_.check_motion(from, to, kMotionStep).free) return std::nullopt;
  // A straight line in configuration space is curved in Cartesian space.
  for (const double ratio : {0.25, 0.5, 0.75, 0.9})
    if (!clear_of_object(from + ratio * (to - from), T_world_object, 1 - arm)) return std::nullopt;
  return from;
}

std::optional<double> StepCheck::strain(int arm, std::size_t i, const Pose& T_world_object) const {
  const double comfortable = settings_.comfortable;
  const auto a = static_cast<std::size_t>(arm);
  const Pose T_world_hand = T_world_object * grasp(arm, i).T_object_hand;
  const Vector3 away = T_world_hand.translation() - p_shoulders_[a];
  const double stretched = away.norm() / lengths_[a];
  if (stretched > 1) return std::nullopt;
  const double backward = (1 - T_world_hand.linear().col(2).dot(away.stableNormalized())) / 2;
  return 0.5 * backward + 0.5 * std::max(0.0, stretched - comfortable) / (1 - comfortable);
}

CheckedStep StepCheck::check_pick(int arm, std::size_t i, const Pose& T_world_object) {
  const Grasp& g = grasp(arm, i);
  const Pose T_world_hand = T_world_object * g.T_object_hand;
  const Vector& rest = robot_.rest_configuration();
  const auto arm_q = reach(arm, T_world_hand, rest, 2);
  if (!arm_q) return {{}, "no configuration of the arm reaches it"};
  RegraspStep step;
  step.T_world_object = T_world_object;
  step.q = with(rest, arm, *arm_q, g.hand_joints);
  const Vector opened = with(rest, arm, *arm_q, g.pregrasp_joints);
  if (!world_.is_free(step.q) || !world_.is_free(opened) ||
      !clear_of_object(step.q, T_world_object, arm))
    return {{}, "arm or hand would collide"};
  Pose T_lifted = T_world_hand;
  T_lifted.translation().z() += settings_.lift;
  const auto lifted = reach(arm, T_lifted, step.q, 0);
  if (!lifted || (*lifted - *arm_q).cwiseAbs().maxCoeff() > settings_.max_turn ||
      !world_.is_free(with(rest, arm, *lifted, g.hand_joints)))
    return {{}, "the arm could not lift it straight up"};
  if (auto off = stand_off(arm, i, T_world_object, opened, *arm_q)) {
    step.before = step.after = std::move(*off);
    return {std::move(step), ""};
  }
  return {{}, "no straight path to or from it is free"};
}

std::optional<Vector> StepCheck::stand_off(int arm, std::size_t i, const Pose& T_world_object,
                                           const Vector& q, const Vector& arm_q) {
  const Grasp& g = grasp(arm, i);
  FingerPoses T_open;
  const HandGeometry& hand_geometry = *arms_[static_cast<std::size_t>(arm)].hand_geometry;
  hand_geometry.forward(g.pregrasp_joints, T_open);
  std::vector<Vector3> all = retreats_[static_cast<std::size_t>(arm)];
  all.push_back((T_world_object * g.T_object_hand).linear().transpose() * Vector3::UnitZ());
  for (const Vector3& direction : all) {
    if (!retreat_free(hand_geometry, T_open, object_, g.T_object_hand,
                      {direction, settings_.stand_off, settings_.hand_clearance}))
      continue;
    if (auto off = straight(arm, i, T_world_object, q, arm_q, direction)) return off;
  }
  return std::nullopt;
}

/// Returns where the first axis of the arm is, world [m].
Vector3 StepCheck::shoulder(int arm) const {
  const Axis& first = robot_.axes()[static_cast<std::size_t>(
      arms_[static_cast<std::size_t>(arm)].arm.arm->axes.front())];
  return T_world_base_ *
         robot_
             .link_pose(robot_.rest_configuration(),
                        robot_.joints()[static_cast<std::size_t>(first.joint)].child)
             .translation();
}

/// Returns places between the arms and turns of the object, those first that let both hands point
/// away from their shoulders and keep the object upright.
std::vector<StepCheck::PassPlace> StepCheck::pass_places(const Pass& pass) const {
  static const std::vector<Eigen::Quaterniond> turns = so3_sequence(so3_grid_size(0));
  const Vector3 a = p_shoulders_[static_cast<std::size_t>(pass.from)],
                b = p_shoulders_[static_cast<std::size_t>(pass.to)], middle = 0.5 * (a + b),
                apart = b - a;
  Vector3 forward = T_world_base_.linear().col(0);
  std::vector<PassPlace> out;
  for (const double ahead : {0.35, 0.45, 0.55}) {
    for (const double aside : {-0.2, 0.0, 0.2}) {
      for (const double below : {0.2, 0.35, 0.5}) {
        const Vector3 place = middle + ahead * forward + aside * apart - below * Vector3::UnitZ();
        for (const Eigen::Quaterniond& turn : turns) {
          PassPlace e{Pose::Identity(), 0};
          e.T_world_object.linear() = turn.toRotationMatrix();
          e.T_world_object.translation() =
              place - e.T_world_object.linear() * object_.box().center();
          for (const auto& [arm, index, at] :
               {std::tuple(pass.from, pass.grasp_from, a), std::tuple(pass.to, pass.grasp_to, b)}) {
            const Pose T = e.T_world_object * grasp(arm, index).T_object_hand;
            e.score += T.linear().col(2).dot((place - at).normalized()) -
                       2.0 * std::max(0.0, (T.translation() - at).norm() - 0.75);
          }
          e.score += 0.3 * e.T_world_object.linear()(2, 2);
          out.push_back(e);
        }
      }
    }
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const PassPlace& x, const PassPlace& y) { return x.score > y.score; });
  if (out.size() > static_cast<std::size_t>(settings_.handover_tries))
    out.resize(static_cast<std::size_t>(settings_.handover_tries));
  return out;
}

CheckedStep StepCheck::check_pass(const Pass& pass) {
  const int from = pass.from, to = pass.to;
  const std::size_t i = pass.grasp_from, k = pass.grasp_to;
  const Vector& rest = robot_.rest_configuration();
  const Grasp &g = grasp(from, i), &h = grasp(to, k);
  std::string reason = "no place in reach of both arms";
  for (const PassPlace& e : pass_places(pass)) {
    const auto q_from = reach(from, e.T_world_object * g.T_object_hand, rest, 0);
    if (!q_from) continue;
    const auto q_to = reach(to, e.T_world_object * h.T_object_hand, rest, 0);
    if (!q_to) continue;
    RegraspStep step;
    step.T_world_object = e.T_world_object;
    step.q = with(with(rest, from, *q_from, g.hand_joints), to, *q_to, h.hand_joints);
    if (!world_.is_free(step.q) || !clear_of_object(step.q, e.T_world_object, from, to) ||
        object_in_furniture(e.T_world_object)) {
      reason = "the arms would collide wherever both reach it";
      continue;
    }
    // The object arrives while the other arm rests; then the other hand opens.
    const Vector closed = with(rest, from, *q_from, g.hand_joints);
    const Vector opened = RobotModel::with(closed, *arms_[static_cast<std::size_t>(to)].arm.fingers,
                                           h.pregrasp_joints);
    const auto clear = [&](const Vector& q) {
      return world_.is_free(q) && clear_of_object(q, e.T_world_object, from);
    };
    if (!clear(closed) || !clear(opened)) {
      reason = "the other arm, at rest, would be in the way";
      continue;
    }
    auto before = straight(to, k, e.T_world_object, step.q, *q_to, pass.approach_to);
    auto after = before ? straight(from, i, e.T_world_object, step.q, *q_from, pass.retreat_from)
                        : std::nullopt;
    if (!after) {
      reason = "the hands could not come and go straight";
      continue;
    }
    step.before = std::move(*before);
    step.after = std::move(*after);
    if (!tolerates_slack(from, to, step)) {
      reason = "there would be no room for the least error";
      continue;
    }
    return {std::move(step), ""};
  }
  return {{}, reason};
}

/// Returns whether the hand that comes reaches its poses, and collides with nothing, even where the
/// object lies in the other hand a little otherwise than planned.
bool StepCheck::tolerates_slack(int from, int to, const RegraspStep& step) {
  const Manipulator &mover = arms_[static_cast<std::size_t>(to)].arm,
                    &holder = arms_[static_cast<std::size_t>(from)].arm;
  const auto arm_of = [](const Vector& q, const Manipulator& m) {
    return RobotModel::part(q, *m.arm);
  };
  // While one hand is open, the other is closed on the object.
  const Vector at_grasp =
      with(step.before, to, arm_of(step.q, mover), RobotModel::part(step.before, *mover.fingers));
  const Vector released =
      with(step.after, from, arm_of(step.q, holder), RobotModel::part(step.after, *holder.fingers));
  for (const Vector& q : {step.before, at_grasp, step.q, released, step.after}) {
    const Pose T_world_hand = T_world_base_ * robot_.link_pose(q, mover.palm);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double by : {-settings_.slack, settings_.slack}) {
        Pose T = T_world_hand;
        T.translation()[axis] += by;
        const auto off = reach(to, T, q, 0);
        if (!off || !world_.is_free(RobotModel::with(q, *mover.arm, *off))) return false;
      }
    }
  }
  return true;
}

}  // namespace handsel::grasp_planner
