// SPDX-License-Identifier: Apache-2.0
// What this process uses of the machine, as the kernel counts.
#pragma once

namespace handsel {

/// Returns the resident memory of this process [MB].
double resident_mb();
/// Returns the processor time of this process since its start, user and system [s].
double process_cpu_seconds();
/// Returns the processor time of the calling thread since its start [s].
double thread_cpu_seconds();

}  // namespace handsel
