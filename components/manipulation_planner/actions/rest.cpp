// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/actions/rest.hpp"

#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"

namespace handsel::manipulation_planner {
namespace {

/// Returns whether the hand in use, at rest, would be in the way of another hand with the fingers
/// that its last grasp opened.
bool is_opened_beside_another(const Parts& parts) {
  const Group& fingers = parts.arm.fingers();
  if (parts.held.is_holding() || fingers.axes.empty() || parts.arm.manipulators().size() < 2)
    return false;
  const Vector off =
      RobotModel::part(parts.arm.configuration() - parts.arm.robot().rest_configuration(), fingers);
  return off.cwiseAbs().maxCoeff() > parts.settings.rest_range;
}

/// Returns the rest configuration, or where what is held must stay upright and would not, one with
/// the hand in the same place and turned as little as that needs.
Vector upright_at(const Parts& parts, const Vector& at_rest) {
  const std::optional<TiltBound> bound = tilt_bound(parts, {});
  if (!bound) return at_rest;
  const RobotModel& robot = parts.arm.robot();
  const Vector q = RobotModel::with(parts.arm.configuration(), parts.arm.group(), at_rest);
  Pose T = robot.link_pose(q, parts.arm.palm());
  const Vector3 up = parts.now.T_world_base().linear().transpose() * Vector3::UnitZ();
  const Vector3 axis = T.linear() * bound->axis_tool;
  if (axis.dot(up) >= std::cos(bound->max_tilt)) return at_rest;
  T.linear() = Eigen::Quaterniond::FromTwoVectors(axis, up).toRotationMatrix() * T.linear();
  return robot.inverse(parts.arm.group(), T, q).value_or(at_rest);
}

}  // namespace

Routine<Outcome> rest(Parts& parts) {
  const Group& arm = parts.arm.group();
  const Vector at_rest = RobotModel::part(parts.arm.robot().rest_configuration(), arm);
  MotionSpec motion;
  motion.phase = ActionPhase::to_rest;
  motion.speed = parts.held.is_holding() ? parts.settings.carry_speed : 1.0;
  const Vector q = RobotModel::with(parts.arm.configuration(), arm, at_rest);
  const Person* person = parts.now.person("");
  if (person != nullptr && parts.area.is_occupied(*person, q))
    motion.goals = parts.area.clear_configurations(*person);
  if (motion.goals.empty()) motion.goals = {upright_at(parts, at_rest)};
  Outcome outcome = co_await move(parts, motion);
  const Vector off = RobotModel::part(parts.now.set_point(), arm) - at_rest;
  if (!outcome.good || off.cwiseAbs().maxCoeff() > parts.settings.rest_range ||
      !is_opened_beside_another(parts))
    co_return outcome;
  const Vector folded =
      RobotModel::part(parts.arm.robot().rest_configuration(), parts.arm.fingers());
  HandResult closed =
      co_await parts.hand.run(HandAction::move, folded, parts.settings.hand_timeout);
  if (!closed.outcome.good) parts.refuse("folding the fingers", closed.outcome.reason);
  co_return outcome;
}

Routine<Outcome> rest_others(Parts& parts) {
  const std::string used = parts.arm.group().name;
  for (const Manipulator& other : parts.arm.manipulators()) {
    if (other.arm == nullptr || other.name == used) continue;
    const Vector off = RobotModel::part(
        parts.now.set_point() - parts.arm.robot().rest_configuration(), *other.arm);
    if (off.cwiseAbs().maxCoeff() < parts.settings.rest_range) continue;
    const std::optional<Grasp> grasp = parts.held.grasp();
    Outcome done = co_await use_arm(parts, other.name);
    if (done.good) done = co_await rest(parts);
    Outcome back = co_await use_arm(parts, used);
    parts.held.set_grasp(grasp);
    if (!done.good) co_return done;
    if (!back.good) co_return back;
  }
  co_return Outcome{};
}

Routine<Outcome> rest_all(Parts& parts) {
  if (parts.held.is_in_both_hands())
    co_return Outcome::failure(parts.held.id() +
                               " is in both hands: a person must take it before the arms rest");
  // One arm may be where another rests: the one in the way goes first.
  Outcome others = co_await rest_others(parts);
  Outcome own = co_await rest(parts);
  if (own.good && !others.good) others = co_await rest_others(parts);
  if (!own.good) co_return own;
  co_return others;
}

Routine<Outcome> clear_offer_area(Parts& parts, const std::string& giver, ClearUntil until) {
  const Person* person = parts.now.person(giver);
  if (person == nullptr) co_return Outcome::failure("nobody is in sight");
  MotionSpec back;
  back.phase = ActionPhase::clear_offer_area;
  back.goals = parts.area.clear_configurations(*person);
  back.clears_area_for = giver;
  back.accepts_any_offer = until == ClearUntil::any_offer;
  if (back.goals.empty())
    co_return Outcome::failure("no configuration of the arm lies farther back");
  Outcome cleared = co_await move(parts, back);
  co_return cleared;
}

Routine<Outcome> clear_offer_area_of_all(Parts& parts, const std::string& giver, ClearUntil until) {
  Outcome cleared = co_await clear_offer_area(parts, giver, until);
  const std::string used = parts.arm.group().name;
  for (const Manipulator& other : parts.arm.manipulators()) {
    if (other.arm == nullptr || other.name == used) continue;
    Outcome own = co_await use_arm(parts, other.name);
    if (own.good && parts.area.is_occupied(giver))
      own = co_await clear_offer_area(parts, giver, until);
    Outcome back = co_await use_arm(parts, used);
    if (!own.good && cleared.good) cleared = own;
    if (!back.good) co_return back;
  }
  co_return cleared;
}

}  // namespace handsel::manipulation_planner
