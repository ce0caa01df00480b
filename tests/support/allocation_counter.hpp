// Counts heap allocations of the calling thread while one is alive. Link allocation_counter.cpp into the test binary.
#pragma once

#include <cstdint>

namespace handsel::test {

std::uint64_t allocations();  ///< of the whole process since its start

}  // namespace handsel::test
