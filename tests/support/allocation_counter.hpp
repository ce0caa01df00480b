// SPDX-License-Identifier: Apache-2.0
// Counts heap allocations (operator new and malloc). Link allocation_counter.cpp into the test
// binary.
#pragma once

#include <cstdint>

namespace handsel::test {

std::uint64_t allocations();  ///< of the whole process since its start

}  // namespace handsel::test
