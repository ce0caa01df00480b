// SPDX-License-Identifier: Apache-2.0
// What the kernel says of a running process: /proc.
#pragma once

#include <sys/types.h>

namespace handsel {

/// Returns the state letter of /proc/PID/stat (proc(5)); 'X' when there is no such process.
char process_state(pid_t pid);

}  // namespace handsel
