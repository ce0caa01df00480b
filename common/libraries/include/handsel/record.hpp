// SPDX-License-Identifier: Apache-2.0
// Recordings in the MCAP container; the library handsel::record.
//
//   mcap::Reader, mcap::Writer     one file, from its begin to its end
//   ConfigError, MissingError      thrown for files that are damaged or not there
#pragma once

#include "common/base/errors.hpp"
#include "common/record/mcap.hpp"
#include "handsel/version.hpp"
