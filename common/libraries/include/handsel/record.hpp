// SPDX-License-Identifier: Apache-2.0
// Recordings in the MCAP container; the library handsel::record.
//
//   mcap::Reader, mcap::Writer     one file, from its begin to its end
//   idl::Schema                    message types from the IDL text in the file
//   idl::SampleTable               samples of one topic as columns of numbers and texts
//   ConfigError, MissingError      thrown for files that are damaged or not there
#pragma once

#include "common/base/errors.hpp"
#include "common/record/idl_schema.hpp"
#include "common/record/mcap.hpp"
#include "common/record/sample_table.hpp"
#include "handsel/version.hpp"
