// SPDX-License-Identifier: Apache-2.0
// Sides of a person's body.
#pragma once

#include <cstdint>

namespace handsel {

/// Which arm or hand of a person.
enum class Side : std::uint8_t { left, right };

/// Returns the other side.
constexpr Side other_side(Side side) { return side == Side::left ? Side::right : Side::left; }

}  // namespace handsel
