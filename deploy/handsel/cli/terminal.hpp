// How the command talks: results to stdout (JSON Lines when it is no terminal), everything else to stderr.
#pragma once

#include <unistd.h>

#include <cstdio>

namespace handsel {

/// JSON Lines wanted: asked for, or stdout is not a terminal.
inline bool json_wanted(bool asked) { return asked || isatty(STDOUT_FILENO) == 0; }
/// Nobody reads what is written any more: a command that goes on and on ends then.
inline bool nobody_reads() { return std::fflush(stdout) != 0 || std::ferror(stdout) != 0; }
inline bool progress_wanted() { return isatty(STDERR_FILENO) != 0; }

}  // namespace handsel
