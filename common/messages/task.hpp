// Goals and how they fare: person -> supervisor -> manipulation planner.
#pragma once

#include <cstdint>
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
  double value{};  ///< speed: [0, 1]
};

enum class TaskState : std::uint8_t { accepted, running, paused, succeeded, failed, cancelled, refused };
const char* name(TaskState);

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
};

enum class ActionKind : std::uint8_t { pick, place, give, receive, go_to };
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
};

enum class ActionState : std::uint8_t { idle, running, succeeded, failed, cancelled };

/// Topic ActionStatus, profile state, 10 Hz and on change.
struct ActionStatus {
  Stamp stamp{};
  std::uint64_t id{};
  std::uint64_t task{};
  ActionKind kind{};
  ActionState state{ActionState::idle};
  std::string phase;  ///< planning, approach, grasp, lift, carry, offer, release, retreat
  std::string object, human;
  bool holding{};                           ///< the hand holds `object`
  bool exchange_engaged{};                  ///< the exchanging forearm and hand are excepted from separation
  Vector3 exchange_point{Vector3::Zero()};  ///< world, valid while kind is give or receive [m]
  std::string reason;
  Refusals refusals;
};

}  // namespace handsel
