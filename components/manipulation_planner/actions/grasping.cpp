// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/actions/grasping.hpp"

#include <algorithm>

#include "components/manipulation_planner/actions/object_sight.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr int kRetreatSteps = 3;                         // from the longest to the shortest retreat
constexpr double kLiftRatios[] = {1.0, 0.85, 0.6, 0.4};  // of the lift height

/// Returns the four directions around `back`, by `angle` [rad] off it.
std::vector<Vector3> directions_beside(const Vector3& back, double angle) {
  const Vector3 across = back.unitOrthogonal();
  std::vector<Vector3> directions;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Vector3 axis = Eigen::AngleAxisd(quarter * M_PI_2, back) * across;
    directions.push_back(Eigen::AngleAxisd(angle, axis) * back);
  }
  return directions;
}

/// Plans the approach, opens the hand meanwhile and moves to the grasp.
Routine<Outcome> reach_grasp(Parts& parts, const std::string& object, const Grasp& grasp) {
  MotionSpec approach;
  approach.phase = ActionPhase::approach;
  approach.goals = {grasp.approach_joints};
  approach.tolerated = {object};
  approach.object = object_at_rest(parts, object);
  MotionSpec reach = reach_along(parts, object, grasp);
  const Group& fingers = parts.arm.fingers();
  const double closing = parts.settings.reach_closing;
  if (!fingers.axes.empty() && closing > 0.0)
    reach.fingers = (1.0 - closing) * grasp.pregrasp_joints + closing * grasp.hand_joints;
  Vector opened = parts.now.set_point();
  if (!fingers.axes.empty()) opened = RobotModel::with(opened, fingers, grasp.pregrasp_joints);
  const Vector before = RobotModel::with(opened, parts.arm.group(), grasp.approach_joints);
  PlannedPath last_part = co_await plan_path(parts, before, reach);
  if (!last_part.outcome.good) co_return last_part.outcome.of("last part of the approach");
  PlannedPath first_part = co_await plan_path(parts, opened, approach);
  if (!first_part.outcome.good) co_return first_part.outcome.of("approach");

  Outcome moved = co_await parts.hand.send(HandAction::move, grasp.pregrasp_joints);
  if (!moved.good) co_return moved;
  moved = co_await move(parts, approach);
  if (!moved.good) co_return moved;
  moved = co_await parts.hand.await_open();
  if (!moved.good) co_return moved;
  moved = co_await move(parts, reach);
  co_return moved;
}

/// Closes the hand; if it holds nothing, it opens again and moves back to the stand-off.
Routine<Outcome> close_hand(Parts& parts, const std::string& object, const Grasp& grasp) {
  parts.action.phase = ActionPhase::grasp;
  const double timeout = parts.settings.hand_timeout;
  HandResult closed =
      co_await parts.hand.run(HandAction::grasp, grasp.hand_joints, timeout, &grasp.hand_effort);
  if (closed.outcome.good && closed.state == HandState::grasped) co_return Outcome{};
  co_await parts.hand.run(HandAction::move, grasp.pregrasp_joints, timeout);
  MotionSpec back = reach_along(parts, object, grasp);
  back.phase = ActionPhase::backing_off;
  back.goals = {grasp.approach_joints};
  co_await move(parts, back);
  if (!closed.outcome.good) co_return closed.outcome;
  co_return Outcome::failure("the hand closed on nothing", ActionFailure::nothing_grasped);
}

GraspRequest grasp_request(Parts& parts, const std::string& object) {
  GraspRequest request;
  parts.clients.grasp.open(request);
  request.object = object;
  request.group = parts.arm.group().name;
  request.start = parts.now.set_point();
  request.seed = parts.action.id;
  return request;
}

/// Waits for the grasps of a request, and lists those that were rejected.
Routine<GraspList> send_request(Parts& parts, const GraspRequest& request) {
  const bool answered = co_await parts.clients.grasp.ask(request);
  GraspList list;
  if (!answered) {
    list.outcome = Outcome::no_answer("grasp");
    co_return list;
  }
  const GraspReply& reply = *parts.clients.grasp.reply();
  list.grasps = reply.grasps;
  for (const auto& rejected : reply.rejected)
    parts.refuse("grasps: " + rejected.what, rejected.reason);
  if (list.grasps.empty())
    list.outcome = Outcome::failure("no grasp for " + request.object + ": " + reply.reason);
  co_return list;
}

}  // namespace

Routine<GraspList> ask_grasps(Parts& parts, const std::string& object, const std::string& for_human,
                              std::uint32_t max_grasps) {
  parts.action.phase = ActionPhase::choosing_grasp;
  GraspRequest request = grasp_request(parts, object);
  request.for_human = for_human;
  request.max_grasps = max_grasps;
  GraspList list = co_await send_request(parts, request);
  co_return list;
}

Routine<GraspList> ask_grasps_anywhere(Parts& parts, const std::string& object) {
  GraspRequest request = grasp_request(parts, object);
  request.max_grasps = parts.settings.max_grasps;
  request.move_platform = true;
  GraspList list = co_await send_request(parts, request);
  co_return list;
}

std::optional<Grasp> grasp_now(const Parts& parts, const std::string& object, const Grasp& grasp) {
  const SceneObject* seen = parts.now.object(object);
  return seen == nullptr ? std::nullopt : parts.arm.grasp_at(seen->T_world_object, grasp);
}

MotionSpec reach_along(const Parts& parts, const std::string& object, const Grasp& grasp) {
  MotionSpec reach;
  reach.phase = ActionPhase::reaching_object;
  reach.goals = {grasp.arm_joints};
  reach.shape = MotionShape::straight_tool;
  reach.allowed = {object};
  reach.speed = parts.settings.approach_speed;
  return reach;
}

