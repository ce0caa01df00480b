// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/actions/two_hands.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/object_extent.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"
#include "components/manipulation_planner/placing/top_grid.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kReleaseRetreatRatios[] = {1.0, 0.8, 0.6};  // of the planned retreat

/// Returns the shoulders of all arms in the world.
std::vector<Vector3> shoulders_of(const Parts& parts) {
  const RobotModel& robot = parts.arm.robot();
  std::vector<Vector3> shoulders;
  for (const Manipulator& m : parts.arm.manipulators()) {
    if (m.arm == nullptr || m.arm->axes.empty()) continue;
    const Axis& first = robot.axes()[static_cast<std::size_t>(m.arm->axes.front())];
    const int link = robot.joints()[static_cast<std::size_t>(first.joint)].child;
    shoulders.push_back(
        (parts.now.T_world_base() * robot.link_pose(parts.now.set_point(), link)).translation());
  }
  return shoulders;
}

/// Places for one object on one surface.
class SurfacePlaces {
 public:
  SurfacePlaces(const Scene& scene, const SceneBox& box, const SceneObject& seen,
                const Eigen::AlignedBox3d& extent,
                const settings::ManipulationPlannerSettings& settings)
      : scene_(scene),
        box_(box),
        seen_(seen),
        extent_(extent),
        edge_(settings.two_hand_object_edge) {
    const Pose& now = seen.T_world_object;
    const double yaw = std::atan2(now.linear()(1, 0), now.linear()(0, 0));
    turn_ = Eigen::AngleAxisd(yaw, Vector3::UnitZ());
    if (!extent.isEmpty()) half_ = 0.5 * extent.sizes();
    gap_ =
        settings.two_hand_gap + std::max(0.0, half_.head<2>().maxCoeff() - settings.two_hand_edge);
  }
  const Eigen::Quaterniond& turn() const { return turn_; }
  /// Returns whether the object fits there, away from the edge and from other things.
  bool is_free(const Vector3& p) const {
    const auto is_near = [&](const SceneObject& other) {
      return other.id != seen_.id &&
             (other.T_world_object.translation() - p).head<2>().norm() < gap_;
    };
    return std::none_of(scene_.objects.begin(), scene_.objects.end(), is_near) && is_inside(p);
  }

 private:
  bool is_inside(const Vector3& p) const {
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0}) {
        const Vector3 corner =
            box_.T_world_box.inverse() *
            (p + turn_ * (extent_.center() + Vector3(x * half_.x(), y * half_.y(), 0)));
        if (std::abs(corner.x()) > box_.size.x() / 2 - edge_ ||
            std::abs(corner.y()) > box_.size.y() / 2 - edge_)
          return false;
      }
    return true;
  }

  const Scene& scene_;
  const SceneBox& box_;
  const SceneObject& seen_;
  Eigen::AlignedBox3d extent_;
  Eigen::Quaterniond turn_;
  Vector3 half_{Vector3::Zero()};
  double gap_{}, edge_{};  // to other things, to the edge [m]
};

/// Returns the grasp by which the hand in use holds what it does, as it lies there now.
Grasp grasp_in_hand(const Parts& parts) {
  Grasp grasp = parts.held.grasp().value_or(Grasp{});
  grasp.T_object_hand = parts.held.attachment().T_tool_object.inverse();
  grasp.hand_joints = RobotModel::part(parts.arm.configuration(), parts.arm.fingers());
  grasp.pregrasp_joints = opening(parts);
  return grasp;
}

}  // namespace

Routine<TwoHandPlan> ask_regrasp(Parts& parts, const std::string& object,
                                 const std::vector<Pose>& places, HandsUse use) {
  const bool both = use != HandsUse::in_turn;
  parts.action.phase = both ? ActionPhase::choosing_two_grasps : ActionPhase::choosing_hands;
  RegraspRequest request;
  parts.clients.regrasp.open(request);
  request.object = object;
  request.start = parts.now.set_point();
  for (const Pose& place : places) request.goals.push_back({place});
  if (parts.held.is_holding()) {
    request.holder = parts.arm.group().name;
    request.grasp = grasp_in_hand(parts);
  }
  request.both = both;
  request.in_air = use == HandsUse::together_in_air;
  request.seed = parts.action.id;
  const bool answered = co_await parts.clients.regrasp.ask(request);
  TwoHandPlan plan;
  if (!answered) {
    plan.outcome = Outcome::no_answer("grasp");
    co_return plan;
  }
  const RegraspReply& reply = *parts.clients.regrasp.reply();
  plan.steps = reply.steps;
  for (const auto& rejected : reply.rejected) parts.refuse(rejected.what, rejected.reason);
  if (!reply.solved) plan.outcome = Outcome::failure(reply.reason);
  co_return plan;
}

