// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/planner.hpp"

#include "common/messages/names.hpp"
#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/handover/time_to_handover.hpp"

namespace handsel::manipulation_planner {

ManipulationPlanner::ManipulationPlanner(const settings::ManipulationPlannerSettings& settings,
                                         std::shared_ptr<const RobotModel> robot,
                                         ObjectLibrary objects, std::uint64_t client,
                                         const CostSettings& cost)
    : parts_(settings, std::move(robot), std::move(objects), client, cost) {}

void ManipulationPlanner::on(const ActionGoal& goal) {
  ActionStatus& status = parts_.action;
  if (goal.cancel) {
    if (goal.id != status.id || status.state != ActionState::running) return;
    drop_action();
    status.state = ActionState::cancelled;
    status.exchange_engaged = false;
    status.failure = ActionFailure::cancelled;
    status.reason = "cancelled on request";
    return;
  }
  if (goal.id == status.id) return;
  drop_action();
  goal_ = goal;
  parts_.offers.set_asked({goal.object, goal.human});
  status = {};
  status.id = goal.id;
  status.task = goal.task;
  status.kind = goal.kind;
  status.object = goal.object;
  status.human = goal.human;
  status.state = ActionState::running;
  status.holding = parts_.held.is_holding();
}

void ManipulationPlanner::on(const TrajectoryReply& reply) {
  parts_.clients.trajectory.on(reply);
  parts_.clients.comparison.on(reply);
}

/// Ends the action where it is; what it has asked for is needed no more.
void ManipulationPlanner::drop_action() {
  if (action_) parts_.link.drop_motion();
  action_ = {};
  parts_.offers.clear();
  parts_.offers.set_hand_at_offer(false);
  parts_.waiting.clear();
  parts_.clients.path.drop();
}

void ManipulationPlanner::step(TimePoint now, Outbox& out) {
  parts_.now.set_time(now);
  parts_.waiting.set_now(now);
  parts_.monitor.update();
  if (parts_.now.set_point().size() == parts_.arm.robot().dof())
    parts_.offers.update(parts_.arm.T_world_tool().translation());
  parts_.link.repeat_stop();
  auto& path = parts_.clients.path;
  if (path.take_dropped()) {
    PathRequest request;
    request.id = parts_.clients.ids.newest_request();
    request.group = parts_.arm.group().name;
    request.cancel = true;
    path.send(request);
  }
  continue_action();
  ActionStatus& status = parts_.action;
  if (parts_.offers.has_accepted()) status.exchange_engaged = parts_.offers.is_engaged();
  status.time_to_handover = time_to_handover(status, parts_.now, parts_.settings);
  status.holding = parts_.held.is_holding();
  parts_.outbox.move_to(out);
}

/// Starts or resumes the action, and ends it where it is over or the object has slipped.
void ManipulationPlanner::continue_action() {
  if (parts_.action.state == ActionState::running && !action_) {
    action_ = run(goal_);
    action_.start();
  } else {
    parts_.waiting.poll(parts_.now.time());
  }
  parts_.held.update(parts_.now.time());
  if (action_ && !action_.done() && parts_.held.has_slipped(parts_.now.time())) lose_object();
  if (action_ && action_.done()) end_action(action_.result());
}

void ManipulationPlanner::end_action(const Outcome& outcome) {
  ActionStatus& status = parts_.action;
  status.state = outcome.good ? ActionState::succeeded : ActionState::failed;
  status.failure = outcome.kind;
  status.reason = outcome.reason;
  status.exchange_engaged = false;
  parts_.offers.clear();
  action_ = {};
}

/// Ends the action where the arm is.
void ManipulationPlanner::lose_object() {
  const std::string lost = parts_.held.id();
  drop_action();
  parts_.held.release();
  parts_.link.repeat_stop();
  ActionStatus& status = parts_.action;
  status.state = ActionState::failed;
  status.exchange_engaged = false;
  status.failure = ActionFailure::other;
  status.reason = lost + " slipped out of the hand (" + phase_text(status) + ")";
}

/// Uses the hand that holds the object of the goal, as the scene has it now.
Routine<Outcome> ManipulationPlanner::find_hand(const ActionGoal& goal) {
  const SceneObject* object = parts_.now.object(goal.object);
  if (object != nullptr && object->holder == Holder::robot) {
    const auto& all = parts_.arm.manipulators();
    const int by = hand_index(all, object->holder_id);
    Outcome ready = co_await use_arm(
        parts_, by < 0 ? parts_.arm.group().name : all[static_cast<std::size_t>(by)].name);
    if (!ready.good) co_return ready;
    object = parts_.now.object(goal.object);
    if (object == nullptr) co_return Outcome::failure("object " + goal.object + " left the scene");
    if (parts_.held.id() != object->id) {
      parts_.held.set_grasp(std::nullopt);
      parts_.held.hold(*object);
    }
  } else if (parts_.held.id() == goal.object) {
    // Not while a person takes hold of the object, too.
    const bool is_gripped = object != nullptr && parts_.held.is_in_hand(*object) &&
                            parts_.arm.hand_state() == HandState::grasped;
    if (!is_gripped) parts_.held.release();
  }
  if (!parts_.held.is_holding() && parts_.arm.index() != 0) {
    Outcome ready = co_await use_arm(parts_, parts_.arm.manipulators().front().name);
    if (!ready.good) co_return ready;
  }
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::run(ActionGoal goal) {
  parts_.action.phase = ActionPhase::waiting_for_scene;
  const auto is_known = [this] {
    const Snapshot& now = parts_.now;
    return now.scene().robot_known && now.execution() &&
           now.set_point().size() == parts_.arm.robot().dof();
  };
  const bool known = co_await parts_.waiting.until(is_known, parts_.settings.scene_timeout);
  if (!known) co_return Outcome::failure("no scene or no controller state has come");
  Outcome outcome = co_await find_hand(goal);
  if (!outcome.good) co_return outcome;
  const bool takes_two_hands =
      goal.kind == ActionKind::regrasp || goal.kind == ActionKind::carry || goal.both_hands;
  if (takes_two_hands && parts_.arm.manipulators().size() < 2)
    co_return Outcome::failure(std::string(name(goal.kind)) + " needs two hands, robot " +
                               parts_.arm.robot().name() + " has one");
  switch (goal.kind) {
    case ActionKind::pick:
      outcome = co_await pick(parts_, goal.object, goal.human, goal.surface);
      break;
    case ActionKind::give:
      if (goal.both_hands)
        outcome = co_await give_together(parts_, goal);
      else
        outcome = co_await give(parts_, goal.object, goal.human);
      break;
    case ActionKind::place:
      outcome = co_await place(parts_, goal.object, goal.surface);
      break;
    case ActionKind::go_to:
      outcome = co_await rest_all(parts_);
      break;
    case ActionKind::receive:
      outcome = co_await receive(parts_, goal.object, goal.human, goal.surface);
      break;
    case ActionKind::regrasp:
      if (goal.surface.empty() && !goal.has_goal)
        outcome = co_await change_hands(parts_, goal.object);
      else
        outcome = co_await regrasp(parts_, goal);
      break;
    case ActionKind::carry:
      outcome = co_await carry(parts_, goal);
      break;
    case ActionKind::drive:
      outcome = co_await drive(parts_, goal);
      break;
  }
  co_return outcome;
}

}  // namespace handsel::manipulation_planner
