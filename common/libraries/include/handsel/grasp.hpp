// SPDX-License-Identifier: Apache-2.0
// Contacts of a grasp (chapter section 3.2.7); the library handsel::grasp. Units: m, N.
//
//   PointContact, contact_wrenches()       contacts and the edges of their friction cones
//   force_closure(), wrench_rank()         whether contacts resist every force and torque
//   grip_forces(), shared_grip_forces()    internal forces with the largest margin in the cones
#pragma once

#include "common/grasp/force_closure.hpp"
#include "common/grasp/grip_force.hpp"
#include "handsel/version.hpp"