std::vector<Pose> places_for(const Parts& parts, const ActionGoal& goal, const SceneObject& seen) {
  if (goal.has_goal) return {goal.T_world_goal};
  const Scene& scene = parts.now.scene();
  const auto box = std::find_if(scene.boxes.begin(), scene.boxes.end(),
                                [&](const SceneBox& b) { return b.id == goal.surface; });
  if (box == scene.boxes.end() || !box->supports) return {};
  const ObjectModel& model = *parts.now.model_of(seen.id);
  const std::vector<Vector3> shoulders = shoulders_of(parts);
  const settings::ManipulationPlannerSettings& settings = parts.settings;
  const SurfacePlaces surface(scene, *box, seen, object_extent(&model, seen.primitive), settings);
  struct Place {
    Vector3 at;
    double off;
  };
  std::vector<Place> all;
  const bool both = goal.kind == ActionKind::carry;
  for (const Vector3& at : top_grid(*box, settings.two_hand_edge, settings.two_hand_grid)) {
    if (!surface.is_free(at)) continue;
    // Neither folded nor stretched does an arm move well.
    double nearest = 1e9, farthest = 0;
    for (const Vector3& shoulder : shoulders) {
      const double off = std::abs((at - shoulder).norm() - settings.two_hand_reach);
      nearest = std::min(nearest, off);
      farthest = std::max(farthest, off);
    }
    all.push_back({at, both ? farthest : nearest});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Place& a, const Place& b) { return a.off < b.off; });
  std::vector<Pose> out;
  for (const Place& p : all) {
    const auto is_near = [&](const Pose& o) {
      return (o.translation() - p.at).head<2>().norm() < settings.two_hand_gap / 2;
    };
    if (std::any_of(out.begin(), out.end(), is_near) || out.size() >= settings.two_hand_places)
      continue;
    out.push_back(make_pose(p.at + model.height_above_support * Vector3::UnitZ(), surface.turn()));
  }
  return out;
}

Routine<Outcome> await_put_down(Parts& parts, const std::string& object) {
  if (parts.held.is_holding())
    co_return Outcome::failure(parts.held.id() + " is in the hand: it must be put down first");
  parts.action.phase = ActionPhase::looking_for_object;
  const auto is_seen = [&] { return parts.now.object(object) != nullptr; };
  const bool seen = co_await parts.waiting.until(is_seen, parts.settings.sight_timeout);
  if (!seen) co_return Outcome::failure("object " + object + " is not in the scene");
  const auto is_put_down = [&] {
    const SceneObject* thing = parts.now.object(object);
    return thing != nullptr && thing->holder != Holder::robot && thing->holder != Holder::human;
  };
  const bool free = co_await parts.waiting.until(is_put_down, parts.settings.sight_timeout);
  if (!free) co_return Outcome::failure(object + " is held: it must stand first");
  if (parts.now.model_of(object) == nullptr)
    co_return Outcome::failure("object " + object + " has no model");
  co_await parts.waiting.pause(parts.settings.settle_time);
  co_return Outcome{};
}

Routine<Outcome> release_and_retreat(Parts& parts, const std::string& object, const Vector& closed,
                                     const Vector& after) {
  const Vector open = RobotModel::part(after, parts.arm.fingers());
  HandResult opened =
      co_await parts.hand.run(HandAction::release, open, parts.settings.hand_timeout);
  if (!opened.outcome.good) co_return opened.outcome;
  if (parts.held.attachment().hand == parts.arm.hand_name()) parts.held.release();
  const RobotModel& robot = parts.arm.robot();
  const Pose T_off = robot.link_pose(closed, parts.arm.palm()).inverse() *
                     robot.link_pose(after, parts.arm.palm());
  std::string why = "no configuration of the arm lies there";
  for (const double ratio : kReleaseRetreatRatios) {
    Pose T = T_off;
    T.translation() *= ratio;
    const auto off = parts.arm.reach(parts.arm.T_world_tool() * T);
    if (!off) continue;
    MotionSpec away;
    away.phase = ActionPhase::retreat;
    away.shape = MotionShape::straight_tool;
    away.goals = {*off};
    away.allowed = {object};
    away.speed = parts.settings.approach_speed;
    Outcome gone = co_await move(parts, away);
    if (gone.good) co_return gone;
    why = gone.reason;
  }
  co_return Outcome::failure("the hand finds no straight path off " + object + ": " + why);
}

}  // namespace handsel::manipulation_planner
