// SPDX-License-Identifier: Apache-2.0
// A live source of people that observes a room of 10 m by 10 m.
#pragma once

#include "common/messages/world.hpp"

namespace handsel::test {

inline SourceView live_view() { return {"camera", {-5, -5, -1}, {5, 5, 4}, 0.0, true, ""}; }

}  // namespace handsel::test
