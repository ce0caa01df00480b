// SPDX-License-Identifier: Apache-2.0
// Takes samples of a reader without decoding them.
#pragma once

#include <memory>

#include <dds/dds.h>

#include "common/bus/dds/raw.hpp"

namespace handsel {

/// Owns the entity of the reader.
std::unique_ptr<RawReader> make_raw_reader(dds_entity_t reader);

}  // namespace handsel
