// SPDX-License-Identifier: Apache-2.0
// The only names of the enumerators, each table in the order of its enum. The wire, the page,
// reports and settings use them.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"

namespace handsel {

inline constexpr const char* kBehaviourNames[] = {"search", "track", "avoid",   "pick",
                                                  "place",  "give",  "receive", "watch"};
inline constexpr const char* kCauseNames[] = {"none",
                                              "no_go",
                                              "supervisor_silent",
                                              "forecast_silent",
                                              "forecast_collision",
                                              "attention_silent",
                                              "attention_slow",
                                              "separation",
                                              "robot_state_silent",
                                              "human_state_silent",
                                              "human_unknown",
                                              "drive_not_enabled",
                                              "tracking_error",
                                              "limit_violation",
                                              "cycle_late",
                                              "override_slow",
                                              "wall",
                                              "contact",
                                              "cost_ahead",
                                              "blind",
                                              "stop_unproven",
                                              "second_writer",
                                              "clamped",
                                              "awaits_person",
                                              "unlocalised"};
inline constexpr const char* kModeNames[] = {"normal", "slow", "hold", "stop", "fault"};
inline constexpr const char* kHandStateNames[] = {"idle",  "moving",   "grasped",
                                                  "empty", "released", "refused"};
inline constexpr const char* kTaskKindNames[] = {
    "give",  "receive", "pick",   "place",  "clear",       "tidy",  "regrasp",      "lift",
    "go_to", "pause",   "resume", "cancel", "acknowledge", "speed", "clear_person", "drive"};
inline constexpr const char* kTaskStateNames[] = {"accepted", "running",   "paused", "succeeded",
                                                  "failed",   "cancelled", "refused"};
inline constexpr const char* kRegraspKindNames[] = {"pick", "pass", "place", "join"};
inline constexpr const char* kActionKindNames[] = {"pick",  "place",   "give",  "receive",
                                                   "go_to", "regrasp", "carry", "drive"};
inline constexpr const char* kStepStateNames[] = {"waiting", "running", "done", "failed",
                                                  "dropped"};
inline constexpr const char* kTaskChangeNames[] = {"none", "suspend", "resume", "abort", "give"};
inline constexpr const char* kDriveModeNames[] = {
    "off", "braked", "enabled", "protective_stop", "user_stop", "emergency_stop"};
inline constexpr const char* kFactNames[] = {"in_contact_zone",
                                             "in_danger_zone",
                                             "in_interaction_zone",
                                             "in_social_zone",
                                             "approaching",
                                             "attentive",
                                             "reaching",
                                             "hand_near_object",
                                             "on_surface",
                                             "held_by_robot",
                                             "held_by_human",
                                             "reachable_by_robot",
                                             "reachable_by_human",
                                             "inside",
                                             "next_to",
                                             "visible_to",
                                             "looking_at",
                                             "moving",
                                             "offering",
                                             "waiting_to_receive",
                                             "withdrawn",
                                             "released"};
inline constexpr const char* kSideNames[] = {"left", "right"};
inline constexpr const char* kHolderNames[] = {"nobody", "surface", "robot", "human"};
inline constexpr const char* kPrimitiveNames[] = {"none", "box", "cylinder", "sphere"};
inline constexpr const char* kHealthStateNames[] = {"starting", "ok", "degraded", "stopping"};
inline constexpr const char* kSimActionNames[] = {"pause",
                                                  "resume",
                                                  "reset",
                                                  "person_freeze",
                                                  "person_unfreeze",
                                                  "person_dart",
                                                  "person_leave",
                                                  "person_refuse",
                                                  "robot_stop",
                                                  "robot_enable",
                                                  "silence_human",
                                                  "silence_robot_state",
                                                  "restore",
                                                  "human_frozen",
                                                  "human_empty",
                                                  "human_late",
                                                  "human_elsewhere",
                                                  "emergency_stop",
                                                  "localisation_lost",
                                                  "localisation_jump",
                                                  "wheel_slip",
                                                  "person_hand",
                                                  "person_look_away"};

// clang-format off
inline constexpr const char* kActionPhaseTexts[] = {
    "", "choosing a grasp", "choosing two grasps", "choosing hands and grasps",
    "choosing the exchange point", "choosing a place", "looking for the object",
    "looking ahead to the exchange", "waiting for the scene",
    "waiting for somebody to come within reach", "watching for an offer",
    "waiting for release", "planning", "approach", "approach with the other hand",
    "reaching the object", "opening the hand", "opening the other hand", "grasp", "lift",
    "carry", "carry to the other hand", "offer", "put down", "put back", "release",
    "release with the first hand", "retreat", "backing off", "stepping back",
    "retreat from a person", "clear the offer area", "to rest", "choosing a place for the platform",
    "moving the platform"};
inline constexpr const char* kActionFailureNames[] = {
    "none", "other", "no_answer", "timed_out", "not_permitted", "nothing_grasped", "left_behind",
    "not_visible", "not_taken", "cancelled"};
// clang-format on

/// Returns the phase in words; a phase that waits for a person contains "somebody".
std::string text_of(ActionPhase phase);
/// Returns the phase in words, with the person it waits for.
std::string phase_text(const ActionStatus& action);
/// Returns the word of kActionFailureNames; "unknown" for a value outside the enumeration.
const char* name(ActionFailure);
/// Returns the word of kSideNames; "unknown" for a value outside the enumeration.
const char* name(Side value);
/// Returns the word of kHolderNames; "unknown" for a value outside the enumeration.
const char* name(Holder);
/// Returns the word of kHealthStateNames; "unknown" for a value outside the enumeration.
const char* name(HealthState);

}  // namespace handsel
