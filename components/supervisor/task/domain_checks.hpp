// SPDX-License-Identifier: Apache-2.0
// Checks and bounds over all tasks of a compiled domain. Pure.
#pragma once

#include "common/config/located.hpp"
#include "components/supervisor/task/domain.hpp"

namespace handsel::supervisor {

/// Throws ConfigError if the first step of a task leads back to the task before anything is done.
void check_for_circles(const Domain& domain, const TextPlace& place);

/// Sets the lower bounds of cost, `min_cost`, of all tasks and methods.
void bound_costs(Domain& domain);

}  // namespace handsel::supervisor
