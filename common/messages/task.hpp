// SPDX-License-Identifier: Apache-2.0
// Goals and their progress: person -> supervisor -> manipulation planner.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/base/errors.hpp"
#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "common/messages/side.hpp"

namespace handsel {

enum class TaskKind : std::uint8_t {
  give,
  receive,
  pick,
  place,
  clear,
  tidy,
  regrasp,
  lift,
  go_to,  // goals
  pause,
  resume,
  cancel,
  acknowledge,
  speed,         // about the running one, or the system
  clear_person,  // an operator says that a person who was lost is gone
  drive,         ///< the platform to object, surface or human, whichever is named, else to `place`
};
/// Returns the word of kTaskKindNames; "unknown" for a value outside the enumeration.
const char* name(TaskKind);

/// A goal or an instruction of a person. Topic TaskGoal, profile goal.
struct TaskGoal {
  Stamp stamp{};       ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t id{};  ///< unique, chosen by the sender
  TaskKind kind{};     ///< what to do
  /// Scene object id, or the named configuration of go_to; empty where the kind needs none.
  std::string object;
  std::string human;    ///< person id; empty: the nearest attentive person
  std::string surface;  ///< scene box id; empty where the kind needs none
  double value{};       ///< of kind speed: speed override, [0, 1]
  /// Of kind drive, where nothing is named: platform x, y [m], heading [rad] in the world.
  Vector3 place{Vector3::Zero()};
  /// Box where what is taken, cleared or tidied ends; empty: where there is space.
  std::string onto;
};

enum class TaskState : std::uint8_t {
  accepted,
  running,
  paused,
  succeeded,
  failed,
  cancelled,
  refused
};
/// Returns the word of kTaskStateNames; "unknown" for a value outside the enumeration.
const char* name(TaskState);

enum class StepState : std::uint8_t { waiting, running, done, failed, dropped };
/// Returns the word of kStepStateNames; "unknown" for a value outside the enumeration.
const char* name(StepState);

/// A task or an action in the tree of a plan.
struct PlanStep {
  std::string text;       ///< "give mug to anna"
  std::uint32_t depth{};  ///< 0: the goal; its parts follow it one deeper
  StepState state{};      ///< dropped: the plan no longer contains it
  std::string reason;     ///< of a failure, or why it was dropped
};

/// Progress of a task. Topic TaskStatus, profile state.
struct TaskStatus {
  Stamp stamp{};                  ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t id{};             ///< id of the goal
  TaskKind kind{};                ///< kind of the goal
  TaskState state{};              ///< failed and refused: `reason` says why
  std::vector<std::string> plan;  ///< the steps, e.g. "pick mug", "give mug to anna"
  std::uint32_t step{};           ///< index into `plan` of the running step; plan.size(): all done
  std::string phase;              ///< of the running action
  std::string reason;             ///< of a failure or refusal, one sentence
  Refusals refusals;              ///< gathered so far
  std::vector<PlanStep> tree;     ///< the plan with what it was made of, depth first
  double cost{};                  ///< cost of the remaining plan
};

enum class ActionKind : std::uint8_t { pick, place, give, receive, go_to, regrasp, carry, drive };
/// Returns the word of kActionKindNames; "unknown" for a value outside the enumeration.
const char* name(ActionKind);

/// Topic ActionGoal, profile request: supervisor -> manipulation planner. The same id twice is one
/// action.
struct ActionGoal {
  Stamp stamp{};          ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t id{};     ///< unique, grows
  std::uint64_t task{};   ///< id of the goal it serves
  std::uint64_t epoch{};  ///< Go::epoch its motions carry
  ActionKind kind{};      ///< what to do
  bool cancel{};          ///< stop action `id` with jerk-limited motion and report cancelled
  /// Ids of scene object, person and scene box; empty where the kind needs none.
  std::string object, human, surface;
  /// pick, place, regrasp, carry: the final pose of the object is known; drive: of the platform.
  bool has_goal{};
  Pose T_world_goal{Pose::Identity()};  ///< that pose
  /// give: with both hands, from where the object stands; else with the hand that holds it.
  bool both_hands{};
};

enum class ActionState : std::uint8_t { idle, running, succeeded, failed, cancelled };

/// What a running action is doing.
enum class ActionPhase : std::uint8_t {
  none,
  choosing_grasp,
  choosing_two_grasps,
  choosing_hands,
  choosing_exchange_point,
  choosing_place,
  looking_for_object,
  looking_ahead,  ///< to the handover, while the grasp is chosen
  waiting_for_scene,
  waiting_for_person,  ///< `human`, to come within reach
  watching_for_offer,
  waiting_for_release,  ///< `human`, to release the object
  planning,
  approach,
  approach_other_hand,
  reaching_object,
  opening_hand,
  opening_other_hand,
  grasp,
  lift,
  carry,
  carry_to_other_hand,
  offer,
  put_down,
  put_back,
  release,
  release_first_hand,
  retreat,
  backing_off,          ///< after a grasp that failed
  stepping_back,        ///< a giver has approached
  retreat_from_person,  ///< a person is too near
  clear_offer_area,     ///< for an offer
  to_rest,
  choosing_platform_place,
  moving_platform,
};

/// What kind of failure ended an action: the supervisor's recovery rules decide by it.
enum class ActionFailure : std::uint8_t {
  none,
  other,            ///< the reason alone says which
  no_answer,        ///< of another process
  timed_out,        ///< a computation did not end in time
  not_permitted,    ///< the controller may not move
  nothing_grasped,  ///< the hand closed on nothing
  left_behind,      ///< the object stayed where it was when the hand went up
  not_visible,      ///< object or person
  not_taken,        ///< the receiver did not take the object
  cancelled,        ///< on request
};

/// Topic ActionStatus, profile state, 10 Hz and on change.
struct ActionStatus {
  Stamp stamp{};                         ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t id{};                    ///< id of the action
  std::uint64_t task{};                  ///< id of the goal it serves
  ActionKind kind{};                     ///< kind of the action
  ActionState state{ActionState::idle};  ///< idle: there was no action yet
  ActionPhase phase{};                   ///< part of the running action
  std::string object, human;  ///< scene object id and person id of the action; may be empty
  bool holding{};             ///< the hand holds `object`
  bool exchange_engaged{};    ///< the exchanging forearm and hand are exempt from separation
  Vector3 exchange_point{Vector3::Zero()};  ///< world, valid while kind is give or receive [m]
  /// Until the object changes hands, as foreseen [s].
  double time_to_handover{std::numeric_limits<double>::infinity()};
  bool has_partner{};              ///< the handover is planned for a grasp of the person
  Side partner_side{Side::right};  ///< hand of the person that it is planned for; if has_partner
  /// Wrist of the person's hand at the handover: z along the fingers, x out of the palm; world.
  Pose T_world_partner_wrist{Pose::Identity()};
  /// Largest fraction of its range that wrist or arm of the person uses there.
  double partner_strain{};
  ActionFailure failure{};  ///< of a state failed or cancelled
  std::string reason;       ///< of a failure, one sentence
  Refusals refusals;        ///< grasps, paths and places discarded during the action
};

}  // namespace handsel
