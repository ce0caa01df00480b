// SPDX-License-Identifier: Apache-2.0
// How the command talks: results to stdout (JSON Lines when it is no terminal), everything else to
// stderr.
#pragma once

#include <unistd.h>

#include <cstdio>

namespace handsel {

/// JSON Lines wanted: asked for, or stdout is not a terminal.
inline bool json_wanted(bool asked) { return asked || isatty(STDOUT_FILENO) == 0; }
/// Returns true when stdout is closed or fails: an endless command ends then.
inline bool nobody_reads() { return std::fflush(stdout) != 0 || std::ferror(stdout) != 0; }
/// Returns true when stderr is a terminal: progress would spoil a log file.
inline bool progress_wanted() { return isatty(STDERR_FILENO) != 0; }

}  // namespace handsel
