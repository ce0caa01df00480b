// SPDX-License-Identifier: Apache-2.0
// Takes an offered object by one grasp: comes to the object clear of the fingers, closes, feels
// that the giver has released the object, and retreats.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {

/// One attempt to take an offered object.
struct TakeAttempt {
  Offer offer;              ///< the object and its giver
  Grasp chosen;             ///< for where the object was when it was chosen
  std::uint32_t attempt{};  ///< from 1; the later, the longer may the path of the arm be
};

// References must outlive the routines.
/// Takes the object; a failure leaves the hand off the giver.
Routine<Outcome> take(Parts& parts, const TakeAttempt& attempt);

}  // namespace handsel::manipulation_planner
