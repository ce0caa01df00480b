// SPDX-License-Identifier: Apache-2.0
#include "common/messages/names.hpp"

namespace handsel {
namespace {

template <class Enum>
const char* look_up(std::span<const char* const> names, Enum value) {
  const auto index = static_cast<std::size_t>(value);
  return index < names.size() ? names[index] : "unknown";
}

template <class Enum, std::size_t n>
constexpr bool ends_with(const char* const (&)[n], Enum last) {
  return n == static_cast<std::size_t>(last) + 1;
}
static_assert(ends_with(kBehaviourNames, Behaviour::watch));
static_assert(ends_with(kCauseNames, Cause::unlocalised));
static_assert(ends_with(kModeNames, Mode::fault));
static_assert(ends_with(kHandStateNames, HandState::refused));
static_assert(ends_with(kTaskKindNames, TaskKind::drive));
static_assert(ends_with(kTaskStateNames, TaskState::refused));
static_assert(ends_with(kActionKindNames, ActionKind::drive));
static_assert(ends_with(kRegraspKindNames, RegraspKind::join));
static_assert(ends_with(kStepStateNames, StepState::dropped));
static_assert(ends_with(kTaskChangeNames, TaskChange::give));
static_assert(ends_with(kDriveModeNames, DriveMode::emergency_stop));
static_assert(ends_with(kFactNames, FactKind::released));
static_assert(ends_with(kActionPhaseTexts, ActionPhase::moving_platform));
static_assert(ends_with(kActionFailureNames, ActionFailure::cancelled));
static_assert(ends_with(kSideNames, Side::right));
static_assert(ends_with(kHolderNames, Holder::human));
static_assert(ends_with(kHealthStateNames, HealthState::stopping));
static_assert(ends_with(kSimActionNames, SimAction::person_look_away));

}  // namespace

const char* name(Behaviour value) { return look_up(kBehaviourNames, value); }
const char* name(Cause value) { return look_up(kCauseNames, value); }
const char* name(Mode value) { return look_up(kModeNames, value); }
const char* name(HandState value) { return look_up(kHandStateNames, value); }
const char* name(TaskKind value) { return look_up(kTaskKindNames, value); }
const char* name(TaskState value) { return look_up(kTaskStateNames, value); }
const char* name(ActionKind value) { return look_up(kActionKindNames, value); }
const char* name(StepState value) { return look_up(kStepStateNames, value); }
const char* name(TaskChange value) { return look_up(kTaskChangeNames, value); }
const char* name(FactKind value) { return look_up(kFactNames, value); }
const char* name(ActionFailure value) { return look_up(kActionFailureNames, value); }

std::string text_of(ActionPhase phase) { return look_up(kActionPhaseTexts, phase); }

std::string phase_text(const ActionStatus& action) {
  std::string text = text_of(action.phase);
  constexpr std::string_view kSomebody = "somebody";
  const auto at = text.find(kSomebody);
  if (at != std::string::npos && !action.human.empty())
    text.replace(at, kSomebody.size(), action.human);
  return text;
}

const char* name(Side value) { return look_up(kSideNames, value); }
const char* name(Holder value) { return look_up(kHolderNames, value); }
const char* name(HealthState value) { return look_up(kHealthStateNames, value); }

}  // namespace handsel
