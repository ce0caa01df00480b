// SPDX-License-Identifier: Apache-2.0
// For common/bus only: the domain view of one participant.
#pragma once

#include <dds/dds.h>

#include "common/bus/dds/domain_view.hpp"

namespace handsel {

/// Returns the participants and endpoints discovered so far, at most 256 of each kind.
DomainView discovered_domain(dds_entity_t participant);
/// Returns what a participant's QoS announces of its process; fields that are not announced stay
/// empty.
DomainParticipant described(const dds_qos_t* qos);

}  // namespace handsel
