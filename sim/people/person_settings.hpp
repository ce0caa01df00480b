// SPDX-License-Identifier: Apache-2.0
// Settings of all people, made from common/config/schema/sim.proto.
#pragma once

#include "common/config/settings/sim.hpp"

namespace handsel::sim {

/// Behaviour of all people: how they walk, take, give and carry.
using PersonManners = settings::SimSettings::Person;
/// Choice of a place for a hand on an object.
using FreeGraspSettings = settings::SimSettings::FreeGrasp;

}  // namespace handsel::sim
