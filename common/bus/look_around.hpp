// For dds_bus.cpp: the domain view of one participant.
#pragma once

#include <dds/dds.h>

#include "common/bus/domain_view.hpp"

namespace handsel {

DomainView look_around(dds_entity_t participant);

}  // namespace handsel
