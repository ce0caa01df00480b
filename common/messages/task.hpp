// Goals and how they fare: person -> supervisor -> manipulation planner.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/base/errors.hpp"
#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

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
};
const char* name(TaskKind);

/// Topic TaskGoal, profile command.
struct TaskGoal {
  Stamp stamp{};
  std::uint64_t id{};  ///< chosen by the sender, unique
  TaskKind kind{};
  std::string object;
  std::string human;  ///< empty: the nearest attentive person
  std::string surface;
  double value{};    ///< speed: [0, 1]
  std::string onto;  ///< box where what is taken, cleared or tidied ends; empty: where there is room
};

enum class TaskState : std::uint8_t { accepted, running, paused, succeeded, failed, cancelled, refused };
const char* name(TaskState);

enum class StepState : std::uint8_t { waiting, running, done, failed, dropped };
const char* name(StepState);

/// A task or an action in the tree of a plan.
struct PlanStep {
  std::string text;       ///< "give mug to anna"
  std::uint32_t depth{};  ///< 0: the goal; its parts follow it one deeper
  StepState state{};
  std::string reason;  ///< of a failure, or why it was dropped
};

/// Topic TaskStatus, profile state.
struct TaskStatus {
  Stamp stamp{};
  std::uint64_t id{};
  TaskKind kind{};
  TaskState state{};
  std::vector<std::string> plan;  ///< the steps, e.g. "pick mug", "give mug to anna"
  std::uint32_t step{};           ///< index into plan
  std::string phase;              ///< of the running action
  std::string reason;             ///< of a failure or refusal
  Refusals refusals;              ///< gathered on the way
  std::vector<PlanStep> tree;     ///< the plan with what it was made of, depth first
  double cost{};                  ///< of what is left of the plan
};

enum class ActionKind : std::uint8_t { pick, place, give, receive, go_to, regrasp, carry };
const char* name(ActionKind);

/// Topic ActionGoal, profile request: supervisor -> manipulation planner. The same id twice is one action.
struct ActionGoal {
  Stamp stamp{};
  std::uint64_t id{};
  std::uint64_t task{};
  std::uint64_t epoch{};  ///< Go epoch its motions carry
  ActionKind kind{};
  bool cancel{};  ///< stop action `id`: finish softly, report cancelled
  std::string object, human, surface;
  bool has_goal{};                      ///< pick, place, regrasp, carry: where the object will stand in the end is known
  Pose T_world_goal{Pose::Identity()};  ///< the object there
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
  waiting_for_release,  ///< `human`, to let go of the object
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
  letting_go,
  letting_go_first_hand,
  retreat,
  backing_off,    ///< after a grasp that failed
  stepping_back,  ///< a giver has approached
  drawing_back,   ///< a person is too near
  making_room,    ///< for an offer
  to_rest,
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
  Stamp stamp{};
  std::uint64_t id{};
  std::uint64_t task{};
  ActionKind kind{};
  ActionState state{ActionState::idle};
  ActionPhase phase{};
  std::string object, human;
  bool holding{};                                                    ///< the hand holds `object`
  bool exchange_engaged{};                                           ///< the exchanging forearm and hand are excepted from separation
  Vector3 exchange_point{Vector3::Zero()};                           ///< world, valid while kind is give or receive [m]
  double time_to_exchange{std::numeric_limits<double>::infinity()};  ///< until the object changes hands, as foreseen [s]
  ActionFailure failure{};                                           ///< of a state failed or cancelled
  std::string reason;
  Refusals refusals;
};

}  // namespace handsel