Vector opening(const Parts& parts) {
  const auto& grasp = parts.held.grasp();
  return grasp ? grasp->pregrasp_joints
               : RobotModel::part(parts.arm.robot().rest_configuration(), parts.arm.fingers());
}

bool is_held_by_robot(const Parts& parts, const std::string& object) {
  const SceneObject* seen = parts.now.object(object);
  return seen != nullptr && seen->holder == Holder::robot;
}

Routine<Outcome> lift(Parts& parts, const std::string& object, const std::string& for_human,
                      const std::string& beside) {
  MotionSpec up;
  up.phase = ActionPhase::lift;
  up.shape = MotionShape::straight_tool;
  up.allowed = {object};
  if (!beside.empty()) up.allowed.push_back(beside);
  up.yields_to = for_human;
  const double height = parts.settings.lift_height;
  const Pose T_now = parts.arm.T_world_tool();
  for (const double ratio : kLiftRatios) {
    Pose T = T_now;
    T.translation().z() += ratio * height;
    if (auto joints = parts.arm.reach(T)) {
      up.goals = {*joints};
      Outcome outcome = co_await move(parts, up);
      if (outcome.good || outcome.end == MotionEnd::taken) co_return outcome;
    }
  }
  co_return Outcome::failure("the arm cannot lift " + object + " straight up by " +
                             std::to_string(height) + " m");
}

Routine<Outcome> try_grasp(Parts& parts, const std::string& object, const std::string& for_human,
                           const Grasp& grasp) {
  parts.action.phase = ActionPhase::planning;
  const bool ready = co_await parts.link.await_permission();
  if (!ready) co_return parts.link.not_permitted();
  Outcome done = co_await reach_grasp(parts, object, grasp);
  if (!done.good) co_return done;
  done = co_await close_hand(parts, object, grasp);
  if (!done.good) co_return done;
  parts.held.set_grasp(grasp);
  // The fingers may have pushed the object: it is taken from where it is at rest again.
  const Stamp seen = parts.now.scene().stamp;
  const auto is_at_rest = [&parts, &object, seen] {
    const SceneObject* thing = parts.now.object(object);
    return parts.now.scene().stamp != seen && thing != nullptr &&
           thing->velocity.norm() < parts.settings.offer_still;
  };
  co_await parts.waiting.until(is_at_rest, parts.settings.settle_time);
  const SceneObject* held = parts.now.object(object);
  if (held == nullptr) co_return Outcome::failure("object " + object + " left the scene");
  parts.held.hold(*held);
  Outcome lifted = co_await lift(parts, object, for_human);
  if (lifted.end == MotionEnd::taken) co_return Outcome{};
  if (!lifted.good) co_return lifted;
  const bool is_carried = co_await parts.waiting.until(
      [&] { return is_held_by_robot(parts, object); }, parts.settings.settle_time);
  if (is_carried) co_return lifted;
  parts.held.release();
  co_await parts.hand.run(HandAction::move, grasp.pregrasp_joints, parts.settings.hand_timeout);
  co_return Outcome::failure(object + " stayed behind when the hand went up",
                             ActionFailure::left_behind);
}

Vector3 retreat_direction(const Parts& parts, const std::string& object) {
  const Pose T_now = parts.arm.T_world_tool();
  Vector3 back = -Vector3::UnitZ();  // tool frame
  if (const auto& grasp = parts.held.grasp())
    back = parts.arm.direction_back(*grasp);
  else if (const SceneObject* left = parts.now.object(object))
    back = -(T_now.inverse() * left->T_world_object.translation()).normalized();
  return T_now.linear() * back;
}

namespace {

/// Retreats straight in a direction of the world, as far as the arm can.
Routine<Outcome> retreat_along(Parts& parts, const Vector3& away, MotionSpec& motion) {
  const double farthest = parts.settings.retreat_distance,
               least = std::min(farthest, parts.settings.min_retreat);
  const Pose T_now = parts.arm.T_world_tool();
  Outcome last = Outcome::failure("no configuration of the arm lies there");
  for (int step = 0; step <= kRetreatSteps; ++step) {
    Pose T = T_now;
    T.translation() += (farthest - (farthest - least) * step / kRetreatSteps) * away;
    const auto joints = parts.arm.reach(T);
    const bool is_straight = joints && (*joints - parts.arm.joints()).cwiseAbs().maxCoeff() <
                                           parts.settings.max_straight_turn;
    if (!is_straight) continue;
    motion.goals = {*joints};
    last = co_await move(parts, motion);
    if (last.good) break;
  }
  co_return last;
}

}  // namespace

Routine<Outcome> retreat(Parts& parts, const std::string& person, const std::string& object) {
  MotionSpec motion;
  motion.phase = ActionPhase::retreat;
  motion.shape = MotionShape::straight_tool;
  motion.allowed = {object};
  if (!person.empty()) motion.allowed.push_back(person);
  const Vector3 back = retreat_direction(parts, object);
  Outcome outcome = co_await retreat_along(parts, back, motion);
  const std::string why = outcome.reason;
  if (outcome.good) co_return outcome;
  // Beside that direction the fingers still come off the object, though not as far from it.
  const std::vector<Vector3> beside = directions_beside(back, parts.settings.retreat_beside);
  for (const Vector3& direction : beside) {
    outcome = co_await retreat_along(parts, direction, motion);
    if (outcome.good) co_return outcome;
  }
  co_return Outcome::failure("the hand finds no straight path back from " + object + ": " + why);
}

}  // namespace handsel::manipulation_planner
