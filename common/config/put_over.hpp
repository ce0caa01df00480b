// SPDX-License-Identifier: Apache-2.0
// One scenario over another: how a variant changes the scenario that it belongs to.
#pragma once

#include "common/config/located.hpp"
#include "common/config/schema/scenario.pb.h"

namespace handsel {

/// Puts `from` over `into`: a value that is written in `from` replaces, also 0 and false. An entry
/// of a list goes over the entry of the same id (of sensors: source), else it is added; values of a
/// list of plain values replace the list. `places` says what is written in `from`, `at` where.
/// Throws ConfigError "file:line:key: ..." for an entry without id.
void put_over(config::Scenario& into, const config::Scenario& from,
              const google::protobuf::TextFormat::ParseInfoTree& places, const TextPlace& at);

}  // namespace handsel
