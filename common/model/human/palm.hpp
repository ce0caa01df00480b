// SPDX-License-Identifier: Apache-2.0
// How a hand is turned about its fingers, from its knuckles. Own method.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "common/messages/side.hpp"
#include "common/messages/world.hpp"

namespace handsel {

/// Names of the observed joints of a hand beyond the body, which trackers of hands give: the
/// knuckles of index and little finger.
struct Knuckles {
  const char* hand;   ///< name of the hand in the body
  const char* index;  ///< knuckle of the index finger
  const char* pinky;  ///< knuckle of the little finger
};
/// Left, right.
inline constexpr std::array<Knuckles, 2> kKnuckles{
    {{"l_hand", "l_index", "l_pinky"}, {"r_hand", "r_index", "r_pinky"}}};

/// Returns whether a joint of that name is a knuckle.
bool is_knuckle(const std::string& name);
/// Returns the direction from the little finger to the index finger for a palm that faces
/// `normal`, with the fingers along `fingers`; all are unit vectors of one frame.
Vector3 across_palm(Side side, const Vector3& fingers, const Vector3& normal);
/// Returns the direction in which a palm faces, a unit vector. `fingers`: direction from wrist to
/// hand; `across`: vector from the knuckle of the little finger to that of the index finger.
/// nullopt: they are almost parallel or 0.
std::optional<Vector3> palm_normal(Side side, const Vector3& fingers, const Vector3& across);

/// Returns the direction in which the palm of a person's hand faces, world; nullopt: not observed.
std::optional<Vector3> palm_of(const Person& person, Side side);

}  // namespace handsel
