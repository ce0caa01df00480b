// For common/bus only: the domain view of one participant.
#pragma once

#include <dds/dds.h>

#include "common/bus/dds/domain_view.hpp"

namespace handsel {

DomainView look_around(dds_entity_t participant);
/// What a participant's QoS says of its process.
DomainParticipant described(const dds_qos_t* qos);

}  // namespace handsel
