// SPDX-License-Identifier: Apache-2.0
// How comfortable a person's wrist and arm are with the hand in a place (chapter section 3.2.9).
// Own method: the measure.
#pragma once

#include <optional>

#include "common/messages/world.hpp"

namespace handsel {

/// Where an arm starts and how long it is.
struct HumanArm {
  Side side{Side::right};             ///< which arm of the person
  Vector3 shoulder{Vector3::Zero()};  ///< world [m]
  Vector3 outward{Vector3::UnitY()};  ///< level, away from the other shoulder, unit
  double upper{}, forearm{};          ///< lengths [m]
};

/// nullopt when the person's body is not complete.
std::optional<HumanArm> human_arm(const Person&, Side);

/// An arm that holds its hand somewhere. Angles [rad].
struct WristPosture {
  Vector3 elbow{Vector3::Zero()};  ///< world [m]
  double flexion{};                ///< of the hand toward its palm; negative: extension
  double radial{};                 ///< of the hand toward the thumb; negative: ulnar
  double pronation{};              ///< of the forearm from thumb up; negative: supination
  double elevation{};              ///< of the upper arm from hanging
  double adduction{};              ///< of the upper arm across the body; negative: outward
  /// The largest fraction of its range any of the five uses; outward counts as none, 0: neutral, 1:
  /// at an end.
  double strain{};
};

/// Ranges of the joints of a grown person: flexion 80, extension 70, radial 20, ulnar 30, pronation
/// and supination 80 degrees, adduction of the upper arm 50 (American Academy of Orthopaedic
/// Surgeons); elevation of the upper arm 100 degrees here, so that its comfortable part ends at 60
/// (ISO 11226).
struct WristRanges {
  /// All from the neutral position, > 0 [rad].
  double flexion, extension, radial, ulnar, pronation, supination, elevation, adduction;
};
inline constexpr WristRanges kWristRanges{1.396, 1.222, 0.349, 0.524, 1.396, 1.396, 1.745, 0.873};

/// Up to this fraction of the ranges an arm counts as comfortable.
inline constexpr double kComfortableStrain = 0.6;

/// Returns the configuration of min strain, the elbow anywhere from straight below the line from
/// shoulder to wrist to level outward. `T_world_wrist`: the hand's frame, in the wrist, z along the
/// fingers, x out of the palm. nullopt when the wrist is out of the arm's reach, or nearer than 0.2
/// m.
std::optional<WristPosture> wrist_posture(const HumanArm&, const Pose& T_world_wrist);

}  // namespace handsel
